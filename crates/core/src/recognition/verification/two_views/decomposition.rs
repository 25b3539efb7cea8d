//! The motion behind a homography, where only one is possible.
//!
//! `H = R + t N^T / d` for a plane with the unit normal N at the distance d from the query's camera. In closed form it leaves two
//! motions that see the plane from the front (Y. Ma, S. Soatto, J. Košecká, S. S. Sastry, *An Invitation to 3-D Vision*, 2004,
//! theorem 5.19). All points must lie before the camera: where that excludes one of the two, the other is reported, with a
//! translation of length 1, since d is not known. Where it excludes none, or the camera hardly moved, there is no transform.

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

use crate::geometry::Sim3;

/// The largest singular value must exceed the smallest by this factor: else the camera has turned, as far as can be told,
/// and every normal fits. A move by a fiftieth of the plane's distance makes it 1.02.
pub(in crate::recognition) const MIN_STRETCH: f64 = 1.02;

/// Returns `candidate_from_query` of a homography between ray planes, if the rays that it explains leave one motion.
pub fn motion_of(candidate_from_query: &Matrix3<f64>, query_rays: &[Vector3<f64>]) -> Option<Sim3> {
    let eigen = (candidate_from_query.transpose() * candidate_from_query).symmetric_eigen();
    let mut order = [0, 1, 2];
    order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
    let middle = eigen.eigenvalues[order[1]];
    let [large, _, small] = order.map(|rank| eigen.eigenvalues[rank] / middle);
    if !(small > 0.0 && large > MIN_STRETCH * MIN_STRETCH * small) {
        return None;
    }
    // The map scaled so that its middle singular value is 1; its determinant stays positive.
    let map = candidate_from_query / middle.sqrt();
    let [first, second, third] = order.map(|rank| eigen.eigenvectors.column(rank).into_owned());
    let (along, across) = ((1.0 - small).max(0.0).sqrt(), (large - 1.0).max(0.0).sqrt());
    let length = (large - small).sqrt();
    let motions = [across, -across].map(|across| {
        let kept = (first * along + third * across) / length;
        motion(&map, &second, &kept, query_rays)
    });
    match motions {
        [Some(only), None] | [None, Some(only)] => Some(only),
        _ => None,
    }
}

/// Returns the motion that keeps the lengths of two directions of the plane, if it sees all rays' points from the front.
fn motion(
    map: &Matrix3<f64>,
    second: &Vector3<f64>,
    kept: &Vector3<f64>,
    query_rays: &[Vector3<f64>],
) -> Option<Sim3> {
    let normal = second.cross(kept);
    let (to_second, to_kept) = (map * second, map * kept);
    let before = Matrix3::from_columns(&[*second, *kept, normal]);
    let after = Matrix3::from_columns(&[to_second, to_kept, to_second.cross(&to_kept)]);
    let rotation = after * before.transpose();
    // Towards the points: the plane lies at a positive distance along its normal.
    let facing: f64 = query_rays.iter().map(|ray| normal.dot(ray).signum()).sum();
    let normal = if facing < 0.0 { -normal } else { normal };
    if !query_rays.iter().all(|ray| normal.dot(ray) > 0.0) {
        return None;
    }
    let direction = ((map - rotation) * normal).try_normalize(1e-9)?;
    let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(rotation));
    Some(Sim3::from_parts(1.0, rotation, direction))
}
