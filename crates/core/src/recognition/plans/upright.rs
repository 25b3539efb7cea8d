//! The vertical of a session's frame.
//!
//! Gravity tells it where the map or the keyframes have it. Where nothing does, most frames have z up, and those of cameras have y down. Cameras are carried upright,
//! so the axis of the frame that is nearest to their mean vertical is the frame's own.

use nalgebra::{UnitQuaternion, Vector3};

use crate::geometry::Pose;

/// The cosine of the largest angle between the cameras' mean vertical and an axis: cameras that look down at a slant tell
/// nothing.
const COS_MAX_SLANT: f64 = 0.8;

/// The least length of the mean of the cameras' verticals, unit vectors each: where they cancel, they tell nothing.
const MEAN_MIN_LENGTH: f64 = 0.1;

/// Returns the direction up, along an axis of the frame in which the cameras' poses are; z where they tell nothing.
pub fn vertical(map_from_cameras: impl Iterator<Item = Pose>) -> Vector3<f64> {
    // The camera's y points down.
    let ups = map_from_cameras.map(|pose| -(pose.isometry().rotation * Vector3::y()));
    let (count, up) = ups.fold((0_u32, Vector3::zeros()), |(count, sum), up| (count + 1, sum + up));
    let (axis, length) = (up.iamax(), up.norm());
    if length > MEAN_MIN_LENGTH * f64::from(count) && up[axis].abs() >= COS_MAX_SLANT * length {
        let mut vertical = Vector3::zeros();
        vertical[axis] = up[axis].signum();
        vertical
    } else {
        Vector3::z()
    }
}

/// Returns the rotation that brings a vertical to z.
pub fn levelling(vertical: &Vector3<f64>) -> UnitQuaternion<f64> {
    // Opposite directions leave the axis open; any horizontal one does.
    let half_turn = UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(0.0, 1.0, 0.0, 0.0));
    UnitQuaternion::rotation_between(vertical, &Vector3::z()).unwrap_or(half_turn)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns cameras that look around level, in a frame in which z is up, turned by `frame`.
    fn cameras(frame: UnitQuaternion<f64>) -> Vec<Pose> {
        // Optical axes: x right, y down, z forward, looking along the frame's x.
        let level = UnitQuaternion::from_euler_angles(
            -std::f64::consts::FRAC_PI_2,
            0.0,
            -std::f64::consts::FRAC_PI_2,
        );
        let looks = (0..8).map(|step| UnitQuaternion::from_euler_angles(0.0, 0.0, f64::from(step) * 0.3));
        looks
            .map(|look| {
                Pose::from(nalgebra::Isometry3::from_parts(
                    nalgebra::Translation3::default(),
                    frame * look * level,
                ))
            })
            .collect()
    }

    #[test]
    fn the_vertical_is_the_axis_nearest_to_the_cameras() {
        let quarter = std::f64::consts::FRAC_PI_2;
        for (roll, expected) in [(0.0, Vector3::z()), (-quarter, Vector3::y()), (quarter, -Vector3::y())] {
            let frame = UnitQuaternion::from_euler_angles(roll, 0.0, 0.0);
            let found = vertical(cameras(frame).into_iter());
            assert!((found - frame * Vector3::z()).norm() < 1e-9, "{roll}: {found}");
            assert!((found - expected).norm() < 1e-9, "{roll}: {found}");
            assert!((levelling(&found) * found - Vector3::z()).norm() < 1e-9);
        }
        // Cameras that look straight down, each with its top elsewhere, tell nothing.
        let down = UnitQuaternion::from_euler_angles(std::f64::consts::PI, 0.0, 0.0);
        let tops =
            (0..8).map(|step| UnitQuaternion::from_euler_angles(0.0, 0.0, f64::from(step) * quarter / 2.0));
        let looking_down = tops.map(|top| {
            Pose::from(nalgebra::Isometry3::from_parts(nalgebra::Translation3::default(), top * down))
        });
        assert_eq!(vertical(looking_down), Vector3::z());
        assert!((levelling(&-Vector3::z()) * -Vector3::z() - Vector3::z()).norm() < 1e-9);
    }
}
