//! Odometry: the robot's own motion estimate, which drifts.
//!
//! Between two keyframes the estimate has small errors of heading and length, which add up to a drift like that of
//! ORB-SLAM3 without loops. The absolute pose error printed for the sequence (Table III, ORB-VO) determines the drift.
//! The same errors are scaled until the aligned trajectory has exactly that error.

use crate::geometry::Pose;
use crate::geometry::absolute_orientation::Scale;
use crate::hotel::rng::SeededRng;
use crate::hotel::scoring::absolute_pose_error::{centres, rmse_after_alignment};

/// Heading errors before scaling: noise per square root of a metre, noise per square root of a radian, and a slowly
/// changing bias per metre.
const HEADING_PER_METRE: f64 = 0.004;
const HEADING_PER_RADIAN: f64 = 0.006;
const HEADING_BIAS_PER_METRE: f64 = 0.0006;
/// Errors of length before scaling: noise per square root of a metre, and a constant share.
const LENGTH_PER_METRE: f64 = 0.006;
const LENGTH_SHARE: f64 = 0.004;
/// Tilt and height per square root of a metre or radian: small, because gravity is observable.
const TILT_PER_STEP: f64 = 0.0006;
const HEIGHT_PER_METRE: f64 = 0.002;
/// Standard deviation of the logarithm of the unit of a robot without depth, per square root of a metre.
const DRIFT_PER_METRE: f64 = 0.01;
/// The same per square root of a radian.
const DRIFT_PER_RADIAN: f64 = 0.015;
/// Number of bisection steps for the scale.
const HALVINGS: u32 = 40;

/// The errors of one step before scaling.
#[derive(Clone, Copy, Debug)]
struct StepError {
    heading_rad: f64,
    tilt_rad: [f64; 2],
    ahead_m: f64,
    aside_m: f64,
    up_m: f64,
}

/// Returns the relative motions that odometry reports, `previous_from_next` for each keyframe but the first. The whole
/// trajectory then has the error `drift_m`: RMSE after alignment, as evo computes it.
pub fn drifting_motions(truth: &[Pose], drift_m: f64, rng: &mut SeededRng) -> Vec<Pose> {
    let motions: Vec<Pose> = motions(truth).collect();
    let errors = errors(&motions, rng);
    let truth = centres(truth);
    let off_m = |scale: f64| {
        let estimate = centres(&integrate(&erring(&motions, &errors, scale)));
        rmse_after_alignment(&estimate, &truth, Scale::Fixed).unwrap_or(0.0)
    };
    let (mut low, mut high) = (0.0, 1.0);
    while off_m(high) < drift_m && high < 1e3 {
        high *= 2.0;
    }
    for _ in 0..HALVINGS {
        let middle = f64::midpoint(low, high);
        if off_m(middle) < drift_m { low = middle } else { high = middle }
    }
    erring(&motions, &errors, f64::midpoint(low, high))
}

/// Integrates motions from the identity.
pub fn integrate(motions: &[Pose]) -> Vec<Pose> {
    let mut poses = vec![Pose::identity()];
    for motion in motions {
        poses.push(poses[poses.len() - 1].after(motion));
    }
    poses
}

/// Draws the units per metre of a robot without depth at each keyframe, relative to the first, as natural logarithms.
/// They are a random walk with the distance driven, stronger in turns. Its strength is our choice.
pub fn scale_drift(truth: &[Pose], rng: &mut SeededRng) -> Vec<f64> {
    let mut drift = vec![0.0];
    for motion in motions(truth) {
        let (length_m, turn_rad) = (motion.centre().coords.norm(), motion.isometry().rotation.angle());
        let now = drift[drift.len() - 1]
            + rng.normal(DRIFT_PER_METRE * length_m.sqrt())
            + rng.normal(DRIFT_PER_RADIAN * turn_rad.sqrt());
        drift.push(now);
    }
    drift
}

/// Returns the motion from each keyframe to the next, `previous_from_next`.
fn motions(poses: &[Pose]) -> impl Iterator<Item = Pose> {
    poses.windows(2).map(|pair| pair[0].inverse().after(&pair[1]))
}

fn errors(motions: &[Pose], rng: &mut SeededRng) -> Vec<StepError> {
    let always_longer = rng.normal(LENGTH_SHARE);
    let mut bias = rng.normal(HEADING_BIAS_PER_METRE);
    (motions.iter())
        .map(|motion| {
            let length_m = motion.centre().coords.norm();
            let [_, _, _, w] = motion.rotation_xyzw();
            let turn_rad = 2.0 * w.abs().min(1.0).acos();
            bias += rng.normal(HEADING_BIAS_PER_METRE * 0.2);
            let heading_sigma = HEADING_PER_METRE * length_m.sqrt() + HEADING_PER_RADIAN * turn_rad.sqrt();
            StepError {
                heading_rad: rng.normal(heading_sigma) + bias * length_m,
                tilt_rad: [rng.normal(TILT_PER_STEP), rng.normal(TILT_PER_STEP)],
                ahead_m: rng.normal(LENGTH_PER_METRE * length_m.sqrt()) + always_longer * length_m,
                aside_m: rng.normal(LENGTH_PER_METRE * length_m.sqrt() * 0.5),
                up_m: rng.normal(HEIGHT_PER_METRE * length_m.sqrt()),
            }
        })
        .collect()
}

/// Returns the motions with scaled errors.
fn erring(motions: &[Pose], errors: &[StepError], scale: f64) -> Vec<Pose> {
    (motions.iter().zip(errors))
        .map(|(motion, error)| {
            // In the optical frame y is down, so a left turn is a negative turn about it; z is ahead.
            let half = |rad: f64| rad * scale / 2.0;
            let rotation = [half(error.tilt_rad[0]), half(-error.heading_rad), half(error.tilt_rad[1]), 1.0];
            let norm = rotation.iter().map(|x| x * x).sum::<f64>().sqrt();
            let translation = [error.aside_m * scale, -error.up_m * scale, error.ahead_m * scale];
            motion.after(&Pose::from_stored(translation, rotation.map(|x| x / norm)))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::camera::Stand;
    use super::*;

    #[test]
    fn the_drift_is_what_was_asked_for() {
        let truth: Vec<Pose> = (0..300)
            .map(|i| {
                let angle = f64::from(i) * 0.02;
                let at = [16.0 * angle.cos(), 16.0 * angle.sin()];
                Stand { at, heading_rad: angle + std::f64::consts::FRAC_PI_2 }.map_from_camera()
            })
            .collect();
        for drift_m in [0.22, 0.96] {
            let motions = drifting_motions(&truth, drift_m, &mut SeededRng::new(1, "odometry"));
            let estimate = centres(&integrate(&motions));
            let off_m =
                rmse_after_alignment(&estimate, &centres(&truth), Scale::Fixed).expect("enough points");
            assert!((off_m - drift_m).abs() < 1e-6, "{off_m} instead of {drift_m}");
        }
    }
}
