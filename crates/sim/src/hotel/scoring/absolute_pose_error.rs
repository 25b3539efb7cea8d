//! Absolute pose error: position error after aligning the trajectory with the truth, as evo computes it.
//!
//! `evo_ape tum truth.tum estimate.tum -a` aligns with a rotation and a translation (S. Umeyama, PAMI 13, 1991), with
//! `-s` also by a scale. It prints, among others, the root mean square distance. evo 1.x gives the same digits for the
//! trajectories that `revisit eval hotel` writes.

use crate::geometry::absolute_orientation::{Scale, align};
use crate::geometry::{Point3, Pose, Sim3};

/// Returns the positions of poses.
pub fn centres(poses: &[Pose]) -> Vec<Point3> {
    poses.iter().map(Pose::centre).collect()
}

/// Returns the transformation `truth_from_estimate` that aligns the estimate with the truth; none if the points leave
/// it undetermined.
pub fn alignment(estimated: &[Point3], truth: &[Point3], scale: Scale) -> Option<Sim3> {
    let pairs: Vec<(Point3, Point3)> = estimated.iter().copied().zip(truth.iter().copied()).collect();
    align(&pairs, scale).ok()
}

/// Computes the RMSE of the positions after alignment, in metres.
pub fn rmse_after_alignment(estimated: &[Point3], truth: &[Point3], scale: Scale) -> Option<f64> {
    let truth_from_estimate = alignment(estimated, truth, scale)?;
    let squared =
        estimated.iter().zip(truth).map(|(e, t)| (truth_from_estimate.transform(e) - t).norm_squared());
    Some((squared.sum::<f64>() / estimated.len() as f64).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_moved_and_turned_trajectory_is_right_and_a_longer_one_only_if_the_scale_is_free() {
        let truth: Vec<Point3> =
            [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [4.0, 3.0, 0.0], [0.0, 3.0, 0.0]].map(Point3::from).to_vec();
        let turned: Vec<Point3> =
            truth.iter().map(|p| Point3::new(7.0 - p.y, p.x - 2.0, p.z + 1.0)).collect();
        assert!(rmse_after_alignment(&turned, &truth, Scale::Fixed).expect("points") < 1e-9);
        // Twice as long: every corner is 2.5 m from its middle and ends up 2.5 m off.
        let longer: Vec<Point3> = truth.iter().map(|p| p * 2.0).collect();
        let off_m = rmse_after_alignment(&longer, &truth, Scale::Fixed).expect("points");
        assert!((off_m - 2.5).abs() < 1e-9, "{off_m}");
        assert!(
            rmse_after_alignment(&longer, &truth, Scale::Free).expect("points") < 1e-9,
            "in another unit"
        );
    }
}
