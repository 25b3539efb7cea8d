//! The floors that robots have mapped, and the places at which another robot wakes up.

use std::collections::BTreeSet;

use crate::hotel::building::texture::Patterns;
use crate::hotel::rng::SeededRng;
use crate::hotel::route::{Stop, heading_difference_rad, some_rooms, tour};
use crate::hotel::scenario::Scenario;
use crate::hotel::scoring::truth::apart_m;
use crate::hotel::sensing::noise::NoiseKind;
use crate::hotel::sequence::{Sequence, Step};

/// Restarts on each floor of a world.
pub const RESTARTS_PER_FLOOR: usize = 20;
/// Keyframes of a restart, unless another number is told: the robot does not know where it is, and drives on for some metres.
pub const KEYFRAMES_OF_A_RESTART: u16 = 12;
/// Rooms that the restarting robot's own tour visits, of which restarts are drawn.
const TOUR_ROOMS: usize = 4;
/// A restart's place is in a map if a robot stood this near to it, in metres, and faced it within this angle.
const MAPPED_M: f64 = 1.5;
/// The angle, in radians.
const MAPPED_RAD: f64 = 60.0 / 180.0 * std::f64::consts::PI;
/// Door plates, read right, from which a restart must be located.
const TELLING_PLATES: usize = 2;

/// A place at which a robot wakes up, and what it sees from there on.
#[derive(Clone, Debug)]
pub struct Restart {
    /// The keyframes of its first metres; the motion of the first says nothing.
    pub steps: Vec<Step>,
    /// Whether a robot stood there when the floor was mapped.
    pub is_mapped: bool,
    /// Whether it reads the numbers of two doors right.
    pub reads_two_plates: bool,
}

/// Three floors that look alike, each mapped by one robot, and the restarts on them.
#[derive(Clone, Debug)]
pub struct RestartWorld {
    /// The mapping robots' journeys, by floor.
    pub journeys: Vec<Sequence>,
    /// The restarts.
    pub restarts: Vec<Restart>,
}

impl RestartWorld {
    /// Builds the floors of a seed, records the journeys, and draws the restarts, of so many keyframes each, from tours of their
    /// own.
    pub fn new(seed: u64, keyframes: u16, patterns: &Patterns) -> Self {
        let scenario = Scenario::random(seed, NoiseKind::SecondHotel, patterns);
        let floors = &scenario.floors;
        let journeys: Vec<Sequence> = scenario.course.journeys[..floors.len()].to_vec();
        let mut restarts = Vec::new();
        for (storey, world) in floors.iter().enumerate() {
            let mut rng = SeededRng::new(seed ^ ((storey as u64) << 16), "restarts");
            // Half of the rooms are those of the map.
            let mut rooms = some_rooms(&world.plan, TOUR_ROOMS, &mut rng);
            rooms[..TOUR_ROOMS / 2].copy_from_slice(&scenario.tours[storey][..TOUR_ROOMS / 2]);
            rooms.dedup();
            let stops: Vec<Stop> =
                tour(&world.plan, &rooms, &mut rng).into_iter().map(|stop| Stop { storey, ..stop }).collect();
            let noise = NoiseKind::SecondHotel.noise();
            let tour = Sequence::record(world, &stops, noise, 0.0, seed ^ ((storey as u64) << 48) ^ 0x7e57);
            for _ in 0..RESTARTS_PER_FLOOR {
                let first = rng.below(tour.steps.len());
                let steps: Vec<Step> =
                    tour.steps.iter().skip(first).take(usize::from(keyframes)).cloned().collect();
                let is_mapped =
                    journeys[storey].steps.iter().any(|mapped| shows_one_place(mapped, &steps[0]));
                let seen = steps.iter().flat_map(|step| &step.detections);
                let read: BTreeSet<&str> = seen.map(|seen| seen.text.as_str()).collect();
                let plates = world.numbers.iter().filter(|number| read.contains(number.as_str())).count();
                restarts.push(Restart { steps, is_mapped, reads_two_plates: plates >= TELLING_PLATES });
            }
        }
        Self { journeys, restarts }
    }
}

/// Whether a robot that mapped the floor stood near a restart, in the same room or corridor, and faced the same way.
fn shows_one_place(mapped: &Step, restart: &Step) -> bool {
    let (a, b) = (&mapped.stop, &restart.stop);
    a.place == b.place
        && apart_m(mapped, restart) <= MAPPED_M
        && heading_difference_rad(a.stand.heading_rad, b.stand.heading_rad) <= MAPPED_RAD
}
