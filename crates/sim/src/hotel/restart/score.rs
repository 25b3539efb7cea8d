//! Which answers are right: the floor, and the room or the part of the corridor.

use std::fmt::Write as _;

use serde::Serialize;

use super::asking::map_of;
use super::world::{Restart, RestartWorld};
use crate::api::location::LocateAnswerView;
use crate::domain::location::LocationVerdict;
use crate::hotel::route::Place;
use crate::hotel::run::session;
use crate::hotel::scoring::truth::apart_m;

/// In the corridor a place is right within this distance, in metres.
const SAME_PART_M: f64 = 3.0;

/// Counts of the answers to some restarts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct RestartCounts {
    /// The restarts.
    pub asked: usize,
    /// Those located.
    pub located: usize,
    /// Of these, those on the right floor.
    pub right_floor: usize,
    /// Of these, those in the right room, or within three metres in the corridor.
    pub right_room: usize,
    /// Those answered `ambiguous`.
    pub ambiguous: usize,
}

/// Counts of all restarts, and of those that matter most.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct RestartScore {
    /// Where a robot stood when the floor was mapped.
    pub mapped: RestartCounts,
    /// Of these, restarts that read the numbers of two doors right.
    pub two_plates: RestartCounts,
    /// Where no robot stood: what the map can know of them are signs.
    pub unmapped: RestartCounts,
}

impl RestartScore {
    /// Adds an answer.
    pub fn add(&mut self, seed: u64, world: &RestartWorld, restart: &Restart, answer: &LocateAnswerView) {
        let counts = if restart.is_mapped { &mut self.mapped } else { &mut self.unmapped };
        counts.add(seed, world, restart, answer);
        if restart.is_mapped && restart.reads_two_plates {
            self.two_plates.add(seed, world, restart, answer);
        }
    }

    /// Returns the table.
    pub fn table(&self) -> String {
        let mut text = String::from(
            "Restarts                            asked  located  right floor  right room  ambiguous\n",
        );
        let rows = [
            ("where a robot stood before", self.mapped),
            ("  of these, two door plates read", self.two_plates),
            ("where none did", self.unmapped),
        ];
        for (name, counts) in rows {
            let RestartCounts { asked, located, right_floor, right_room, ambiguous } = counts;
            let _ = writeln!(
                text,
                "{name:34}  {asked:>5}  {located:>7}  {right_floor:>11}  {right_room:>10}  {ambiguous:>9}"
            );
        }
        text
    }
}

impl RestartCounts {
    fn add(&mut self, seed: u64, world: &RestartWorld, restart: &Restart, answer: &LocateAnswerView) {
        self.asked += 1;
        self.ambiguous += usize::from(answer.verdict.0 == LocationVerdict::Ambiguous);
        if answer.verdict.0 != LocationVerdict::Located {
            return;
        }
        self.located += 1;
        let Some(place) = answer.places.first() else { return };
        // The keyframe that stands for the place shows what one of those that ask saw, not always the first.
        let step = &restart.steps[place.asked.unwrap_or(0) as usize];
        let (seen, storey) = (step.stop.place, step.stop.storey);
        if place.map != map_of(seed, storey) {
            return;
        }
        self.right_floor += 1;
        let named = place.keyframe.as_deref();
        let number = named.and_then(|id| id.strip_prefix(&format!("{}-", session(0)))?.parse::<usize>().ok());
        let shown = number.and_then(|number| world.journeys[storey].steps.get(number));
        self.right_room += usize::from(shown.is_some_and(|shown| {
            let is_same_room = shown.stop.place == seen && seen != Place::Corridor;
            is_same_room || apart_m(shown, step) <= SAME_PART_M
        }));
    }
}
