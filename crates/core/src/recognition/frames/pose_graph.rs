//! Pose graph: poses, the transformations measured between them, and one Gauss-Newton step towards the poses that fit these best
//! (G. Grisetti, R. Kümmerle, C. Stachniss and W. Burgard, "A tutorial on graph-based SLAM", 2010).
//!
//! A step's linear system is solved by conjugate gradients in blocks of six, preconditioned by an incomplete factor of the system
//! without fill-in. It is the exact factor of a chain of poses, so that iterations grow with the loops and not with the poses.

use std::collections::BTreeMap;

use nalgebra::{Isometry3, Matrix3, Matrix6, UnitQuaternion, Vector3, Vector6};

use crate::geometry::{Point3, Pose};

/// The share of its length to which the gradient of a linear system is brought.
const GRADIENT_SHARE: f64 = 1e-12;
/// The weight that holds each unknown in place, so that each system has one solution.
const HELD: f64 = 1e-9;

/// A transformation that was measured between two poses of a graph, by their numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edge {
    /// The pose in whose frame it was measured.
    pub a: usize,
    /// The pose that was measured.
    pub b: usize,
    /// Maps points of b's frame into a's.
    pub a_from_b: Pose,
    /// The place where it was measured, in the frame of b: there its error of translation is what it is.
    pub at: Point3,
    /// The unit of its error in place, such as its standard deviation, in metres.
    pub unit_m: f64,
    /// And in rotation, in radians.
    pub unit_rad: f64,
}

/// The error of an edge in its units: in place, and in rotation.
#[derive(Clone, Copy, Debug)]
pub struct Residual {
    /// In place.
    pub place: Vector3<f64>,
    /// In rotation.
    pub turn: Vector3<f64>,
    /// The place of the edge in the graph's frame, as the one pose has it, and as the other.
    at: [Vector3<f64>; 2],
    /// The rotation that remains, in radians.
    turn_rad: Vector3<f64>,
}

impl Edge {
    /// Returns the error that the poses leave.
    pub fn residual(&self, poses: &[Pose]) -> Residual {
        let [a, b] = [self.a, self.b].map(|number| poses[number]);
        let by_a = a.transform(&self.a_from_b.transform(&self.at)).coords;
        let by_b = b.transform(&self.at).coords;
        let turn: UnitQuaternion<f64> =
            a.isometry().rotation * self.a_from_b.isometry().rotation * b.isometry().rotation.inverse();
        let turn_rad = turn.scaled_axis();
        Residual {
            place: (by_a - by_b) / self.unit_m,
            turn: turn_rad / self.unit_rad,
            at: [by_a, by_b],
            turn_rad,
        }
    }

    /// Returns the derivatives of the residual by a small motion of either pose: first the translation, then the rotation, in the
    /// graph's frame, applied after the pose.
    fn jacobians(&self, residual: &Residual) -> [Matrix6<f64>; 2] {
        let (by_m, by_rad) = (self.unit_m.recip(), self.unit_rad.recip());
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
}

impl Residual {
    /// Returns the square of its length.
    pub fn square(&self) -> f64 {
        self.place.norm_squared() + self.turn.norm_squared()
    }
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

/// Moves the poses that are not held by one Gauss-Newton step, each edge with its weight. Damping shortens the step, by the share that it
/// adds to the system's diagonal (Levenberg-Marquardt).
pub fn step<'e>(
    poses: &mut [Pose],
    is_held: impl Fn(usize) -> bool,
    edges: impl IntoIterator<Item = (&'e Edge, f64)>,
    damping: f64,
) {
    let unknown: Vec<usize> = (0..poses.len()).filter(|number| !is_held(*number)).collect();
    let mut place_of = vec![None; poses.len()];
    for (place, number) in unknown.iter().enumerate() {
        place_of[*number] = Some(place);
    }
    let mut system = System::of(unknown.len());
    for (edge, weight) in edges {
        let residual = edge.residual(poses);
        let ends = [place_of[edge.a], place_of[edge.b]];
        system.add(ends, &edge.jacobians(&residual), &residual, weight);
    }
    system.damp(damping);
    for (number, by) in unknown.into_iter().zip(system.solve()) {
        poses[number] = moved(&poses[number], &by);
    }
}

/// Returns a pose after a small motion: a translation and a rotation vector, in the graph's frame.
fn moved(pose: &Pose, by: &Vector6<f64>) -> Pose {
    let turn = UnitQuaternion::from_scaled_axis(by.fixed_rows::<3>(3).into_owned());
    let before = pose.isometry();
    let translation = turn * before.translation.vector + by.fixed_rows::<3>(0);
    let mut rotation = turn * before.rotation;
    rotation.renormalize();
    Pose::from(Isometry3::from_parts(translation.into(), rotation))
}

/// The normal equations: blocks on the diagonal, and one for each two unknown poses that an edge joins, the lower number first.
struct System {
    diagonal: Vec<Matrix6<f64>>,
    joined: BTreeMap<(usize, usize), Matrix6<f64>>,
    right: Vec<Vector6<f64>>,
}

impl System {
    fn of(count: usize) -> Self {
        let held = Matrix6::identity() * HELD;
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
            let Some(place) = *end else { continue };
            self.diagonal[place] += jacobian.transpose() * jacobian * weight;
            self.right[place] -= jacobian.transpose() * off * weight;
        }
        if let [Some(a), Some(b)] = ends
            && a != b
        {
            let block = jacobians[0].transpose() * jacobians[1] * weight;
            let (at, block) = if a < b { ((a, b), block) } else { ((b, a), block.transpose()) };
            *self.joined.entry(at).or_insert_with(Matrix6::zeros) += block;
        }
    }

    fn damp(&mut self, share: f64) {
        for block in &mut self.diagonal {
            for number in 0..6 {
                block[(number, number)] *= 1.0 + share;
            }
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

    /// Returns the inverse blocks on the diagonal of the incomplete factor: what remains of each block once the lower numbers are
    /// eliminated, as if that joined no others.
    fn pivots(&self) -> Vec<Matrix6<f64>> {
        let inverse = |block: &Matrix6<f64>| block.cholesky().map(|factor| factor.inverse());
        let mut remaining = self.diagonal.clone();
        let mut pivots = Vec::with_capacity(remaining.len());
        let mut joined = self.joined.iter().peekable();
        for place in 0..remaining.len() {
            let pivot = inverse(&remaining[place]).or_else(|| inverse(&self.diagonal[place]));
            let pivot = pivot.unwrap_or_else(Matrix6::identity);
            while let Some(((_, b), block)) = joined.next_if(|((a, _), _)| *a == place) {
                remaining[*b] -= block.transpose() * pivot * block;
            }
            pivots.push(pivot);
        }
        pivots
    }

    /// Solves the system of the incomplete factor.
    fn precondition(&self, pivots: &[Matrix6<f64>], right: &[Vector6<f64>]) -> Vec<Vector6<f64>> {
        let mut solution = right.to_vec();
        for ((a, b), block) in &self.joined {
            let eliminated = pivots[*a] * solution[*a];
            solution[*b] -= block.transpose() * eliminated;
        }
        for (of, pivot) in solution.iter_mut().zip(pivots) {
            *of = pivot * *of;
        }
        for ((a, b), block) in self.joined.iter().rev() {
            let known = block * solution[*b];
            solution[*a] -= pivots[*a] * known;
        }
        solution
    }

    /// Solves the system by preconditioned conjugate gradients.
    fn solve(&self) -> Vec<Vector6<f64>> {
        let count = self.right.len();
        let pivots = self.pivots();
        let dot =
            |a: &[Vector6<f64>], b: &[Vector6<f64>]| -> f64 { a.iter().zip(b).map(|(a, b)| a.dot(b)).sum() };
        let mut solution = vec![Vector6::zeros(); count];
        let mut rest = self.right.clone();
        let mut towards = self.precondition(&pivots, &rest);
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
            towards = self.precondition(&pivots, &rest);
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
