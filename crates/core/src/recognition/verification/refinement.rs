//! The transformation that makes the reprojection errors in both images least: Levenberg-Marquardt with Huber's weights.

use nalgebra::{Quaternion, UnitQuaternion};

use super::correspondence::{Cameras, Correspondence, Hypothesis, Map, Reprojection};
use super::huber::huber_cost;
use super::normal_equations::{About, Linearise, Step};
use crate::geometry::Sim3;
use crate::geometry::instruction_set::{Kernel, dispatch};
use crate::geometry::pinhole::Pinhole;

/// Steps at most; it converges in three to six.
const MAX_STEPS: u32 = 15;
/// A step that changes the cost by less than this share of it is the last.
const MIN_GAIN: f64 = 1e-6;
/// The damping at the start, as a share of the diagonal.
const FIRST_DAMPING: f64 = 1e-4;
/// The damping at which there is no better place nearby.
const MAX_DAMPING: f64 = 1e6;

/// Refines `candidate_from_query` on the pairs at `places`. With a fixed scale, the scale stays as it is.
pub fn refine(
    candidate_from_query: &Sim3,
    pairs: &[Correspondence],
    places: &[u32],
    cameras: &Cameras,
    fixed_scale: bool,
) -> Sim3 {
    let cost_of = |sim3: &Sim3| cost(sim3, pairs, places, cameras);
    let linearise = |sim3: &Sim3| dispatch(Linearise { about: About::new(sim3, cameras), pairs, places });
    let mut best = *candidate_from_query;
    let mut cost = cost_of(&best);
    let mut damping = FIRST_DAMPING;
    let mut normal = linearise(&best);
    for _ in 0..MAX_STEPS {
        if !cost.is_finite() || damping > MAX_DAMPING {
            break;
        }
        let Some(next) = normal.solve(damping, fixed_scale).map(|step| moved(&best, &step)) else {
            damping *= 10.0;
            continue;
        };
        let next_cost = cost_of(&next);
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
        normal = linearise(&best);
    }
    best
}

/// Returns what the pairs at `places` cost under a transformation: Huber's sum over the squared errors of both images
/// and depths; infinite if a point falls behind a camera.
pub fn cost(candidate_from_query: &Sim3, pairs: &[Correspondence], places: &[u32], cameras: &Cameras) -> f64 {
    dispatch(Cost { tested: Hypothesis::new(cameras, candidate_from_query), pairs, places })
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

/// The cost of some pairs under a transformation.
struct Cost<'a> {
    tested: Hypothesis,
    pairs: &'a [Correspondence],
    places: &'a [u32],
}

impl Kernel for Cost<'_> {
    type Output = f64;

    #[inline(always)]
    fn run<const POPCNT: bool>(self) -> f64 {
        let mut sum = 0.0;
        let Hypothesis { cameras, candidate_from_query, query_from_candidate } = &self.tested;
        for &place in self.places {
            let pair = &self.pairs[place as usize];
            let mut of_pair = 0.0;
            if let Some(it) = &pair.into_candidate {
                of_pair += cost_of_image(it, candidate_from_query, &cameras.candidate);
            }
            if let Some(it) = &pair.into_query {
                of_pair += cost_of_image(it, query_from_candidate, &cameras.query);
            }
            sum += of_pair;
        }
        sum
    }
}

#[inline(always)]
fn cost_of_image(it: &Reprojection, map: &Map, camera: &Pinhole) -> f64 {
    let [in_image, in_depth] = it.chi_squares(map, camera);
    huber_cost(in_image) + huber_cost(in_depth)
}
