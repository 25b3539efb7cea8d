//! Refinement: the frames that the agreeing loops fit best, while those that contradict the cycles lose their weight.
//!
//! Graduated non-convexity with the Geman-McClure cost (Yang, Antonante, Tzoumas, Carlone: "Graduated non-convexity for robust spatial
//! perception", RA-L 2020): at first all
//! loops pull, then less and less those between two sessions that are off in common by more than they may be. In between,
//! Gauss-Newton steps of the [`pose graph`](super::pose_graph) of the sessions.

use std::collections::BTreeMap;

use nalgebra::Vector3;

use super::measurement::Measurement;
use super::pose_graph::{Edge, step};
use super::tree::Placed;
use crate::domain::ids::SessionSeq;
use crate::geometry::Pose;

/// By how much the cost becomes less convex from round to round.
const CONVEXITY_STEP: f64 = 1.4;
/// Rounds at the last cost.
const LAST_ROUNDS: usize = 8;
/// Rounds in all.
const ROUNDS_MAX: usize = 80;
/// The weight from which on a loop counts as agreeing.
pub const WEIGHT_MIN: f64 = 0.25;

/// The agreeing loops between two sessions. They hold together: what pulls them apart is drift, and what is off in all of them is the
/// pair.
#[derive(Clone, Debug)]
pub struct Joint<'m> {
    /// The loops.
    pub measurements: Vec<&'m Measurement>,
    /// The error from rigid frames that they may have in common, in metres.
    pub allowed_m: f64,
    /// And in radians.
    pub allowed_rad: f64,
}

/// Refines the frames, and returns the weight of each joint, from 0 to 1. Those below [`WEIGHT_MIN`] pull at nothing in the end.
pub fn refine(placed: &mut BTreeMap<SessionSeq, Placed>, joints: &[Joint<'_>]) -> Vec<f64> {
    let numbers: BTreeMap<SessionSeq, usize> = placed.keys().copied().zip(0..).collect();
    let mut frames: Vec<Pose> = placed.values().map(|of| of.root_from_session).collect();
    let is_root: Vec<bool> = placed.iter().map(|(session, of)| *session == of.root).collect();
    let joints: Vec<Vec<Edge>> = joints.iter().map(|joint| joint.edges(&numbers)).collect();
    let move_frames = |frames: &mut [Pose], weights: &[f64]| {
        let weighted =
            joints.iter().zip(weights).flat_map(|(joint, weight)| joint.iter().map(|edge| (edge, *weight)));
        step(frames, |number| is_root[number], weighted, 0.0);
    };
    let worst = joints.iter().map(|joint| off(&frames, joint)).fold(0.0, f64::max);
    let mut convexity = (2.0 * worst).max(1.0);
    let mut weights = vec![1.0; joints.len()];
    let (mut last, mut rounds) = (0, 0);
    while last < LAST_ROUNDS && rounds < ROUNDS_MAX {
        rounds += 1;
        move_frames(&mut frames, &weights);
        for (weight, joint) in weights.iter_mut().zip(&joints) {
            *weight = (convexity / (off(&frames, joint) + convexity)).powi(2);
        }
        if convexity <= 1.0 {
            last += 1;
        }
        convexity = (convexity / CONVEXITY_STEP).max(1.0);
    }
    let held: Vec<f64> = weights.iter().map(|weight| if *weight < WEIGHT_MIN { 0.0 } else { 1.0 }).collect();
    for _ in 0..LAST_ROUNDS {
        move_frames(&mut frames, &held);
    }
    for (of, frame) in placed.values_mut().zip(frames) {
        of.root_from_session = frame;
    }
    weights
}

impl Joint<'_> {
    fn edges(&self, numbers: &BTreeMap<SessionSeq, usize>) -> Vec<Edge> {
        let edge = |of: &&Measurement| Edge {
            a: numbers[&of.a],
            b: numbers[&of.b],
            a_from_b: of.a_from_b,
            at: of.at_b.at,
            unit_m: self.allowed_m,
            unit_rad: self.allowed_rad,
        };
        self.measurements.iter().map(edge).collect()
    }
}

/// Returns the square of how far the loops of a joint are off in common, in units of what they may be.
fn off(frames: &[Pose], joint: &[Edge]) -> f64 {
    let mut common = (Vector3::zeros(), Vector3::zeros());
    for edge in joint {
        let residual = edge.residual(frames);
        common = (common.0 + residual.place, common.1 + residual.turn);
    }
    let count = joint.len().max(1) as f64;
    (common.0 / count).norm_squared() + (common.1 / count).norm_squared()
}
