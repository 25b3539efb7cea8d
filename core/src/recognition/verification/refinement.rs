//! The transformation that makes the reprojection errors in both images least: Levenberg-Marquardt with Huber's weights.

use nalgebra::{Matrix2x3, Matrix3, Quaternion, SMatrix, SVector, UnitQuaternion, Vector3};

use super::correspondence::{Cameras, Correspondence, Reprojection};
use crate::geometry::Sim3;
use crate::geometry::pinhole::Pinhole;

/// Errors beyond this many standard deviations weigh less (P. J. Huber: 95 % efficiency on normal errors).
const HUBER_SIGMAS: f64 = 1.345;
/// Steps at most; it converges in three to six.
const MAX_STEPS: u32 = 15;
/// A step that changes the cost by less than this share of it is the last.
const MIN_GAIN: f64 = 1e-6;
/// The damping at the start, as a share of the diagonal.
const FIRST_DAMPING: f64 = 1e-4;
/// The damping at which there is no better place nearby.
const MAX_DAMPING: f64 = 1e6;

/// Rotation, translation, logarithm of the scale.
pub(super) type Step = SVector<f64, 7>;
pub(super) type Information = SMatrix<f64, 7, 7>;

/// Refines `candidate_from_query` on the pairs at `places`. With a fixed scale, the scale stays as it is.
pub fn refine(
    candidate_from_query: &Sim3,
    pairs: &[Correspondence],
    places: &[u32],
    cameras: &Cameras,
    fixed_scale: bool,
) -> Sim3 {
    let problem = Problem { pairs, places, cameras };
    let mut best = *candidate_from_query;
    let mut cost = problem.cost(&best);
    let mut damping = FIRST_DAMPING;
    let mut normal = problem.linearise(&best, fixed_scale);
    for _ in 0..MAX_STEPS {
        if !cost.is_finite() || damping > MAX_DAMPING {
            break;
        }
        let Some(next) = normal.solve(damping).map(|step| moved(&best, &step)) else {
            damping *= 10.0;
            continue;
        };
        let next_cost = problem.cost(&next);
        let gain = (cost - next_cost) / cost;
        if gain > 0.0 {
            (best, cost, damping) = (next, next_cost, damping / 10.0);
        }
        if gain.abs() < MIN_GAIN || gain.is_nan() {
            break;
        }
        if gain < 0.0 {
            damping *= 10.0;
            continue;
        }
        normal = problem.linearise(&best, fixed_scale);
    }
    best
}

/// Returns what the pairs at `places` cost under a transformation: Huber's sum over the squared errors of both images
/// and depths.
pub fn cost(candidate_from_query: &Sim3, pairs: &[Correspondence], places: &[u32], cameras: &Cameras) -> f64 {
    Problem { pairs, places, cameras }.cost(candidate_from_query)
}

/// Returns the normal matrix and the gradient of one pair: of a rotation, a translation and a logarithm of the scale in the
/// candidate's frame.
pub(super) fn linearised(
    candidate_from_query: &Sim3,
    pair: &Correspondence,
    cameras: &Cameras,
) -> (Information, Step) {
    let problem = Problem { pairs: std::slice::from_ref(pair), places: &[0], cameras };
    let NormalEquations { mut information, gradient, .. } = problem.linearise(candidate_from_query, false);
    // Only the lower triangle was summed.
    information.fill_upper_triangle_with_lower_triangle();
    (information, gradient)
}

/// Returns the transformation moved by a small step in the candidate's frame.
fn moved(sim3: &Sim3, step: &Step) -> Sim3 {
    // Cayley's map: to first order the exponential, and it needs no sine.
    let half = step.fixed_rows::<3>(0) * 0.5;
    let turn = UnitQuaternion::from_quaternion(Quaternion::new(1.0, half.x, half.y, half.z));
    let growth = (1.0 + 0.5 * step[6]) / (1.0 - 0.5 * step[6]);
    let growth = if growth.is_finite() && growth > 0.0 { growth } else { 1.0 };
    Sim3::from_parts(growth, turn, step.fixed_rows::<3>(3).into_owned()).after(sim3)
}

struct Problem<'a> {
    pairs: &'a [Correspondence],
    places: &'a [u32],
    cameras: &'a Cameras,
}

/// The normal equations of a linearised problem.
struct NormalEquations {
    information: Information,
    gradient: Step,
    fixed_scale: bool,
}

impl Problem<'_> {
    fn chosen(&self) -> impl Iterator<Item = &Correspondence> {
        self.places.iter().map(|&place| &self.pairs[place as usize])
    }

    /// Huber's cost; infinite if a point falls behind a camera.
    fn cost(&self, sim3: &Sim3) -> f64 {
        let (to_candidate, to_query) =
            (sim3.linear_and_translation(), sim3.inverse().linear_and_translation());
        let side =
            |it: &Reprojection, (linear, translation): &(Matrix3<f64>, Vector3<f64>), camera: &Pinhole| {
                let point = linear * it.point + translation;
                let Some([u, v]) = it.residual_px(&point, camera) else { return f64::INFINITY };
                let in_depth = it.depth.map_or(0.0, |depth| (point.z - depth.metres) * depth.inverse_sigma);
                huber_cost((u * u + v * v) * it.inverse_variance) + huber_cost(in_depth * in_depth)
            };
        self.chosen()
            .map(|pair| {
                pair.into_candidate.map_or(0.0, |it| side(&it, &to_candidate, &self.cameras.candidate))
                    + pair.into_query.map_or(0.0, |it| side(&it, &to_query, &self.cameras.query))
            })
            .sum()
    }

    fn linearise(&self, sim3: &Sim3, fixed_scale: bool) -> NormalEquations {
        let (linear, translation) = sim3.linear_and_translation();
        let (inverse_linear, inverse_translation) = sim3.inverse().linear_and_translation();
        let mut sum =
            NormalEquations { information: Information::zeros(), gradient: Step::zeros(), fixed_scale };
        for pair in self.chosen() {
            if let Some(it) = pair.into_candidate {
                let moved = linear * it.point + translation;
                sum.add(&it, &moved, &moved, &Matrix3::identity(), &self.cameras.candidate);
            }
            if let Some(it) = pair.into_query {
                // Moving the candidate's frame by a step moves its points by the inverse step.
                let moved = inverse_linear * it.point + inverse_translation;
                sum.add(&it, &moved, &it.point, &-inverse_linear, &self.cameras.query);
            }
        }
        sum
    }
}

impl NormalEquations {
    /// Adds one image of one point: a step `(w, t, s)` moves it by `outer * (w x inner + t + s inner)`.
    fn add(
        &mut self,
        it: &Reprojection,
        in_camera: &Vector3<f64>,
        inner: &Vector3<f64>,
        outer: &Matrix3<f64>,
        camera: &Pinhole,
    ) {
        let Some([u, v]) = it.residual_px(in_camera, camera) else { return };
        let weight = it.inverse_variance * huber_weight((u * u + v * v) * it.inverse_variance);
        let inverse_depth = in_camera.z.recip();
        let (x, y) = (in_camera.x * inverse_depth, in_camera.y * inverse_depth);
        let of_point =
            Matrix2x3::new(camera.fx, 0.0, -camera.fx * x, 0.0, camera.fy, -camera.fy * y) * inverse_depth;
        let by_move = of_point * outer;
        self.add_residual(&by_move.row(0).transpose(), inner, u, weight);
        self.add_residual(&by_move.row(1).transpose(), inner, v, weight);
        if let Some(depth) = it.depth {
            let residual = in_camera.z - depth.metres;
            let inverse_variance = depth.inverse_sigma * depth.inverse_sigma;
            let weight = inverse_variance * huber_weight(residual * residual * inverse_variance);
            self.add_residual(&outer.row(2).transpose(), inner, residual, weight);
        }
    }

    fn add_residual(&mut self, by_move: &Vector3<f64>, inner: &Vector3<f64>, residual: f64, weight: f64) {
        let turn = inner.cross(by_move);
        let jacobian =
            Step::from([turn.x, turn.y, turn.z, by_move.x, by_move.y, by_move.z, by_move.dot(inner)]);
        let weighted = jacobian * weight;
        for column in 0..7 {
            for line in column..7 {
                self.information[(line, column)] += weighted[line] * jacobian[column];
            }
        }
        self.gradient += weighted * residual;
    }

    /// Returns the damped step; `None` if the equations do not determine one.
    fn solve(&self, damping: f64) -> Option<Step> {
        let mut information = self.information;
        let mut gradient = self.gradient;
        for i in 0..7 {
            information[(i, i)] *= 1.0 + damping;
        }
        if self.fixed_scale {
            for i in 0..6 {
                information[(6, i)] = 0.0;
            }
            information[(6, 6)] = 1.0;
            gradient[6] = 0.0;
        }
        // Cholesky reads the lower triangle only.
        Some(-information.cholesky()?.solve(&gradient))
    }
}

fn huber_weight(chi_square: f64) -> f64 {
    if chi_square <= HUBER_SIGMAS * HUBER_SIGMAS { 1.0 } else { HUBER_SIGMAS / chi_square.sqrt() }
}

fn huber_cost(chi_square: f64) -> f64 {
    if chi_square <= HUBER_SIGMAS * HUBER_SIGMAS {
        chi_square
    } else {
        HUBER_SIGMAS * (2.0 * chi_square.sqrt() - HUBER_SIGMAS)
    }
}
