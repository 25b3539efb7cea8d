//! Triangulation: the position of a point seen from two poses.
//!
//! Uses the midpoint of the shortest line between the two rays (R. I. Hartley and P. Sturm, "Triangulation", CVIU 68,
//! 1997, §3.1). ORB-SLAM's conditions apply: parallax, in front of both cameras, and a small reprojection error.

use super::camera::{PINHOLE, unproject};
use super::sensor::OCTAVE_FACTOR;
use crate::domain::keyframe::Keypoint;
use crate::geometry::{Point3, Pose};

/// Minimum angle between the two rays: its cosine is 0.9998 (ORB-SLAM2, `LocalMapping::CreateNewMapPoints`).
const MIN_PARALLAX_RAD: f64 = 0.02;
/// Maximum squared reprojection error in variances: chi-squared with two degrees of freedom at 95 %.
const MAX_SQUARED_ERROR: f64 = 5.991;

/// A triangulated point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangulated {
    /// Its position in the second camera's frame.
    pub in_second: Point3,
    /// The angle between the two rays.
    pub parallax_rad: f64,
}

/// Triangulates a point from two observations and the motion between them, `first_from_second`.
pub fn triangulate(first_from_second: &Pose, first: Keypoint, second: Keypoint) -> Option<Triangulated> {
    let centre = first_from_second.centre().coords;
    let towards_first = unproject([first.u, first.v], 1.0).coords;
    let towards_second = first_from_second.transform(&unproject([second.u, second.v], 1.0)).coords - centre;
    let parallax_rad = towards_first.angle(&towards_second);
    if parallax_rad < MIN_PARALLAX_RAD {
        return None;
    }
    // The depths d and e with the least |d a - (c + e b)|^2.
    let (a, b, c) = (towards_first, towards_second, centre);
    let (aa, ab, bb, ac, bc) = (a.dot(&a), a.dot(&b), b.dot(&b), a.dot(&c), b.dot(&c));
    let determinant = aa * bb - ab * ab;
    let (d, e) = ((ac * bb - ab * bc) / determinant, (ab * ac - aa * bc) / determinant);
    if !(d > 0.0 && e > 0.0) {
        return None;
    }
    let in_first = Point3::from((a * d + c + b * e) / 2.0);
    let in_second = first_from_second.inverse_transform(&in_first);
    (is_seen(&in_first, first) && is_seen(&in_second, second))
        .then_some(Triangulated { in_second, parallax_rad })
}

/// Whether the point projects to its observation.
fn is_seen(in_camera: &Point3, seen: Keypoint) -> bool {
    let Some([u, v]) = PINHOLE.project(&in_camera.coords) else { return false };
    let sigma_px = OCTAVE_FACTOR.powi(i32::from(seen.octave));
    let squared_px = (u - seen.u).powi(2) + (v - seen.v).powi(2);
    squared_px <= MAX_SQUARED_ERROR * sigma_px * sigma_px
}

#[cfg(test)]
mod tests {
    use super::*;

    fn aside(x: f64) -> Pose {
        Pose::new([x, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]).expect("a pose")
    }

    fn sight(point: &Point3, from: &Pose) -> Keypoint {
        let [u, v] = PINHOLE.project(&from.inverse_transform(point).coords).expect("in front");
        Keypoint { u, v, octave: 2, angle_deg: None }
    }

    #[test]
    fn a_point_is_where_two_rays_meet() {
        let (point, second) = (Point3::new(0.3, -0.2, 3.0), aside(0.4));
        let found =
            triangulate(&second, sight(&point, &aside(0.0)), sight(&point, &second)).expect("a point");
        assert!((found.in_second - second.inverse_transform(&point)).norm() < 1e-9);
        assert!((found.parallax_rad - 0.132).abs() < 1e-3, "{}", found.parallax_rad);
    }

    #[test]
    fn without_parallax_behind_a_camera_or_off_the_other_ray_there_is_none() {
        let point = Point3::new(0.3, -0.2, 3.0);
        let first = sight(&point, &aside(0.0));
        assert_eq!(triangulate(&aside(0.05), first, sight(&point, &aside(0.05))), None, "one degree");
        let second = sight(&point, &aside(0.4));
        assert_eq!(triangulate(&aside(-0.4), first, second), None, "the rays meet behind");
        let off = |by_px: f64| Keypoint { v: second.v + by_px, ..second };
        // Each of the two observations has half of the error; 1.44 pixels are one standard deviation.
        assert!(triangulate(&aside(0.4), first, off(6.0)).is_some());
        assert_eq!(triangulate(&aside(0.4), first, off(8.0)), None);
    }
}
