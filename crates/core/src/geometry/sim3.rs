//! A similarity transformation between two frames: rotation, translation and one scale.

use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

use super::point::Point3;
use super::pose::Pose;

/// How far a quaternion's norm may be from 1 before it is taken for a mistake, as for [`Pose`].
const MAX_NORM_ERROR: f64 = 0.01;

/// A similarity, read right to left: `candidate_from_query * point_in_query` is
/// `scale * rotation * point_in_query + translation`, the point in the candidate's frame.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(into = "(f64, Pose)", from = "(f64, Pose)")]
pub struct Sim3 {
    scale: f64,
    rotation: UnitQuaternion<f64>,
    translation: Vector3<f64>,
}

impl Sim3 {
    /// Returns the transformation that moves nothing.
    pub fn identity() -> Self {
        Self { scale: 1.0, rotation: UnitQuaternion::identity(), translation: Vector3::zeros() }
    }

    /// From a scale, a translation `[x, y, z]` in metres of the outer frame and a quaternion `[x, y, z, w]`,
    /// which is normalised; `None` if the scale is not positive and finite, or the quaternion's norm is more
    /// than 1 % off one.
    pub fn new(scale: f64, translation_m: [f64; 3], rotation_xyzw: [f64; 4]) -> Option<Self> {
        let [x, y, z, w] = rotation_xyzw;
        let quaternion = Quaternion::new(w, x, y, z);
        let norm = quaternion.norm();
        let is_rotation = norm.is_finite() && (norm - 1.0).abs() <= MAX_NORM_ERROR;
        if !is_rotation || !scale.is_finite() || scale <= 0.0 {
            return None;
        }
        Some(Self::from_parts(scale, UnitQuaternion::from_quaternion(quaternion), translation_m.into()))
    }

    /// From a rigid transformation and a scale, both taken as they are: lengths grow before they are moved.
    pub fn scaled(pose: Pose, scale: f64) -> Self {
        Self { scale, ..Self::from(pose) }
    }

    /// From its parts, taken as they are.
    pub fn from_parts(scale: f64, rotation: UnitQuaternion<f64>, translation_m: Vector3<f64>) -> Self {
        Self { scale, rotation, translation: translation_m }
    }

    /// Returns how much longer a length is in the outer frame than in the inner one.
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// Returns the translation `[x, y, z]`, in metres of the outer frame.
    pub fn translation_m(&self) -> [f64; 3] {
        self.translation.into()
    }

    /// Returns the rotation as a unit quaternion `[x, y, z, w]`.
    pub fn rotation_xyzw(&self) -> [f64; 4] {
        let q = self.rotation.quaternion();
        [q.i, q.j, q.k, q.w]
    }

    /// Returns the rotation.
    pub fn rotation(&self) -> &UnitQuaternion<f64> {
        &self.rotation
    }

    /// Its rotation and translation: the pose of a camera whose lengths are those of the outer frame.
    pub fn without_scale(&self) -> Pose {
        Pose::from_stored(self.translation_m(), self.rotation_xyzw())
    }

    /// Returns the matrix `scale * rotation` and the translation: what a loop over many points wants.
    pub fn linear_and_translation(&self) -> (Matrix3<f64>, Vector3<f64>) {
        (self.rotation.to_rotation_matrix().into_inner() * self.scale, self.translation)
    }

    /// Returns the inverse: `query_from_candidate` of a `candidate_from_query`.
    pub fn inverse(&self) -> Self {
        let (scale, rotation) = (self.scale.recip(), self.rotation.inverse());
        Self { scale, rotation, translation: -(rotation * self.translation) * scale }
    }

    /// Returns the composition: `a_from_b.after(b_from_c)` is `a_from_c`.
    pub fn after(&self, inner: &Self) -> Self {
        Self {
            scale: self.scale * inner.scale,
            rotation: self.rotation * inner.rotation,
            translation: self.rotation * inner.translation * self.scale + self.translation,
        }
    }

    /// Returns a point of the inner frame in the outer one.
    pub fn transform(&self, point: &Point3) -> Point3 {
        Point3::from(self.rotation * point.coords * self.scale + self.translation)
    }

    /// Returns a point of the outer frame in the inner one.
    pub fn inverse_transform(&self, point: &Point3) -> Point3 {
        Point3::from(self.rotation.inverse() * (point.coords - self.translation) / self.scale)
    }
}

impl From<Sim3> for (f64, Pose) {
    fn from(similarity: Sim3) -> Self {
        (similarity.scale, similarity.without_scale())
    }
}

impl From<(f64, Pose)> for Sim3 {
    fn from((scale, pose): (f64, Pose)) -> Self {
        Self::scaled(pose, scale)
    }
}

impl From<Pose> for Sim3 {
    fn from(pose: Pose) -> Self {
        let [x, y, z, w] = pose.rotation_xyzw();
        let rotation = UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z));
        Self::from_parts(1.0, rotation, pose.translation_m().into())
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::super::pose::tests::{any_point, any_rotation_xyzw};
    use super::*;
    use proptest::prelude::*;

    /// Returns a similarity with a scale between a tenth and ten.
    pub(crate) fn any_sim3() -> impl Strategy<Value = Sim3> {
        (0.1..10.0f64, prop::array::uniform3(-20.0..20.0f64), any_rotation_xyzw())
            .prop_map(|(scale, t, q)| Sim3::new(scale, t, q).expect("a similarity"))
    }

    proptest! {
        #[test]
        fn the_inverse_undoes(sim3 in any_sim3(), point in any_point()) {
            let back = sim3.inverse().transform(&sim3.transform(&point));
            prop_assert!((back - point).norm() < 1e-9);
            prop_assert!((sim3.inverse_transform(&sim3.transform(&point)) - point).norm() < 1e-9);
            let nothing = sim3.after(&sim3.inverse()).transform(&point);
            prop_assert!((nothing - point).norm() < 1e-9);
        }

        #[test]
        fn composition_is_one_after_the_other(a in any_sim3(), b in any_sim3(), point in any_point()) {
            let both = a.after(&b).transform(&point);
            prop_assert!((both - a.transform(&b.transform(&point))).norm() < 1e-8);
        }

        #[test]
        fn composition_is_associative(a in any_sim3(), b in any_sim3(), c in any_sim3(), point in any_point()) {
            let left = a.after(&b).after(&c).transform(&point);
            let right = a.after(&b.after(&c)).transform(&point);
            prop_assert!((left - right).norm() < 1e-9 * (1.0 + left.coords.norm()));
        }

        #[test]
        fn lengths_grow_by_the_scale(sim3 in any_sim3(), a in any_point(), b in any_point()) {
            let grown = (sim3.transform(&a) - sim3.transform(&b)).norm();
            prop_assert!((grown - sim3.scale() * (a - b).norm()).abs() < 1e-8);
        }

        #[test]
        fn the_matrix_form_is_the_same(sim3 in any_sim3(), point in any_point()) {
            let (linear, translation) = sim3.linear_and_translation();
            prop_assert!((linear * point.coords + translation - sim3.transform(&point).coords).norm() < 1e-9);
        }
    }

    #[test]
    fn rejects_numbers_that_are_not_a_similarity() {
        let unit = [0.0, 0.0, 0.0, 1.0];
        assert!(Sim3::new(0.0, [0.0; 3], unit).is_none());
        assert!(Sim3::new(-1.0, [0.0; 3], unit).is_none());
        assert!(Sim3::new(f64::NAN, [0.0; 3], unit).is_none());
        assert!(Sim3::new(1.0, [0.0; 3], [0.0; 4]).is_none());
        assert_eq!(Sim3::new(1.0, [0.0; 3], unit), Some(Sim3::identity()));
    }
}
