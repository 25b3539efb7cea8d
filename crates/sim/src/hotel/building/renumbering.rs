//! Renumbering: a hotel whose door numbers change during a tour.
//!
//! The tour has several rounds. Before the second round one plate in ten is replaced, before the fifth every plate of
//! one side of the corridor. A new plate has a number that is new to the floor, and its digits look different.

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};

use super::floor_plan::FloorPlan;
use super::signs::SignKind;
use super::texture::Patterns;
use super::world::World;
use crate::hotel::rng::SeededRng;
use crate::hotel::run::RunResult;
use crate::hotel::scoring::score::{Counts, by_query};
use crate::hotel::sequence::Sequence;

/// Rounds of a tour.
pub const ROUNDS: usize = 8;
/// Rooms per round: few, because a tour of many rounds is long.
pub const ROOMS: usize = 2;
/// The round before which one plate in ten is replaced, from 0, and that share.
const FEW: (usize, f64) = (1, 0.1);
/// The round before which a side is renumbered, three rounds after the first new plates.
const SIDE: usize = 4;

/// The state of a world from a certain round on.
#[derive(Clone, Debug)]
pub struct Era {
    /// The first round.
    pub from_round: usize,
    /// The world.
    pub world: World,
}

/// Returns the eras of a world; `tour` lists the rooms of one round.
pub fn eras(world: &World, tour: &[usize], patterns: &Patterns, rng: &mut SeededRng) -> Vec<Era> {
    let rooms = world.plan.rooms.len();
    // The robot certainly passes the doors of its rooms.
    let mut known = tour.to_vec();
    rng.shuffle(&mut known);
    let few = ((rooms as f64 * FEW.1).ceil() as usize).min(known.len());
    let mut first = world.clone();
    first.renumber(&known[..few], patterns, rng);
    let side: Vec<usize> = {
        let of = |room: usize| side_of(&world.plan, room);
        let wanted = of(known[known.len() - 1]);
        (0..rooms).filter(|room| of(*room) == wanted && !known[..few].contains(room)).collect()
    };
    let mut second = first.clone();
    second.renumber(&side, patterns, rng);
    vec![Era { from_round: FEW.0, world: first }, Era { from_round: SIDE, world: second }]
}

/// Returns the world of a round.
pub fn world_of<'a>(first: &'a World, eras: &'a [Era], round: usize) -> &'a World {
    let era = eras.iter().rev().find(|era| era.from_round <= round);
    era.map_or(first, |era| &era.world)
}

/// Returns the side of the ring with a room's door, 0 to 3.
fn side_of(plan: &FloorPlan, room: usize) -> usize {
    let along_m = plan.rooms[room].along_m.rem_euclid(plan.ring_m());
    plan.corners_m().iter().filter(|corner_m| **corner_m <= along_m).count()
}

/// Returns the round of a visit: each round has one stay per room, with the corridor between.
pub fn round_of(visit: usize) -> usize {
    (visit / (2 * ROOMS)).min(ROUNDS - 1)
}

/// The queries of one round.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Round {
    /// All queries.
    pub all: Counts,
    /// Those whose image shows a replaced plate, and no other plate.
    pub at_new_plates: Counts,
}

/// Counts the queries of an arm by round.
pub fn by_round(driven: &RunResult, journey: &Sequence, first: &World, eras: &[Era]) -> Vec<Round> {
    let is_new = |text: &str, round: usize| world_of(first, eras, round).renumbered.contains(text);
    let shows_new_plates_alone = |keyframe: usize, round: usize| {
        let plates: BTreeSet<&str> = (journey.steps[keyframe].detections.iter())
            .filter(|detection| detection.class == SignKind::DoorPlate.as_str())
            .map(|detection| detection.text.as_str())
            .collect();
        !plates.is_empty() && plates.iter().all(|text| is_new(text, round))
    };
    let round_of_query = |keyframe: usize| round_of(journey.steps[keyframe].stop.visit);
    (0..ROUNDS)
        .map(|round| {
            let of_round: Vec<_> =
                driven.asked.iter().filter(|asked| round_of_query(asked.keyframe.1) == round).collect();
            let all: Vec<_> = of_round.iter().map(|asked| asked.scored).collect();
            let new = of_round.iter().filter(|asked| shows_new_plates_alone(asked.keyframe.1, round));
            let new: Vec<_> = new.map(|asked| asked.scored).collect();
            Round { all: by_query(&all), at_new_plates: by_query(&new) }
        })
        .collect()
}

/// The signs of a map at the end of a tour, by their final state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Signs {
    /// Retired plates that were removed.
    pub retired_gone: u64,
    /// Retired signs that still hang.
    pub retired_hanging: u64,
    /// Retired texts that never hung anywhere, because they were misread.
    pub retired_misread: u64,
    /// Removed plates that are still valid.
    pub valid_gone: u64,
}

impl Signs {
    /// Counts the anchors of a map, each with its state, class and description.
    pub fn count<'a>(
        anchors: impl IntoIterator<Item = (&'a str, &'a str, &'a str)>,
        first: &World,
        eras: &[Era],
    ) -> Self {
        let last = world_of(first, eras, ROUNDS);
        let has = |world: &World, text: &str| world.signs.iter().any(|sign| sign.text == text);
        let mut counted = Self::default();
        for (state, class, text) in anchors {
            let is_plate = class == SignKind::DoorPlate.as_str();
            let hangs = !is_plate || has(last, text);
            let hung =
                [first].into_iter().chain(eras.iter().map(|era| &era.world)).any(|world| has(world, text));
            match state {
                "retired" if hangs => counted.retired_hanging += 1,
                "retired" if hung => counted.retired_gone += 1,
                "retired" => counted.retired_misread += 1,
                "valid" if hung && !hangs => counted.valid_gone += 1,
                _ => {}
            }
        }
        counted
    }

    /// Adds the counts of another map.
    pub fn plus(self, other: Self) -> Self {
        Self {
            retired_gone: self.retired_gone + other.retired_gone,
            retired_hanging: self.retired_hanging + other.retired_hanging,
            retired_misread: self.retired_misread + other.retired_misread,
            valid_gone: self.valid_gone + other.valid_gone,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::floor_plan::Layout;
    use super::super::signs::SignPlan;
    use super::super::world::WorldPlan;
    use super::*;

    fn renumbered_floor() -> (World, Vec<Era>) {
        let patterns = Patterns::new();
        let plan = WorldPlan { layout: Layout::SE1, floor: 9, signs: SignPlan::default(), seed: 901 };
        let world = World::new(&plan, &patterns);
        let eras = eras(&world, &[3, 11], &patterns, &mut SeededRng::new(1, "renumbering"));
        (world, eras)
    }

    #[test]
    fn new_plates_have_numbers_and_digits_that_the_floor_did_not_have() {
        let (world, eras) = renumbered_floor();
        let [few, side] = [0, 1].map(|era| &eras[era].world);
        assert_eq!([eras[0].from_round, eras[1].from_round], [1, 4]);
        let plates = |world: &World| -> Vec<String> {
            let plates = world.signs.iter().filter(|sign| sign.kind == SignKind::DoorPlate);
            plates.map(|plate| plate.text.clone()).collect()
        };
        let changed = |a: &World, b: &World| {
            plates(a).iter().zip(&plates(b)).filter(|(before, after)| before != after).count()
        };
        // One plate in ten, of the doors on the tour; then a whole side.
        assert_eq!(changed(&world, few), 2);
        assert!(changed(few, side) >= 3, "{:?}", plates(side));
        for (before, after) in [(&world, few), (few, side)] {
            let numbers: BTreeSet<String> = plates(after).into_iter().collect();
            assert_eq!(numbers.len(), after.plan.rooms.len(), "each number once");
            assert!(before.renumbered.is_subset(&after.renumbered));
            assert!(world.numbers.iter().all(|number| !after.renumbered.contains(number)));
            let looks = |point: usize| before.points[point].descriptor != after.points[point].descriptor;
            let digits = (0..after.points.len()).filter(|point| looks(*point)).count();
            assert_eq!(digits, 6 * changed(before, after), "six of a plate's sixteen points");
        }
        assert_eq!(plates(side), side.numbers);
    }

    #[test]
    fn signs_are_counted_by_what_hangs_there_in_the_end() {
        let (world, eras) = renumbered_floor();
        let last = &eras[1].world;
        let gone = world.numbers.iter().find(|number| !last.numbers.contains(number)).unwrap().as_str();
        let hangs = last.numbers[0].as_str();
        let anchors = [
            ("retired", "door_number", gone),
            ("retired", "door_number", hangs),
            ("retired", "painting", "a painting of a fox"),
            ("retired", "door_number", "9999"),
            ("valid", "door_number", gone),
            ("valid", "door_number", hangs),
            ("uninformative", "door_number", gone),
        ];
        let counted = Signs::count(anchors, &world, &eras);
        let expected = Signs { retired_gone: 1, retired_hanging: 2, retired_misread: 1, valid_gone: 1 };
        assert_eq!(counted, expected);
    }

    #[test]
    fn a_round_is_a_stay_in_each_room_and_the_ways_between() {
        assert_eq!([0, 3, 4, 15, 16, 31, 32].map(round_of), [0, 0, 1, 3, 4, 7, 7]);
    }
}
