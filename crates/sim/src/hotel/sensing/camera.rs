//! Camera: the pose of the robot's camera, and projection into its image of 640 x 480 (§VI).

use crate::domain::keyframe::Camera;
use crate::geometry::pinhole::Pinhole;
use crate::geometry::{Point3, Pose};
use crate::hotel::building::floor_plan::Flat;

/// Focal length, in pixels: a horizontal field of view of 63 degrees, as a RealSense D435i has.
pub const FOCAL_LENGTH_PX: f64 = 525.0;
/// The image's sides, in pixels.
pub const IMAGE_PX: [f64; 2] = [640.0, 480.0];
/// The camera with its image size.
pub const CAMERA: Camera = Camera {
    fx: FOCAL_LENGTH_PX,
    fy: FOCAL_LENGTH_PX,
    cx: IMAGE_PX[0] / 2.0,
    cy: IMAGE_PX[1] / 2.0,
    width: IMAGE_PX[0] as u32,
    height: IMAGE_PX[1] as u32,
};
/// The camera without its image size.
pub const PINHOLE: Pinhole = Pinhole { fx: CAMERA.fx, fy: CAMERA.fy, cx: CAMERA.cx, cy: CAMERA.cy };
/// The camera's height above the floor.
pub const CAMERA_HEIGHT_M: f64 = 1.2;
/// Minimum focus distance.
const NEAREST_M: f64 = 0.3;

/// A position on the floor, and a heading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stand {
    /// The position, in metres.
    pub at: Flat,
    /// In radians from x towards y.
    pub heading_rad: f64,
}

impl Stand {
    /// Returns `map_from_camera` of the upright camera of a robot that stands here: x right, y down, z forward.
    pub fn map_from_camera(&self) -> Pose {
        let half = (self.heading_rad - std::f64::consts::FRAC_PI_2) / 2.0;
        // First from camera axes to a camera that faces the map's y, then the turn about the map's z.
        let h = std::f64::consts::FRAC_1_SQRT_2;
        let (turn, level) = ([0.0, 0.0, half.sin(), half.cos()], [-h, 0.0, 0.0, h]);
        let rotation = [
            turn[3] * level[0] - turn[2] * level[1],
            turn[3] * level[1] + turn[2] * level[0],
            turn[2] * level[3] + turn[3] * level[2],
            turn[3] * level[3] - turn[2] * level[2],
        ];
        Pose::from_stored([self.at[0], self.at[1], CAMERA_HEIGHT_M], rotation)
    }
}

/// Projects a point of the camera's frame; none outside the image.
pub fn project(point_in_camera: &Point3) -> Option<[f64; 2]> {
    if point_in_camera.z < NEAREST_M {
        return None;
    }
    let u = FOCAL_LENGTH_PX.mul_add(point_in_camera.x / point_in_camera.z, IMAGE_PX[0] / 2.0);
    let v = FOCAL_LENGTH_PX.mul_add(point_in_camera.y / point_in_camera.z, IMAGE_PX[1] / 2.0);
    ((0.0..IMAGE_PX[0]).contains(&u) && (0.0..IMAGE_PX[1]).contains(&v)).then_some([u, v])
}

/// Returns the point at this depth and pixel, in the camera's frame.
pub fn unproject(pixel: [f64; 2], depth_m: f64) -> Point3 {
    let x = (pixel[0] - IMAGE_PX[0] / 2.0) / FOCAL_LENGTH_PX * depth_m;
    let y = (pixel[1] - IMAGE_PX[1] / 2.0) / FOCAL_LENGTH_PX * depth_m;
    Point3::new(x, y, depth_m)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_camera_stands_upright_and_looks_along_its_heading() {
        for heading_rad in [0.0, 1.0, -2.5, 3.0] {
            let stand = Stand { at: [3.0, -2.0], heading_rad };
            let pose = stand.map_from_camera();
            let ahead = pose.transform(&Point3::new(0.0, 0.0, 2.0));
            let expected = [3.0 + 2.0 * heading_rad.cos(), -2.0 + 2.0 * heading_rad.sin(), CAMERA_HEIGHT_M];
            let below = pose.transform(&Point3::new(0.0, 1.0, 0.0));
            let right = pose.transform(&Point3::new(1.0, 0.0, 0.0));
            assert!((ahead - Point3::from(expected)).norm() < 1e-12);
            assert!((below - Point3::new(3.0, -2.0, CAMERA_HEIGHT_M - 1.0)).norm() < 1e-12);
            let expected = [3.0 + heading_rad.sin(), -2.0 - heading_rad.cos(), CAMERA_HEIGHT_M];
            assert!((right - Point3::from(expected)).norm() < 1e-12);
        }
    }

    #[test]
    fn a_projected_point_comes_back() {
        let point = Point3::new(0.4, -0.2, 2.5);
        let pixel = project(&point).expect("in the image");
        assert!((unproject(pixel, point.z) - point).norm() < 1e-12);
        assert!(project(&Point3::new(0.0, 0.0, -1.0)).is_none());
        assert!(project(&Point3::new(2.0, 0.0, 2.0)).is_none());
    }
}
