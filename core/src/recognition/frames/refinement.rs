//! Refinement: the frames that the agreeing loops fit best, while those that contradict the cycles lose their weight.
//!
//! Graduated non-convexity with the Geman-McClure cost (Yang, Antonante, Tzoumas, Carlone: "Graduated non-convexity for robust spatial
//! perception", RA-L 2020): at first all
//! loops pull, then less and less those between two sessions that are off in common by more than they may be. In between,
//! Gauss-Newton steps; their linear systems are solved by conjugate gradients, block by block.

use std::collections::BTreeMap;

use nalgebra::{Matrix3, Matrix6, UnitQuaternion, Vector3, Vector6};

use super::measurement::Measurement;
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
/// The share of its length to which the gradient of a linear system is brought.
const GRADIENT_SHARE: f64 = 1e-12;
/// The weight that holds each unknown in place, so that each system has one solution.
const DAMPING: f64 = 1e-9;

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
    let worst = joints.iter().map(|joint| off(placed, joint)).fold(0.0, f64::max);
    let mut convexity = (2.0 * worst).max(1.0);
    let mut weights = vec![1.0; joints.len()];
    let (mut last, mut rounds) = (0, 0);
    while last < LAST_ROUNDS && rounds < ROUNDS_MAX {
        rounds += 1;
        step(placed, joints, &weights);
        for (weight, joint) in weights.iter_mut().zip(joints) {
            *weight = (convexity / (off(placed, joint) + convexity)).powi(2);
        }
        if convexity <= 1.0 {
            last += 1;
        }
        convexity = (convexity / CONVEXITY_STEP).max(1.0);
    }
    let held: Vec<f64> = weights.iter().map(|weight| if *weight < WEIGHT_MIN { 0.0 } else { 1.0 }).collect();
    for _ in 0..LAST_ROUNDS {
        step(placed, joints, &held);
    }
    weights
}

/// Returns the square of how far the loops of a joint are off in common, in units of what they may be.
fn off(placed: &BTreeMap<SessionSeq, Placed>, joint: &Joint<'_>) -> f64 {
    let mut common = (Vector3::zeros(), Vector3::zeros());
    for measurement in &joint.measurements {
        let residual = residual(placed, measurement, joint);
        common = (common.0 + residual.place, common.1 + residual.turn);
    }
    let count = joint.measurements.len().max(1) as f64;
    (common.0 / count).norm_squared() + (common.1 / count).norm_squared()
}

/// The error of a loop in units of what it may be: in place, and in rotation.
#[derive(Clone, Copy, Debug)]
struct Residual {
    place: Vector3<f64>,
    turn: Vector3<f64>,
    /// The place of the loop in the root's frame, as the one session has it, and as the other.
    at: [Vector3<f64>; 2],
    /// The rotation that remains, in radians.
    turn_rad: Vector3<f64>,
}

fn residual(placed: &BTreeMap<SessionSeq, Placed>, measurement: &Measurement, joint: &Joint<'_>) -> Residual {
    let Measurement { a, b, a_from_b, at_b, .. } = measurement;
    let [a, b] = [a, b].map(|session| placed[session].root_from_session);
    let (by_a, by_b) = (a.transform(&a_from_b.transform(&at_b.at)).coords, b.transform(&at_b.at).coords);
    let turn: UnitQuaternion<f64> =
        a.isometry().rotation * a_from_b.isometry().rotation * b.isometry().rotation.inverse();
    let turn_rad = turn.scaled_axis();
    Residual {
        place: (by_a - by_b) / joint.allowed_m,
        turn: turn_rad / joint.allowed_rad,
        at: [by_a, by_b],
        turn_rad,
    }
}

/// Returns the derivatives of a residual by a small motion of either session: first the translation, then the rotation, in the
/// root's frame, applied after the session's own transformation.
fn jacobians(residual: &Residual, joint: &Joint<'_>) -> [Matrix6<f64>; 2] {
    let (by_m, by_rad) = (joint.allowed_m.recip(), joint.allowed_rad.recip());
    let [by_a, by_b] = residual.at.map(|at| at.cross_matrix());
    let moved = Matrix3::identity() * by_m;
    let jacobian = |moved: Matrix3<f64>, swung: Matrix3<f64>, turned: Matrix3<f64>| {
        let mut jacobian = Matrix6::zeros();
        jacobian.fixed_view_mut::<3, 3>(0, 0).copy_from(&moved);
        jacobian.fixed_view_mut::<3, 3>(0, 3).copy_from(&swung);
        jacobian.fixed_view_mut::<3, 3>(3, 3).copy_from(&turned);
        jacobian
    };
    let turned = inverse_left_jacobian(&residual.turn_rad) * by_rad;
    let turned_back = -inverse_left_jacobian(&-residual.turn_rad) * by_rad;
    [jacobian(moved, -by_a * by_m, turned), jacobian(-moved, by_b * by_m, turned_back)]
}

/// Returns the inverse of the left Jacobian of SO(3) at a rotation vector.
fn inverse_left_jacobian(turn: &Vector3<f64>) -> Matrix3<f64> {
    let (angle, cross) = (turn.norm(), turn.cross_matrix());
    let second = if angle < 1e-4 {
        1.0 / 12.0
    } else {
        let half = angle / 2.0;
        (1.0 - half / libm::tan(half)) / angle.powi(2)
    };
    Matrix3::identity() - cross * 0.5 + cross * cross * second
}

/// One Gauss-Newton step. Roots stay.
fn step(placed: &mut BTreeMap<SessionSeq, Placed>, joints: &[Joint<'_>], weights: &[f64]) {
    let mut unknown: BTreeMap<SessionSeq, usize> = BTreeMap::new();
    for (session, _) in placed.iter().filter(|(session, of)| **session != of.root) {
        let number = unknown.len();
        unknown.insert(*session, number);
    }
    if unknown.is_empty() {
        return;
    }
    let mut system = System::of(unknown.len());
    for (joint, weight) in joints.iter().zip(weights) {
        for measurement in &joint.measurements {
            let residual = residual(placed, measurement, joint);
            let ends = [measurement.a, measurement.b].map(|session| unknown.get(&session).copied());
            system.add(ends, &jacobians(&residual, joint), &residual, *weight);
        }
    }
    let moved = system.solve();
    for (session, number) in unknown {
        let by = &moved[number];
        let turn = UnitQuaternion::from_scaled_axis(by.fixed_rows::<3>(3).into_owned());
        let Some(of) = placed.get_mut(&session) else { continue };
        let before = of.root_from_session.isometry();
        let translation = turn * before.translation.vector + by.fixed_rows::<3>(0);
        let mut rotation = turn * before.rotation;
        rotation.renormalize();
        of.root_from_session = Pose::from(nalgebra::Isometry3::from_parts(translation.into(), rotation));
    }
}

/// The normal equations: blocks on the diagonal, and one for each two sessions that a loop joins.
struct System {
    diagonal: Vec<Matrix6<f64>>,
    joined: BTreeMap<(usize, usize), Matrix6<f64>>,
    right: Vec<Vector6<f64>>,
}

impl System {
    fn of(count: usize) -> Self {
        let held = Matrix6::identity() * DAMPING;
        Self { diagonal: vec![held; count], joined: BTreeMap::new(), right: vec![Vector6::zeros(); count] }
    }

    fn add(
        &mut self,
        ends: [Option<usize>; 2],
        jacobians: &[Matrix6<f64>; 2],
        residual: &Residual,
        weight: f64,
    ) {
        let mut off = Vector6::zeros();
        off.fixed_rows_mut::<3>(0).copy_from(&residual.place);
        off.fixed_rows_mut::<3>(3).copy_from(&residual.turn);
        for (end, jacobian) in ends.iter().zip(jacobians) {
            let Some(number) = *end else { continue };
            self.diagonal[number] += jacobian.transpose() * jacobian * weight;
            self.right[number] -= jacobian.transpose() * off * weight;
        }
        if let [Some(a), Some(b)] = ends
            && a != b
        {
            let block = jacobians[0].transpose() * jacobians[1] * weight;
            let (at, block) = if a < b { ((a, b), block) } else { ((b, a), block.transpose()) };
            *self.joined.entry(at).or_insert_with(Matrix6::zeros) += block;
        }
    }

    fn times(&self, of: &[Vector6<f64>]) -> Vec<Vector6<f64>> {
        let mut product: Vec<Vector6<f64>> =
            self.diagonal.iter().zip(of).map(|(block, of)| block * of).collect();
        for ((a, b), block) in &self.joined {
            product[*a] += block * of[*b];
            product[*b] += block.transpose() * of[*a];
        }
        product
    }

    /// Solves the system by conjugate gradients, preconditioned by the blocks on the diagonal.
    fn solve(&self) -> Vec<Vector6<f64>> {
        let count = self.right.len();
        let inverse: Vec<Matrix6<f64>> = self
            .diagonal
            .iter()
            .map(|block| block.cholesky().map_or_else(Matrix6::identity, |factor| factor.inverse()))
            .collect();
        let conditioned = |of: &[Vector6<f64>]| -> Vec<Vector6<f64>> {
            inverse.iter().zip(of).map(|(inverse, of)| inverse * of).collect()
        };
        let dot =
            |a: &[Vector6<f64>], b: &[Vector6<f64>]| -> f64 { a.iter().zip(b).map(|(a, b)| a.dot(b)).sum() };
        let mut solution = vec![Vector6::zeros(); count];
        let mut rest = self.right.clone();
        let mut towards = conditioned(&rest);
        let mut direction = towards.clone();
        let mut slope = dot(&rest, &towards);
        let enough = slope * GRADIENT_SHARE.powi(2);
        for _ in 0..12 * count + 24 {
            if slope <= enough || slope == 0.0 {
                break;
            }
            let along = self.times(&direction);
            let length = slope / dot(&direction, &along);
            for number in 0..count {
                solution[number] += direction[number] * length;
                rest[number] -= along[number] * length;
            }
            towards = conditioned(&rest);
            let next = dot(&rest, &towards);
            for number in 0..count {
                direction[number] = towards[number] + direction[number] * (next / slope);
            }
            slope = next;
        }
        solution
    }
}

#[cfg(test)]
mod tests;
