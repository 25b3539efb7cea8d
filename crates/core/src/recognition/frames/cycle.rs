//! The cycle that shows a suspect: the loops that lead back from its one session to the other, and do not agree with it.

use std::collections::{BTreeMap, VecDeque};

use super::consensus::COMPARED_MAX;
use super::measurement::Measurement;
use super::tree::Pair;
use crate::domain::ids::{LoopId, SessionSeq};

/// The loops that count, by the two sessions that they join.
#[derive(Debug, Default)]
pub struct Joined<'m> {
    pairs: BTreeMap<Pair, Vec<&'m Measurement>>,
    neighbours: BTreeMap<SessionSeq, Vec<SessionSeq>>,
}

impl<'m> Joined<'m> {
    /// Returns the sessions as these loops join them.
    pub fn of(counting: impl Iterator<Item = &'m Measurement>) -> Self {
        let mut joined = Self::default();
        for one in counting {
            joined.pairs.entry((one.a, one.b)).or_default().push(one);
        }
        for (a, b) in joined.pairs.keys() {
            joined.neighbours.entry(*a).or_default().push(*b);
            joined.neighbours.entry(*b).or_default().push(*a);
        }
        joined
    }

    /// Returns the loops of the way with fewest sessions between those of a suspect; a plan that is passed has no name. Between two
    /// sessions the loop is taken that was closed nearest to the suspect, the first of equals.
    pub fn cycle(&self, suspect: &Measurement) -> Vec<LoopId> {
        let mut came: BTreeMap<SessionSeq, SessionSeq> = BTreeMap::new();
        let mut open = VecDeque::from([suspect.a]);
        while let Some(session) = open.pop_front().filter(|session| *session != suspect.b) {
            for next in self.neighbours.get(&session).into_iter().flatten() {
                if *next != suspect.a && !came.contains_key(next) {
                    came.insert(*next, session);
                    open.push_back(*next);
                }
            }
        }
        let (mut way, mut at) = (Vec::new(), suspect.b);
        while let Some(before) = came.get(&at) {
            let nearest = self.nearest(suspect, (at.min(*before), at.max(*before)));
            way.extend(nearest.and_then(|one| one.loop_id.clone()));
            at = *before;
        }
        way.reverse();
        way
    }

    fn nearest(&self, suspect: &Measurement, pair: Pair) -> Option<&'m Measurement> {
        let between = self.pairs.get(&pair)?;
        let step = between.len().div_ceil(COMPARED_MAX);
        let far = between.iter().step_by(step).map(|one| (distance_m(suspect, one), *one));
        far.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, one)| one)
    }
}

/// Returns how far from a suspect another loop was closed, along the sessions that they share.
fn distance_m(suspect: &Measurement, other: &Measurement) -> f64 {
    let places = [(suspect.a, suspect.at_a), (suspect.b, suspect.at_b)];
    let of_other = [(other.a, other.at_a), (other.b, other.at_b)];
    let shared = places.iter().flat_map(|(session, at)| {
        of_other.iter().filter(move |(of, _)| of == session).map(move |(_, there)| (at, there))
    });
    shared.map(|(at, there)| at.way_to_m(there)).sum()
}
