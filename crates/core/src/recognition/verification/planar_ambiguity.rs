//! A flat patch seen from afar can be tilted two ways: two transformations explain its images nearly alike, and depths tell.
//!
//! G. Schweighofer and A. Pinz, "Robust pose estimation from a planar target", PAMI 28 (2006). Search and refinement end in
//! whichever of the two they come across first, which may put the camera metres away from where it was. Here the other one
//! is made by mirroring the patch's tilt about the line of sight, refined, and held against the first.

use nalgebra::{Matrix3, Unit, UnitQuaternion, Vector3};

use super::correspondence::{Cameras, Correspondence};
use super::refinement::{cost, refine};
use crate::geometry::Sim3;

/// A patch is flat if its thickness is below this share of its narrower side.
pub(in crate::recognition) const MAX_THICKNESS_SHARE: f64 = 0.35;
/// Tilts below this, in radians, are hardly two.
pub(in crate::recognition) const MIN_TILT_RAD: f64 = 0.05;

/// Returns the transformation that sees the same points tilted the other way, refined on them, if it explains them
/// better.
pub fn better_tilted(
    candidate_from_query: &Sim3,
    pairs: &[Correspondence],
    inliers: &[u32],
    cameras: &Cameras,
    fixed_scale: bool,
) -> Option<Sim3> {
    let mirrored = mirrored(candidate_from_query, pairs, inliers)?;
    let refined = refine(&mirrored, pairs, inliers, cameras, fixed_scale);
    let costs = [&refined, candidate_from_query].map(|sim3| cost(sim3, pairs, inliers, cameras));
    (costs[0] < costs[1]).then_some(refined)
}

/// Turns the patch about the axis square to the line of sight and its normal, to the mirrored tilt; its middle stays.
fn mirrored(candidate_from_query: &Sim3, pairs: &[Correspondence], inliers: &[u32]) -> Option<Sim3> {
    let points: Vec<Vector3<f64>> =
        inliers.iter().filter_map(|&place| Some(pairs[place as usize].into_candidate?.point)).collect();
    if points.len() < 3 {
        return None;
    }
    let middle = points.iter().sum::<Vector3<f64>>() / points.len() as f64;
    let spread: Matrix3<f64> =
        points.iter().map(|point| (point - middle) * (point - middle).transpose()).sum();
    let axes = spread.symmetric_eigen();
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| axes.eigenvalues[a].total_cmp(&axes.eigenvalues[b]));
    let [thickness, narrower] = [order[0], order[1]].map(|axis| axes.eigenvalues[axis].max(0.0).sqrt());
    if narrower <= 0.0 || thickness > MAX_THICKNESS_SHARE * narrower {
        return None;
    }
    let (linear, translation) = candidate_from_query.linear_and_translation();
    let middle_in_candidate = linear * middle + translation;
    let sight = middle_in_candidate.try_normalize(1e-9)?;
    let normal = candidate_from_query.rotation() * axes.eigenvectors.column(order[0]).into_owned();
    let normal = if normal.dot(&sight) > 0.0 { normal } else { -normal };
    let tilt_rad = libm::acos(normal.dot(&sight).min(1.0));
    if tilt_rad < MIN_TILT_RAD {
        return None;
    }
    let axis = Unit::try_new(normal.cross(&sight), 1e-9)?;
    let turn = UnitQuaternion::from_axis_angle(&axis, 2.0 * tilt_rad);
    let about_middle = Sim3::from_parts(1.0, turn, middle_in_candidate - turn * middle_in_candidate);
    Some(about_middle.after(candidate_from_query))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::pinhole::Pinhole;
    use crate::recognition::verification::correspondence::Reprojection;
    use crate::recognition::verification::limits::Limits;

    /// Returns a plate of 0.4 m, 4 m away, seen from two sides; its depths are known within a per cent.
    fn plate() -> (Sim3, Vec<Correspondence>, Cameras) {
        let camera = Pinhole { fx: 525.0, fy: 525.0, cx: 320.0, cy: 240.0 };
        let turn = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), 0.8);
        let middle = Vector3::new(0.1, -0.2, 4.0);
        let truth = Sim3::from_parts(1.0, turn, middle - turn * middle + Vector3::new(0.05, 0.0, 0.1));
        let tilted = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), -0.4);
        let pairs = (0..36).map(|i| {
            let (u, v) = (f64::from(i % 6) - 2.5, f64::from(i / 6) - 2.5);
            let in_query = middle + tilted * (Vector3::new(u, v, 0.0) * 0.08);
            let in_candidate = Vector3::from(truth.transform(&in_query.into()).coords);
            let limits = Limits::DEFAULT;
            let into = |point: Vector3<f64>, seen: &Vector3<f64>| Reprojection {
                point,
                pixel: camera.project(seen).expect("in front"),
                inverse_variance: limits.variance_px2(0).recip(),
                depth: limits.depth(seen.z),
            };
            Correspondence {
                into_query: Some(into(in_candidate, &in_query)),
                into_candidate: Some(into(in_query, &in_candidate)),
                distance: 10,
                query_feature: i as u32,
                candidate_feature: Some(i as u32),
            }
        });
        (truth, pairs.collect(), Cameras { query: camera, candidate: camera })
    }

    #[test]
    fn the_wrong_tilt_is_turned_into_the_right_one_and_the_right_one_stays() {
        let (truth, pairs, cameras) = plate();
        let inliers: Vec<u32> = (0..pairs.len() as u32).collect();
        let wrong = mirrored(&truth, &pairs, &inliers).expect("a flat patch");
        let wrong = refine(&wrong, &pairs, &inliers, &cameras, true);
        let apart_m = |a: &Sim3| (a.inverse().after(&truth)).linear_and_translation().1.norm();
        if apart_m(&wrong) > 0.5 {
            let right =
                better_tilted(&wrong, &pairs, &inliers, &cameras, true).expect("the other tilt is better");
            assert!(apart_m(&right) < 0.05, "{}", apart_m(&right));
        }
        assert!(better_tilted(&truth, &pairs, &inliers, &cameras, true).is_none());
    }
}
