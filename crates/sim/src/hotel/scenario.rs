//! Scenario: a world, a tour and its noise: the paper's twelve sequences, and any number of random ones.

use super::building::floor_plan::Layout;
use super::building::renumbering::{Era, ROOMS, ROUNDS, eras, round_of, world_of};
use super::building::signs::SignPlan;
use super::building::storeys::storeys;
use super::building::texture::Patterns;
use super::building::world::{World, WorldPlan};
use super::rng::SeededRng;
use super::route::{Stop, some_rooms, tour};
use super::run::Course;
use super::scoring::paper::PrintedSequence;
use super::sensing::noise::NoiseKind;
use super::sequence::Sequence;

/// Rooms of a tour: six in the paper's, fewer in random worlds, so that many runs fit into a night.
const PAPER_ROOMS: usize = 6;
const RANDOM_ROOMS: usize = 4;
/// Range of odometry's drift in random worlds, in metres, from Table III.
const RANDOM_DRIFT_M: [f64; 2] = [0.22, 0.96];

/// A world with its journeys.
#[derive(Clone, Debug)]
pub struct Scenario {
    /// Its floors, from the lowest; several look alike.
    pub floors: Vec<World>,
    /// The journeys through them.
    pub course: Course,
    /// The rooms of each tour.
    pub tours: Vec<Vec<usize>>,
    /// The later worlds, if doors are renumbered.
    pub eras: Vec<Era>,
}

impl Scenario {
    /// Returns one of the paper's sequences: its layout, its own tour, its drift.
    pub fn of_paper(sequence: &PrintedSequence, patterns: &Patterns) -> Self {
        let (layout, floor, seed) =
            if sequence.dataset == "SE1" { (Layout::SE1, 9, 901) } else { (Layout::SE2, 3, 302) };
        let plan = WorldPlan { layout, floor, signs: SignPlan::default(), seed };
        let world = World::new(&plan, patterns);
        let seed = seed * 100 + sequence.number as u64;
        Self::drive(vec![world], NoiseKind::None, PAPER_ROOMS, &[sequence.orb_vo_m], seed)
    }

    /// Returns the floor on which a robot drives.
    pub fn floor_of(&self, robot: usize) -> &World {
        &self.floors[self.course.journeys[robot].storey()]
    }

    /// Returns a random world with some noise.
    pub fn random(seed: u64, kind: NoiseKind, patterns: &Patterns) -> Self {
        let mut rng = SeededRng::new(seed, "scenario");
        let is_second_hotel = kind == NoiseKind::SecondHotel;
        let layout = Layout::random(&mut rng);
        let floor = 1 + rng.below(if is_second_hotel { 10 } else { 12 }) as u32;
        let floors = if is_second_hotel {
            storeys(layout, floor, patterns, seed)
        } else {
            let signs = SignPlan { repeated: kind.noise().repeated_signs, ..SignPlan::default() };
            vec![World::new(&WorldPlan { layout, floor, signs, seed }, patterns)]
        };
        // One on each floor, and one more where several share a map.
        let robots = floors.len() + usize::from(is_second_hotel || kind == NoiseKind::Fleet);
        let drifts_m: Vec<f64> =
            (0..robots).map(|_| rng.within(RANDOM_DRIFT_M[0], RANDOM_DRIFT_M[1])).collect();
        match kind {
            NoiseKind::Renumbered => Self::renumbered(floors, drifts_m[0], patterns, seed),
            kind => Self::drive(floors, kind, RANDOM_ROOMS, &drifts_m, seed),
        }
    }

    /// Records one robot on a tour of many rounds, each with the drift of a single tour.
    fn renumbered(floors: Vec<World>, drift_m: f64, patterns: &Patterns, seed: u64) -> Self {
        let mut rng = SeededRng::new(seed, "route");
        let world = &floors[0];
        let mut round = some_rooms(&world.plan, ROOMS, &mut rng);
        round.pop();
        let eras = eras(world, &round, patterns, &mut SeededRng::new(seed, "renumbering"));
        let rooms: Vec<usize> = round.iter().cycle().take(ROUNDS * round.len() + 1).copied().collect();
        let stops = tour(&world.plan, &rooms, &mut rng);
        let world_at = |visit: usize| world_of(world, &eras, round_of(visit));
        let noise = NoiseKind::Renumbered.noise();
        let journey = Sequence::through(world_at, &stops, noise, drift_m * ROUNDS as f64, seed);
        Self { course: Course::new(vec![journey]), tours: vec![rooms], floors, eras }
    }

    /// Records one robot per drift, in turn on each of the floors, from the lowest. A further robot on a floor visits
    /// half of the first one's rooms.
    fn drive(floors: Vec<World>, kind: NoiseKind, rooms: usize, drifts_m: &[f64], seed: u64) -> Self {
        let mut rng = SeededRng::new(seed, "route");
        let (mut journeys, mut tours) = (Vec::new(), Vec::<Vec<usize>>::new());
        for (robot, drift_m) in drifts_m.iter().enumerate() {
            let storey = robot % floors.len();
            let world = &floors[storey];
            let mut tour_rooms = some_rooms(&world.plan, rooms, &mut rng);
            if robot >= floors.len() {
                let shared = tour_rooms.len() / 2;
                tour_rooms[1..=shared].copy_from_slice(&tours[storey][1..=shared]);
                if kind == NoiseKind::Fleet {
                    tour_rooms[1..=shared].reverse();
                }
                tour_rooms.dedup();
            }
            let stops = tour(&world.plan, &tour_rooms, &mut rng);
            let stops: Vec<Stop> = stops.into_iter().map(|stop| Stop { storey, ..stop }).collect();
            let seed = seed ^ ((robot as u64) << 32);
            journeys.push(Sequence::record(world, &stops, kind.noise(), *drift_m, seed));
            tours.push(tour_rooms);
        }
        Self { floors, course: Course::new(journeys), tours, eras: Vec::new() }
    }
}

#[cfg(test)]
mod tests {
    use super::super::building::signs::SignKind;
    use super::super::scoring::truth::{apart_m, shared_points};
    use super::*;

    #[test]
    fn floors_are_alike_but_for_the_numbers_on_their_doors_and_no_place_is_on_two() {
        let floors = storeys(Layout::SE1, 3, &Patterns::new(), 5);
        let scenario = Scenario::drive(floors, NoiseKind::SecondHotel, 4, &[0.3; 4], 5);
        let [first, second] = [&scenario.floors[0], &scenario.floors[1]];
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
        let [on_first, on_second, again] = [0, 1, 3].map(|robot| &scenario.course.journeys[robot].steps[0]);
        assert_eq!([on_first, on_second, again].map(|step| step.stop.storey), [0, 1, 0]);
        let mut above = on_first.clone();
        above.stop.storey = 1;
        assert_eq!((shared_points(on_first, &above), apart_m(on_first, &above)), (0, 3.0));
    }
}
