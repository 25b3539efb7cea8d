//! Storeys: identical-looking floors of one hotel, with a robot on each and a second one on the lowest.
//!
//! Each floor is furnished from the same models and has the same prints. Floors differ only in door numbers, guests'
//! belongings, centimetres and a few bits.

use super::floor_plan::Layout;
use super::signs::SignPlan;
use super::texture::Patterns;
use super::world::{World, WorldPlan};
use crate::hotel::rng::SeededRng;
use crate::hotel::route::{Stop, some_rooms, tour};
use crate::hotel::sensing::noise::NoiseKind;
use crate::hotel::sequence::Sequence;

/// The number of floors.
pub const STOREYS: usize = 3;
/// The number of different prints on the walls of a floor.
const PRINTS: usize = 6;

/// The floors with their robots' journeys.
#[derive(Clone, Debug)]
pub struct Storeys {
    /// The floors, from the lowest.
    pub floors: Vec<World>,
    /// A robot for each floor, and one more for the lowest.
    pub journeys: Vec<Sequence>,
    /// The rooms of each of their tours.
    pub tours: Vec<Vec<usize>>,
}

impl Storeys {
    /// Builds the floors and records the journeys; `drifts_m` gives each robot's drift. The last robot visits half of
    /// the first one's rooms.
    pub fn new(
        layout: Layout,
        lowest: u32,
        rooms: usize,
        drifts_m: [f64; STOREYS + 1],
        patterns: &Patterns,
        seed: u64,
    ) -> Self {
        let signs = SignPlan { prints: PRINTS, ..SignPlan::default() };
        let floors: Vec<World> = (0..STOREYS)
            .map(|storey| World::storey(&WorldPlan { layout, floor: lowest, signs, seed }, storey, patterns))
            .collect();
        let mut rng = SeededRng::new(seed, "route");
        let (mut journeys, mut tours) = (Vec::new(), Vec::<Vec<usize>>::new());
        for (robot, drift_m) in drifts_m.into_iter().enumerate() {
            let storey = robot % STOREYS;
            let mut tour_rooms = some_rooms(&floors[storey].plan, rooms, &mut rng);
            if robot >= STOREYS {
                let shared = rooms / 2;
                tour_rooms[1..=shared].copy_from_slice(&tours[storey][1..=shared]);
                tour_rooms.dedup();
            }
            let on_storey = |stop: Stop| Stop { storey, ..stop };
            let stops: Vec<Stop> =
                tour(&floors[storey].plan, &tour_rooms, &mut rng).into_iter().map(on_storey).collect();
            let noise = NoiseKind::SecondHotel.noise();
            journeys.push(Sequence::record(
                &floors[storey],
                &stops,
                noise,
                drift_m,
                seed ^ ((robot as u64) << 32),
            ));
            tours.push(tour_rooms);
        }
        Self { floors, journeys, tours }
    }
}

#[cfg(test)]
mod tests {
    use super::super::signs::SignKind;
    use super::*;
    use crate::hotel::scoring::truth::{apart_m, shared_points};

    #[test]
    fn floors_are_alike_but_for_the_numbers_on_their_doors_and_no_place_is_on_two() {
        let storeys = Storeys::new(Layout::SE1, 3, 4, [0.3; 4], &Patterns::new(), 5);
        let [first, second] = [&storeys.floors[0], &storeys.floors[1]];
        let bits = |a: usize| -> u32 {
            let [a, b] = [first.points[a].descriptor, second.points[a].descriptor];
            a.iter().zip(b).map(|(a, b)| (a ^ b).count_ones()).sum()
        };
        // The points of rooms come first, as many on each floor.
        let mut differing: Vec<u32> = (0..20_000).step_by(11).map(bits).collect();
        differing.sort_unstable();
        let median = differing[differing.len() / 2];
        assert!((15..60).contains(&median), "one model, two copies: {median} bits");
        for (a, b) in first.signs.iter().zip(&second.signs) {
            assert_eq!((a.kind, a.centre), (b.kind, b.centre));
            assert_eq!(a.text == b.text, a.kind != SignKind::DoorPlate, "{} and {}", a.text, b.text);
        }
        assert_eq!([&first.numbers[0], &second.numbers[0]], ["301", "401"]);
        let [on_first, on_second, again] = [0, 1, 3].map(|robot| &storeys.journeys[robot].steps[0]);
        assert_eq!([on_first, on_second, again].map(|step| step.stop.storey), [0, 1, 0]);
        let mut above = on_first.clone();
        above.stop.storey = 1;
        assert_eq!((shared_points(on_first, &above), apart_m(on_first, &above)), (0, 3.0));
    }
}
