//! Scores of a set of worlds: by query, by visit, false loops in 1,000 queries, sessions joined that never met.

use std::collections::{BTreeMap, BTreeSet};

use super::play::{Asked, Played};
use super::truth::Standing;

/// The counts of one kind, or of all.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Score {
    /// Worlds.
    pub worlds: usize,
    /// Queries.
    pub queries: u64,
    /// Queries about a place that was seen before.
    pub with_truth: u64,
    /// Answers that name the place.
    pub right: u64,
    /// Answers that name a place near it: neither right nor wrong.
    pub near: u64,
    /// Answers that name another place.
    pub wrong: u64,
    /// Visits of a place that was seen before.
    pub visits_with_truth: u64,
    /// Visits whose first answer is right.
    pub visits_right: u64,
    /// Visits whose first answer is wrong.
    pub visits_wrong: u64,
    /// Pairs of sessions that a wrong loop joins and that were never in one place.
    pub joined: u64,
    /// The grounds of the wrong loops.
    pub causes: BTreeMap<String, u64>,
}

impl Score {
    /// Returns the score of some worlds.
    pub fn of<'p>(worlds: impl IntoIterator<Item = &'p Played>) -> Self {
        let mut score = Self::default();
        for played in worlds {
            score.add(played);
        }
        score
    }

    fn add(&mut self, played: &Played) {
        self.worlds += 1;
        let mut joined = BTreeSet::new();
        let mut visits: BTreeMap<&str, Vec<&Asked>> = BTreeMap::new();
        for asked in &played.asked {
            self.queries += 1;
            self.with_truth += u64::from(asked.has_truth);
            visits.entry(&asked.visit).or_default().push(asked);
            let Some(named) = &asked.named else { continue };
            match named.standing {
                Standing::Right => self.right += 1,
                Standing::Near => self.near += 1,
                Standing::Wrong => {
                    self.wrong += 1;
                    joined.extend(named.never_met);
                    *self.causes.entry(named.rests_on.clone()).or_default() += 1;
                }
            }
        }
        self.joined += joined.len() as u64;
        for asked in visits.values() {
            self.visits_with_truth += u64::from(asked.iter().any(|asked| asked.has_truth));
            let standings = asked.iter().filter_map(|asked| asked.named.as_ref()).map(|named| named.standing);
            match standings.into_iter().find(|standing| *standing != Standing::Near) {
                Some(Standing::Right) => self.visits_right += 1,
                Some(Standing::Wrong) => self.visits_wrong += 1,
                _ => {}
            }
        }
    }

    /// Returns the false loops in 1,000 queries.
    pub fn false_in_thousand(&self) -> f64 {
        1_000.0 * self.wrong as f64 / self.queries.max(1) as f64
    }
}
