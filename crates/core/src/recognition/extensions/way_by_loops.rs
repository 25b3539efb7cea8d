//! The way by loops: how far odometry may have drifted between two keyframes, where confirmed loops tie the robot's way
//! together.
//!
//! A robot on its tenth round has driven far since the first, and knows all the same where it is: each confirmed loop tells
//! it. So the way between a keyframe of the tenth round and one of the first leads along tracked steps to a loop, through it
//! at no cost, and on.

use std::cmp::Reverse;
use std::collections::{BTreeSet, BinaryHeap};

use crate::domain::ids::KeyframeSeq;
use crate::recognition::map::index::MapIndex;

/// Keyframes that are looked at for the way between two.
pub const LOOKED_AT_MAX: usize = 4096;

/// Returns the length of the shortest way between two keyframes along tracked steps and through confirmed loops, in
/// micrometres; none if there is none that `is_short`, or it is too far to be found.
pub fn way_by_loops_um(
    index: &MapIndex,
    from: KeyframeSeq,
    to: KeyframeSeq,
    is_short: impl Fn(u64) -> bool,
) -> Option<u64> {
    // Dijkstra's algorithm; lengths are whole numbers, so that ties fall alike everywhere.
    let (mut open, mut reached) = (BinaryHeap::from([Reverse((0, from))]), BTreeSet::new());
    while let Some(Reverse((way_um, keyframe))) = open.pop() {
        if !is_short(way_um) || reached.len() >= LOOKED_AT_MAX {
            return None;
        }
        if keyframe == to {
            return Some(way_um);
        }
        if !reached.insert(keyframe) {
            continue;
        }
        let steps = index.steps_of(keyframe).map(|(other, step_um)| (way_um + step_um, other));
        let through = index.loops_of(keyframe).map(|closed| {
            (way_um, if closed.keyframe == keyframe { closed.candidate } else { closed.keyframe })
        });
        open.extend(steps.chain(through).filter(|(_, other)| !reached.contains(other)).map(Reverse));
    }
    None
}

#[cfg(test)]
mod tests;
