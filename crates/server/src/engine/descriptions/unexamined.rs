//! Maps that may have work for models, are not in memory, and have no board yet.

use std::collections::VecDeque;
use std::time::Duration;

use tokio::time::Instant;

use super::backlog::PAUSE_MAX;
use crate::domain::ids::MapId;

/// Rest of a map after its first failed load. Each further failure doubles it.
const FIRST_REST: Duration = Duration::from_millis(250);

/// The rest doubles at most this often.
const DOUBLINGS_MAX: u32 = 14;

/// A map whose turn is to come.
#[derive(Debug)]
pub(in crate::engine) struct Unexamined {
    /// The map.
    pub map: MapId,
    /// Failed loads in a row.
    failures: u32,
    not_before: Option<Instant>,
}

/// The maps to be looked at once, oldest first.
#[derive(Debug, Default)]
pub(in crate::engine) struct UnexaminedMaps(VecDeque<Unexamined>);

impl UnexaminedMaps {
    /// Adds a map, at once if it rested.
    pub fn add(&mut self, map: MapId) {
        match self.0.iter_mut().find(|waiting| waiting.map == map) {
            Some(waiting) => waiting.not_before = None,
            None => self.0.push_back(Unexamined { map, failures: 0, not_before: None }),
        }
    }

    /// Takes the oldest map that does not rest.
    pub fn take(&mut self, now: Instant) -> Option<Unexamined> {
        let is_due = |waiting: &Unexamined| waiting.not_before.is_none_or(|at| at <= now);
        let place = self.0.iter().position(is_due)?;
        self.0.remove(place)
    }

    /// Puts a map back that could not be loaded. It rests, so that a failing disk is not asked without a pause.
    pub fn put_back(&mut self, failed: Unexamined, now: Instant) {
        let rest = FIRST_REST.saturating_mul(1 << failed.failures.min(DOUBLINGS_MAX)).min(PAUSE_MAX);
        let failures = failed.failures + 1;
        self.0.push_back(Unexamined { failures, not_before: Some(now + rest), ..failed });
    }

    /// Returns when the next map is due.
    pub fn next_due(&self, now: Instant) -> Option<Instant> {
        self.0.iter().map(|waiting| waiting.not_before.unwrap_or(now)).min()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_map_rests_longer_each_time_and_others_go_before_it() {
        let (mut maps, now) = (UnexaminedMaps::default(), Instant::now());
        let named = |name: &str| name.parse::<MapId>().expect("an id");
        maps.add(named("failing"));
        maps.add(named("well"));
        let failing = maps.take(now).expect("a map");
        maps.put_back(failing, now);
        assert_eq!(maps.take(now).map(|due| due.map), Some(named("well")));
        assert_eq!((maps.take(now).map(|due| due.map), maps.next_due(now)), (None, Some(now + FIRST_REST)));
        let failing = maps.take(now + FIRST_REST).expect("a map");
        maps.put_back(failing, now);
        assert_eq!(maps.next_due(now), Some(now + FIRST_REST * 2));
        // A write is a reason to look at once.
        maps.add(named("failing"));
        assert_eq!(maps.take(now).map(|due| due.map), Some(named("failing")));
        assert_eq!(maps.next_due(now), None);
    }
}
