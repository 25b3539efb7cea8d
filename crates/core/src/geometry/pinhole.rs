//! An undistorted pinhole camera: from a point in the camera's frame to a pixel.

use nalgebra::Vector3;

/// A point must be at least this far in front of the camera to have a pixel, in the frame's length unit.
pub const MIN_DEPTH: f64 = 1e-6;

/// Focal lengths and principal point, in pixels. The camera frame is x right, y down, z forward.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pinhole {
    /// Focal length along x.
    pub fx: f64,
    /// Focal length along y.
    pub fy: f64,
    /// Principal point, x.
    pub cx: f64,
    /// Principal point, y.
    pub cy: f64,
}

impl Pinhole {
    /// Returns the pixel of a point in the camera's frame; `None` if it is not in front of the camera.
    #[inline(always)]
    pub fn project(&self, point_in_camera: &Vector3<f64>) -> Option<[f64; 2]> {
        let p = point_in_camera;
        (p.z > MIN_DEPTH).then(|| {
            let inverse_depth = p.z.recip();
            [self.fx * p.x * inverse_depth + self.cx, self.fy * p.y * inverse_depth + self.cy]
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_points_in_front_have_a_pixel() {
        let camera = Pinhole { fx: 500.0, fy: 400.0, cx: 320.0, cy: 240.0 };
        assert_eq!(camera.project(&Vector3::new(1.0, -1.0, 2.0)), Some([570.0, 40.0]));
        assert_eq!(camera.project(&Vector3::new(1.0, -1.0, -2.0)), None);
        assert_eq!(camera.project(&Vector3::zeros()), None);
        assert_eq!(camera.project(&Vector3::new(0.0, 0.0, f64::NAN)), None);
    }
}
