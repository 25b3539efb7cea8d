//! The part of an image that a transformation explains, as cells of a grid.
//!
//! Inliers crowd on what repeats: a lamp, a poster, the grain of a wall. The cells that hold one say how much of the view is
//! explained, and two places that look alike in part are told apart by what only one of them explains.

use std::collections::BTreeSet;

use crate::domain::keyframe::Camera;

/// Cells along the longer side of an image.
pub(in crate::recognition) const CELLS_ALONG_LONGER_SIDE: f64 = 40.0;

/// Cells of the image of one keyframe of a question, by the keyframe's number, row and column.
pub type Cells = BTreeSet<(usize, i32, i32)>;

/// Returns the cells of an image that hold one of these pixels; `keyframe` is the number that the cells bear.
pub fn cells(keyframe: usize, camera: &Camera, pixels: &[[f64; 2]]) -> Cells {
    let side_px = f64::from(camera.width.max(camera.height)) / CELLS_ALONG_LONGER_SIDE;
    let cell = |px: f64| (px / side_px).floor() as i32;
    pixels.iter().map(|[u, v]| (keyframe, cell(*v), cell(*u))).collect()
}
