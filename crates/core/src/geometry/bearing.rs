//! Where an anchor stands as seen from a camera: bearing and distance (§V-B).

use nalgebra::Vector3;

use super::point::Point3;
use super::pose::Pose;

/// The direction and the distance of a point from a camera's centre.
///
/// The paper says "the angle θ_m of anchor A_m with respect to its central keyframe" and leaves
/// open of what. We take the unit vector from the camera's centre to the anchor's centre *in
/// the keyframe's camera frame* (M2), so that the difference of two bearings is
/// one angle in `[0, pi]`, whatever frames the two maps have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bearing {
    direction_in_camera: Vector3<f64>,
    distance_m: f64,
}

impl Bearing {
    /// Returns the bearing of a point given in the map's frame. A point in the camera's very centre has no direction;
    /// it counts as straight ahead, at distance zero.
    pub fn of(point_in_map: &Point3, map_from_camera: &Pose) -> Self {
        let in_camera = map_from_camera.inverse_transform(point_in_map).coords;
        let distance_m = in_camera.norm();
        let direction_in_camera = if distance_m > 0.0 { in_camera / distance_m } else { Vector3::z() };
        Self { direction_in_camera, distance_m }
    }

    /// Returns the unit vector towards the point, in the camera frame (x right, y down, z forward).
    pub fn direction_in_camera(&self) -> [f64; 3] {
        self.direction_in_camera.into()
    }

    /// Returns the Euclidean distance, in metres.
    pub fn distance_m(&self) -> f64 {
        self.distance_m
    }

    /// Returns the angle between two bearings, each in its own camera frame, in `[0, pi]` radians.
    pub fn angle_difference_rad(&self, other: &Self) -> f64 {
        // atan2 keeps its precision at 0 and pi, where acos of the dot product loses half the digits.
        let (a, b) = (&self.direction_in_camera, &other.direction_in_camera);
        libm::atan2(a.cross(b).norm(), a.dot(b))
    }

    /// Returns the absolute difference of the two distances, in metres.
    pub fn distance_difference_m(&self, other: &Self) -> f64 {
        (self.distance_m - other.distance_m).abs()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    fn seen_from_origin(point: [f64; 3]) -> Bearing {
        Bearing::of(&Point3::from(point), &Pose::identity())
    }

    #[test]
    fn the_difference_is_the_angle_between_the_two_vectors() {
        let ahead = seen_from_origin([0.0, 0.0, 2.0]);
        assert!((ahead.angle_difference_rad(&seen_from_origin([3.0, 0.0, 0.0])) - FRAC_PI_2).abs() < 1e-15);
        assert!((ahead.angle_difference_rad(&seen_from_origin([0.0, 0.0, -1.0])) - PI).abs() < 1e-15);
        assert_eq!(ahead.angle_difference_rad(&ahead), 0.0);
        assert_eq!(ahead.distance_difference_m(&seen_from_origin([3.0, 0.0, 0.0])), 1.0);
    }

    #[test]
    fn a_camera_that_turns_sees_the_bearing_turn() {
        // 90 degrees about y (down): the camera now looks along x.
        let half = (PI / 4.0).sin();
        let turned = Pose::new([0.0; 3], [0.0, half, 0.0, half]).expect("a unit quaternion");
        let bearing = Bearing::of(&Point3::new(2.0, 0.0, 0.0), &turned);
        let [x, y, z] = bearing.direction_in_camera();
        assert!(x.abs() < 1e-12 && y.abs() < 1e-12 && (z - 1.0).abs() < 1e-12);
    }
}
