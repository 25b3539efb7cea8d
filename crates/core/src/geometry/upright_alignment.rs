//! The rigid transformation between two frames whose vertical directions are known: a turn about the vertical, and a
//! translation. Two pairs of points are enough, where a free rotation needs three.

use nalgebra::{Isometry3, Rotation3, Translation3, Unit, UnitQuaternion, Vector3};

use super::point::Point3;
use super::pose::Pose;

/// Pairs whose horizontal extent is below this leave the turn open, in metres.
const MIN_EXTENT_M: f64 = 1e-3;

/// Returns the `to_from_from` that carries `from` onto `to` with the least sum of squared distances, among those that
/// carry the unit vector `down_from` onto `down_to`; none with fewer than two pairs, or where they stand above each
/// other. Lengths in metres.
pub fn align_upright(
    pairs: &[(Point3, Point3)],
    down_from: &Vector3<f64>,
    down_to: &Vector3<f64>,
) -> Option<Pose> {
    if pairs.len() < 2 {
        return None;
    }
    let count = pairs.len() as f64;
    let levelled = between(down_from, down_to)?;
    let sums = pairs.iter().fold((Vector3::zeros(), Vector3::zeros()), |(from_sum, to_sum), (from, to)| {
        (from_sum + levelled * from.coords, to_sum + to.coords)
    });
    let (from_mean, to_mean) = (sums.0 / count, sums.1 / count);
    let (mut cosine, mut sine, mut extent) = (0.0, 0.0, 0.0_f64);
    for (from, to) in pairs {
        let horizontal = |offset: Vector3<f64>| offset - down_to * down_to.dot(&offset);
        let from = horizontal(levelled * from.coords - from_mean);
        let to = horizontal(to.coords - to_mean);
        cosine += from.dot(&to);
        sine += down_to.dot(&from.cross(&to));
        extent += from.norm().min(to.norm());
    }
    if extent.is_nan() || extent <= MIN_EXTENT_M {
        return None;
    }
    let turn = Rotation3::from_axis_angle(&Unit::new_unchecked(*down_to), libm::atan2(sine, cosine));
    let rotation = UnitQuaternion::from_rotation_matrix(&turn) * levelled;
    let translation = to_mean - UnitQuaternion::from_rotation_matrix(&turn) * from_mean;
    Some(Pose::from(Isometry3::from_parts(Translation3::from(translation), rotation)))
}

/// Returns the shortest rotation that carries one unit vector onto another.
fn between(from: &Vector3<f64>, to: &Vector3<f64>) -> Option<UnitQuaternion<f64>> {
    UnitQuaternion::rotation_between(from, to).or_else(|| {
        // Opposite vectors leave the axis open: any that is square to them will do, for the turn is found afterwards.
        let helper = if from.x.abs() < 0.9 { Vector3::x() } else { Vector3::y() };
        let axis = Unit::try_new(from.cross(&helper), 1e-9)?;
        Some(UnitQuaternion::from_axis_angle(&axis, std::f64::consts::PI))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::pose::tests::{any_point, any_rotation_xyzw};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn two_points_and_the_vertical_give_the_pose(
            a in any_point(), b in any_point(), translation in prop::array::uniform3(-20.0..20.0f64),
            rotation in any_rotation_xyzw(), down in any_rotation_xyzw(),
        ) {
            let truth = Pose::new(translation, rotation).expect("a rotation");
            let down_from = Pose::new([0.0; 3], down).expect("a rotation").isometry().rotation * Vector3::z();
            let down_to = truth.isometry().rotation * down_from;
            let offset = b - a;
            let horizontal = (offset - down_from * down_from.dot(&offset)).norm();
            prop_assume!(horizontal > 0.1);
            let pairs = [(a, truth.transform(&a)), (b, truth.transform(&b))];
            let found = align_upright(&pairs, &down_from, &down_to).expect("two points apart");
            for point in [a, b, Point3::new(1.0, 2.0, 3.0)] {
                prop_assert!((found.transform(&point) - truth.transform(&point)).norm() < 1e-6);
            }
        }
    }

    #[test]
    fn points_above_each_other_leave_the_turn_open() {
        let down = Vector3::z();
        let pair = |z: f64| (Point3::new(1.0, 2.0, z), Point3::new(3.0, 4.0, z));
        assert_eq!(align_upright(&[pair(0.0), pair(2.0)], &down, &down), None);
        assert_eq!(align_upright(&[pair(0.0)], &down, &down), None);
    }
}
