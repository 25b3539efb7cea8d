//! Truth: which earlier keyframes show the same place. It comes from the simulator alone, and no server receives it.

use std::collections::BTreeSet;

use crate::hotel::robot::slam_map::COVISIBLE_POINTS;
use crate::hotel::route::heading_difference_rad;
use crate::hotel::sequence::{Sequence, Step};

/// Maximum distance of keyframes at one place, in metres.
const SAME_PLACE_M: f64 = 1.0;
/// Maximum difference of their viewing directions.
const SAME_VIEW_RAD: f64 = 30.0 / 180.0 * std::f64::consts::PI;
/// Shared physical points from which a farther keyframe is neither correct nor wrong.
const SAME_POINTS: usize = 25;

/// Height of a floor, in metres.
const STOREY_M: f64 = 3.0;

/// A keyframe of an experiment: the robot's number, and the keyframe's in its journey.
pub type KeyframeIndex = (usize, usize);

/// The truth of one query.
#[derive(Clone, Debug, Default)]
pub struct Answerable {
    /// The keyframes at the same place.
    pub truth: BTreeSet<KeyframeIndex>,
    /// The keyframes that are neither correct nor wrong.
    pub ignore: BTreeSet<KeyframeIndex>,
}

/// Returns the truth of each keyframe, in temporal order.
pub fn answers(journeys: &[Sequence], order: &[KeyframeIndex]) -> Vec<Answerable> {
    let step = |(robot, number): KeyframeIndex| &journeys[robot].steps[number];
    let points: Vec<Vec<(usize, u32)>> = order.iter().map(|at| points(step(*at))).collect();
    let ids: Vec<Vec<u64>> = order.iter().map(|at| sorted(step(*at).map_points.iter().copied())).collect();
    (order.iter().enumerate())
        .map(|(number, at)| {
            let mut answerable = Answerable::default();
            for (earlier, other) in order[..number].iter().enumerate() {
                if at.0 == other.0 && shared(&ids[number], &ids[earlier]) >= COVISIBLE_POINTS {
                    continue;
                }
                if is_same_place(step(*at), step(*other)) {
                    answerable.truth.insert(*other);
                } else if shared(&points[number], &points[earlier]) >= SAME_POINTS {
                    answerable.ignore.insert(*other);
                }
            }
            answerable
        })
        .collect()
}

/// Whether the two were taken at one place, facing the same direction.
pub fn is_same_place(a: &Step, b: &Step) -> bool {
    apart_m(a, b) < SAME_PLACE_M
        && heading_difference_rad(a.stop.stand.heading_rad, b.stop.stand.heading_rad) < SAME_VIEW_RAD
}

/// Returns the distance between the places of two keyframes, in metres.
pub fn apart_m(a: &Step, b: &Step) -> f64 {
    let (storey_a, storey_b) = (a.stop.storey, b.stop.storey);
    let (a, b) = (a.stop.stand.at, b.stop.stand.at);
    let up_m = STOREY_M * (storey_a.abs_diff(storey_b)) as f64;
    (a[0] - b[0]).hypot(a[1] - b[1]).hypot(up_m)
}

/// Returns the number of physical points that two keyframes share.
pub fn shared_points(a: &Step, b: &Step) -> usize {
    shared(&points(a), &points(b))
}

/// Returns the physical points that a keyframe sees: the floor, and the number there.
fn points(step: &Step) -> Vec<(usize, u32)> {
    sorted(step.features.iter().map(|feature| (step.stop.storey, feature.point)))
}

fn sorted<T: Ord>(items: impl Iterator<Item = T>) -> Vec<T> {
    let mut items: Vec<T> = items.collect();
    items.sort_unstable();
    items
}

/// Returns the number of items that two sorted lists share.
fn shared<T: Ord>(a: &[T], b: &[T]) -> usize {
    let (mut i, mut j, mut count) = (0, 0, 0);
    while i < a.len() && j < b.len() {
        match a[i].cmp(&b[j]) {
            std::cmp::Ordering::Less => i += 1,
            std::cmp::Ordering::Greater => j += 1,
            std::cmp::Ordering::Equal => (i, j, count) = (i + 1, j + 1, count + 1),
        }
    }
    count
}
