//! The cycle that shows a suspect: the loops that lead back from its one session to the other, and do not agree with it.

use std::collections::{BTreeMap, VecDeque};

use super::measurement::{Measurement, way_m};
use crate::domain::ids::{LoopId, SessionSeq};
use crate::recognition::map::index::MapIndex;

/// Returns the loops of the way with fewest sessions between those of a suspect, from its candidate's to its keyframe's; a plan that is
/// passed has no name. Between two sessions the loop is taken that was closed nearest to the suspect, the first of equals.
pub fn cycle(index: &MapIndex, suspect: &Measurement, counting: &[&Measurement]) -> Vec<LoopId> {
    let mut joined: BTreeMap<SessionSeq, BTreeMap<SessionSeq, &Measurement>> = BTreeMap::new();
    for one in counting {
        for (from, to) in [(one.a, one.b), (one.b, one.a)] {
            let known = joined.entry(from).or_default().entry(to).or_insert(one);
            if distance(index, suspect, one) < distance(index, suspect, known) {
                *known = one;
            }
        }
    }
    let mut came: BTreeMap<SessionSeq, (SessionSeq, &Measurement)> = BTreeMap::new();
    let mut open = VecDeque::from([suspect.a]);
    while let Some(session) = open.pop_front().filter(|session| *session != suspect.b) {
        for (next, one) in joined.get(&session).into_iter().flatten() {
            if *next != suspect.a && !came.contains_key(next) {
                came.insert(*next, (session, one));
                open.push_back(*next);
            }
        }
    }
    let (mut way, mut at) = (Vec::new(), suspect.b);
    while let Some((before, one)) = came.get(&at) {
        way.extend(one.loop_id.clone());
        at = *before;
    }
    way.reverse();
    way
}

/// Returns how far from a suspect another loop was closed, in metres, along the sessions that they share.
fn distance(index: &MapIndex, suspect: &Measurement, other: &Measurement) -> f64 {
    let places = [(suspect.a, suspect.at_a), (suspect.b, suspect.at_b)];
    let of_other = [(other.a, other.at_a), (other.b, other.at_b)];
    let shared = places.iter().flat_map(|(session, at)| {
        of_other.iter().filter(move |(of, _)| of == session).map(move |(_, there)| (at, there))
    });
    shared.map(|(at, there)| way_m(index, at, there)).sum()
}
