//! A rigid transformation between two frames.

use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};
use serde::{Deserialize, Serialize};

use super::point::Point3;

/// How far a quaternion's norm may be from 1 before it is taken for a mistake:
/// single-precision clients and rounded logs stay far below this.
const MAX_NORM_ERROR: f64 = 0.01;

/// Largest distance from 1 of the norm of a quaternion that was normalised: four squares, their sum and its root are rounded.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// A rigid transformation, read right to left: `map_from_camera * point_in_camera`
/// is the point in the map. Lengths in metres.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(into = "PoseParts", from = "PoseParts")]
pub struct Pose(Isometry3<f64>);

/// A translation `[x, y, z]` in metres, and a unit quaternion `[x, y, z, w]`.
type PoseParts = ([f64; 3], [f64; 4]);

impl From<Pose> for PoseParts {
    fn from(pose: Pose) -> Self {
        (pose.translation_m(), pose.rotation_xyzw())
    }
}

impl From<PoseParts> for Pose {
    fn from((translation_m, rotation_xyzw): PoseParts) -> Self {
        Self::from_stored(translation_m, rotation_xyzw)
    }
}

impl Pose {
    /// Returns the transformation that moves nothing.
    pub fn identity() -> Self {
        Self(Isometry3::identity())
    }

    /// From a translation `[x, y, z]` in metres and a quaternion `[x, y, z, w]`, which
    /// is normalised, or kept to the bit if it was already; `None` if its norm is more than 1 % off one (a zero
    /// quaternion, or four numbers that are no rotation).
    pub fn new(translation_m: [f64; 3], rotation_xyzw: [f64; 4]) -> Option<Self> {
        let [x, y, z, w] = rotation_xyzw;
        let quaternion = Quaternion::new(w, x, y, z);
        let norm = quaternion.norm();
        if !norm.is_finite() || (norm - 1.0).abs() > MAX_NORM_ERROR {
            return None;
        }
        if (norm - 1.0).abs() <= ROUNDING {
            return Some(Self::from_stored(translation_m, rotation_xyzw));
        }
        let [tx, ty, tz] = translation_m;
        Some(Self(Isometry3::from_parts(
            Translation3::new(tx, ty, tz),
            UnitQuaternion::from_quaternion(quaternion),
        )))
    }

    /// From parts read back from the store, where the quaternion was already normalised:
    /// taken as they are, so that a round trip through the store changes no bit.
    pub fn from_stored(translation_m: [f64; 3], rotation_xyzw: [f64; 4]) -> Self {
        let [x, y, z, w] = rotation_xyzw;
        let [tx, ty, tz] = translation_m;
        Self(Isometry3::from_parts(
            Translation3::new(tx, ty, tz),
            UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z)),
        ))
    }

    /// Returns the same as nalgebra's type, for who computes with it.
    pub fn isometry(&self) -> Isometry3<f64> {
        self.0
    }

    /// Returns the translation `[x, y, z]`, in metres.
    pub fn translation_m(&self) -> [f64; 3] {
        let t = &self.0.translation.vector;
        [t.x, t.y, t.z]
    }

    /// Returns the rotation as a unit quaternion `[x, y, z, w]`.
    pub fn rotation_xyzw(&self) -> [f64; 4] {
        let q = self.0.rotation.quaternion();
        [q.i, q.j, q.k, q.w]
    }

    /// Returns the camera's centre in the map, for a `map_from_camera`.
    pub fn centre(&self) -> Point3 {
        Point3::from(self.0.translation.vector)
    }

    /// Returns the inverse: `camera_from_map` of a `map_from_camera`.
    pub fn inverse(&self) -> Self {
        Self(self.0.inverse())
    }

    /// Returns the composition: `a_from_b.after(b_from_c)` is `a_from_c`.
    pub fn after(&self, inner: &Self) -> Self {
        Self(self.0 * inner.0)
    }

    /// Returns a point of the inner frame in the outer one.
    pub fn transform(&self, point: &Point3) -> Point3 {
        self.0 * point
    }

    /// Returns a point of the outer frame in the inner one.
    pub fn inverse_transform(&self, point: &Point3) -> Point3 {
        self.0.inverse_transform_point(point)
    }
}

impl From<Isometry3<f64>> for Pose {
    fn from(isometry: Isometry3<f64>) -> Self {
        Self(isometry)
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Returns a unit quaternion `[x, y, z, w]`.
    pub(in crate::geometry) fn any_rotation_xyzw() -> impl Strategy<Value = [f64; 4]> {
        prop::array::uniform4(-1.0..1.0f64).prop_filter_map("a quaternion near zero has no direction", |q| {
            let norm = q.iter().map(|x| x * x).sum::<f64>().sqrt();
            (norm > 0.1).then(|| q.map(|x| x / norm))
        })
    }

    fn any_pose() -> impl Strategy<Value = Pose> {
        (prop::array::uniform3(-100.0..100.0f64), any_rotation_xyzw())
            .prop_map(|(t, q)| Pose::new(t, q).expect("a unit quaternion"))
    }

    pub(in crate::geometry) fn any_point() -> impl Strategy<Value = Point3> {
        prop::array::uniform3(-50.0..50.0f64).prop_map(Point3::from)
    }

    proptest! {
        #[test]
        fn the_inverse_undoes(pose in any_pose(), point in any_point()) {
            let back = pose.inverse().transform(&pose.transform(&point));
            prop_assert!((back - point).norm() < 1e-9);
            prop_assert!((pose.inverse_transform(&point) - pose.inverse().transform(&point)).norm() < 1e-9);
        }

        #[test]
        fn composition_is_one_after_the_other(a in any_pose(), b in any_pose(), point in any_point()) {
            let both = a.after(&b).transform(&point);
            prop_assert!((both - a.transform(&b.transform(&point))).norm() < 1e-9);
        }

        #[test]
        fn storing_changes_no_bit(pose in any_pose()) {
            prop_assert_eq!(Pose::from_stored(pose.translation_m(), pose.rotation_xyzw()), pose);
        }
    }

    #[test]
    fn a_quaternion_that_is_no_rotation_is_refused() {
        assert!(Pose::new([0.0; 3], [0.0; 4]).is_none());
        assert!(Pose::new([0.0; 3], [0.0, 0.0, 0.0, 2.0]).is_none());
        assert!(Pose::new([0.0; 3], [0.0, 0.0, 0.0, 0.999]).is_some());
    }

    #[test]
    fn the_identity_leaves_positions_as_they_are_to_the_bit() {
        let point = Point3::new(0.1, 0.2, 0.3);
        assert_eq!(Pose::identity().transform(&point), point);
        assert_eq!(Pose::identity().inverse_transform(&point), point);
    }
}
