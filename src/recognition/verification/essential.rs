//! The essential matrix: two views of points that nobody has triangulated yet (monocular, before scale).
//!
//! With directions alone a place is confirmed by the epipolar constraint x_c^T E x_q = 0 (H. C. Longuet-Higgins 1981;
//! eight points normalised as R. Hartley, PAMI 1997). It gives the rotation and the *direction* of the translation;
//! its length is unknown and reported as 1. What it cannot tell apart is refused: a camera that only turned, and points
//! on one plane, which leave a family of matrices that all fit.

mod eight_points;
#[cfg(test)]
mod tests;

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

use super::descriptor_matching::match_descriptors;
use super::limits::Limits;
use super::{Failure, Model, Status, Verification, View, side};
use crate::geometry::Sim3;
use crate::geometry::sampling::SplitMix64;
use eight_points::essential_of;

/// Points in a sample.
const SAMPLE: usize = 8;

/// The most samples: with half of the matches false, one sample of 256 is good.
const MAX_SAMPLES: u32 = 1_500;

/// The 95 % quantile of chi-square with one degree of freedom: a point lies on a line.
const MAX_CHI_SQUARE: f64 = 3.84;

/// Below this median angle, in radians (half a degree), between the rays of one point after the best rotation, the camera
/// has only turned, and the translation is noise.
const MIN_PARALLAX_RAD: f64 = 0.0087;

/// Rounds of fitting all inliers and taking them anew.
const REFITS: usize = 4;

/// The two rays of a match, `z = 1`, with the variances of their positions on that plane.
#[derive(Clone, Copy, Debug)]
struct Rays {
    query: Vector3<f64>,
    candidate: Vector3<f64>,
    variance_of_query: f64,
    variance_of_candidate: f64,
}

/// Verifies one candidate by directions alone. The same values give the same bits.
pub fn verify_essential(query: &View, candidate: &View, limits: &Limits, seed: u64) -> Verification {
    let mut result = Verification::started(Model::Essential);
    match find(query, candidate, limits, seed, &mut result) {
        Ok(()) => result.status = Status::Verified,
        Err(failure) => result.failure = Some(failure),
    }
    result
}

fn find(
    query: &View,
    candidate: &View,
    limits: &Limits,
    seed: u64,
    result: &mut Verification,
) -> Result<(), Failure> {
    let every = |view: &View| -> Vec<u32> { (0..view.keypoints.len() as u32).collect() };
    let (of_query, of_candidate) = (every(query), every(candidate));
    let matches =
        match_descriptors(&side(query, &of_query), &side(candidate, &of_candidate), &limits.matching);
    let rays: Vec<Rays> = (matches.iter())
        .map(|found| {
            let (query, variance_of_query) = ray(query, found.query, limits);
            let (candidate, variance_of_candidate) = ray(candidate, found.candidate, limits);
            Rays { query, candidate, variance_of_query, variance_of_candidate }
        })
        .collect();
    result.matches = rays.len() as u32;
    if result.matches < limits.min_matches.max(SAMPLE as u32) {
        return Err(Failure::TooFewMatches { matches: result.matches, limit: limits.min_matches });
    }
    let (mut inliers, degenerate) = sample(&rays, seed, result);
    if inliers.is_empty() {
        return Err(Failure::NoHypothesis { hypotheses: result.hypotheses, degenerate });
    }
    let mut essential = None;
    for _ in 0..REFITS {
        let Some(fitted) = essential_of(inliers.iter().map(|i| pair(&rays[*i]))) else { break };
        essential = Some(fitted);
        inliers = agreeing(&rays, &fitted);
    }
    let few = |inliers: usize| Failure::TooFewInliers { inliers: inliers as u32, limit: limits.min_inliers };
    let Some(essential) = essential else { return Err(few(0)) };
    let (candidate_from_query, in_front) = motion(&essential, &rays, &inliers);
    result.inliers = in_front.len() as u32;
    result.matched_inliers = inliers.len() as u32;
    result.projected_matches = result.matches;
    result.candidate_from_query = Some(candidate_from_query);
    if result.inliers < limits.min_inliers {
        return Err(few(in_front.len()));
    }
    let parallax_rad = parallax_beside_rotation(&rays, &in_front);
    if parallax_rad < MIN_PARALLAX_RAD {
        let millidegrees = |angle: f64| (angle.to_degrees() * 1e3).round() as u32;
        return Err(Failure::TooLittleParallax {
            millidegrees: millidegrees(parallax_rad),
            limit: millidegrees(MIN_PARALLAX_RAD),
        });
    }
    Ok(())
}

fn ray(view: &View, feature: u32, limits: &Limits) -> (Vector3<f64>, f64) {
    let (camera, keypoint) = (view.camera, view.keypoints[feature as usize]);
    let ray = Vector3::new((keypoint.u - camera.cx) / camera.fx, (keypoint.v - camera.cy) / camera.fy, 1.0);
    let sigma_px = limits.keypoint_sigma_px * limits.octave_factor.powi(i32::from(keypoint.octave));
    let variance = sigma_px * sigma_px / (camera.fx * camera.fy);
    (ray, variance)
}

fn pair(rays: &Rays) -> (Vector3<f64>, Vector3<f64>) {
    (rays.query, rays.candidate)
}

/// The inliers of the best sample; and how many samples were degenerate.
fn sample(rays: &[Rays], seed: u64, result: &mut Verification) -> (Vec<usize>, u32) {
    let mut random = SplitMix64::new(seed);
    let (mut best, mut degenerate, mut needed) = (Vec::new(), 0, MAX_SAMPLES);
    while result.hypotheses < needed {
        result.hypotheses += 1;
        let mut chosen = Vec::with_capacity(SAMPLE);
        while chosen.len() < SAMPLE {
            let next = random.below(rays.len());
            if !chosen.contains(&next) {
                chosen.push(next);
            }
        }
        let Some(essential) = essential_of(chosen.iter().map(|i| pair(&rays[*i]))) else {
            degenerate += 1;
            continue;
        };
        let inliers = agreeing(rays, &essential);
        if inliers.len() > best.len() {
            best = inliers;
            needed = needed.min(samples_needed(best.len() as f64 / rays.len() as f64));
        }
    }
    (best, degenerate)
}

/// So many samples that all were bad with a chance of 1 % at most, as ORB-SLAM asks of its samples of three.
fn samples_needed(inlier_share: f64) -> u32 {
    let good = inlier_share.powi(SAMPLE as i32);
    if good >= 1.0 {
        return 1;
    }
    // A share so small that the logarithm is 0 needs more than there are.
    let needed = 0.01_f64.ln() / (1.0 - good).ln();
    if needed.is_finite() { needed.ceil().min(f64::from(MAX_SAMPLES)) as u32 } else { MAX_SAMPLES }
}

fn agreeing(rays: &[Rays], essential: &Matrix3<f64>) -> Vec<usize> {
    (0..rays.len()).filter(|i| chi_square(&rays[*i], essential) < MAX_CHI_SQUARE).collect()
}

/// Sampson's distance in units of its variance.
fn chi_square(rays: &Rays, essential: &Matrix3<f64>) -> f64 {
    let (line, back) = (essential * rays.query, essential.transpose() * rays.candidate);
    let error = rays.candidate.dot(&line);
    let variance = rays.variance_of_candidate * (line.x * line.x + line.y * line.y)
        + rays.variance_of_query * (back.x * back.x + back.y * back.y);
    error * error / variance
}

/// The rotation and the unit translation that put most inliers in front of both cameras; and those inliers.
fn motion(essential: &Matrix3<f64>, rays: &[Rays], inliers: &[usize]) -> (Sim3, Vec<usize>) {
    let svd = essential.svd(true, true);
    let (u, v_t) = (svd.u.unwrap_or_default(), svd.v_t.unwrap_or_default());
    let w = Matrix3::new(0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0);
    let t = u.column(2).into_owned();
    let mut best: Option<(Matrix3<f64>, Vector3<f64>, Vec<usize>)> = None;
    for turned in [u * w * v_t, u * w.transpose() * v_t] {
        let rotation = if turned.determinant() < 0.0 { -turned } else { turned };
        for direction in [t, -t] {
            let front: Vec<usize> =
                inliers.iter().copied().filter(|i| is_in_front(&rays[*i], &rotation, &direction)).collect();
            if best.as_ref().is_none_or(|(.., known)| front.len() > known.len()) {
                best = Some((rotation, direction, front));
            }
        }
    }
    let (rotation, direction, front) = best.unwrap_or((Matrix3::identity(), t, Vec::new()));
    let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(rotation));
    (Sim3::from_parts(1.0, rotation, direction), front)
}

/// Does the point where the two rays come nearest lie in front of both cameras?
fn is_in_front(rays: &Rays, rotation: &Matrix3<f64>, direction: &Vector3<f64>) -> bool {
    // depth_c * candidate = depth_q * (R query) + t, in the sense of least squares.
    let (a, b) = (rotation * rays.query, rays.candidate);
    let (aa, ab, bb) = (a.dot(&a), a.dot(&b), b.dot(&b));
    let determinant = aa * bb - ab * ab;
    if determinant <= f64::EPSILON {
        return false;
    }
    let (at, bt) = (a.dot(direction), b.dot(direction));
    let depth_of_query = (ab * bt - bb * at) / determinant;
    let depth_of_candidate = (aa * bt - ab * at) / determinant;
    depth_of_query > 0.0 && depth_of_candidate > 0.0
}

/// The median angle that is left between the two rays of a point after the rotation that aligns them best, in radians.
fn parallax_beside_rotation(rays: &[Rays], inliers: &[usize]) -> f64 {
    let mut correlation = Matrix3::zeros();
    for i in inliers {
        correlation += rays[*i].candidate.normalize() * rays[*i].query.normalize().transpose();
    }
    let svd = correlation.svd(true, true);
    let (u, v_t) = (svd.u.unwrap_or_default(), svd.v_t.unwrap_or_default());
    let sign = (u * v_t).determinant().signum();
    let rotation = u * Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, sign)) * v_t;
    let mut angles: Vec<f64> =
        inliers.iter().map(|i| (rotation * rays[*i].query).angle(&rays[*i].candidate)).collect();
    angles.sort_by(f64::total_cmp);
    angles.get(angles.len() / 2).copied().unwrap_or(0.0)
}
