//! The keypoints of an image by square cells, to find those around a pixel.

use std::ops::Range;

use crate::domain::keyframe::{Camera, Keypoint};

/// The side of a cell, in pixels (ORB-SLAM: 10; larger here, since the radius is).
const CELL_PX: f64 = 16.0;

/// Maximum cells each way, whatever image size a client declares.
const CELLS_MAX: f64 = 1024.0;

/// Keypoints that are looked at together: a row of cells around a pixel has two or three.
pub(super) const BLOCK: usize = 4;

/// Keypoints by cell. Those outside the image belong to the cells at its border.
#[derive(Clone, Debug)]
pub struct KeypointGrid {
    columns: usize,
    rows: usize,
    /// The start of each cell's keypoints in the lists after it, which run in parallel and end with [`BLOCK`] more that are
    /// nowhere.
    starts: Vec<u32>,
    features: Vec<u32>,
    u: Vec<f64>,
    v: Vec<f64>,
}

impl KeypointGrid {
    /// Sorts the keypoints into cells.
    pub fn new(keypoints: &[Keypoint], camera: &Camera) -> Self {
        let cells = |length: u32| (f64::from(length) / CELL_PX).ceil().clamp(1.0, CELLS_MAX) as usize;
        let (columns, rows) = (cells(camera.width), cells(camera.height));
        let mut grid = Self {
            columns,
            rows,
            starts: vec![0; columns * rows + 1],
            features: vec![0; keypoints.len() + BLOCK],
            u: vec![f64::NAN; keypoints.len() + BLOCK],
            v: vec![f64::NAN; keypoints.len() + BLOCK],
        };
        let cells: Vec<usize> =
            keypoints.iter().map(|it| grid.row(it.v) * columns + grid.column(it.u)).collect();
        for &cell in &cells {
            grid.starts[cell + 1] += 1;
        }
        for cell in 0..columns * rows {
            grid.starts[cell + 1] += grid.starts[cell];
        }
        let mut next = grid.starts.clone();
        for (feature, (keypoint, &cell)) in keypoints.iter().zip(&cells).enumerate() {
            let at = next[cell] as usize;
            grid.features[at] = feature as u32;
            (grid.u[at], grid.v[at]) = (keypoint.u, keypoint.v);
            next[cell] += 1;
        }
        grid
    }

    /// Returns the keypoints closer than `radius_px` to a pixel, in no particular order.
    pub fn around(&self, pixel: [f64; 2], radius_px: f64) -> impl Iterator<Item = u32> + '_ {
        let is_near = move |at: &usize| is_closer(pixel, [self.u[*at], self.v[*at]], radius_px);
        self.stretches(pixel, radius_px).flatten().filter(is_near).map(|at| self.features[at])
    }

    /// Returns the features by cell, and after them [`BLOCK`] times feature 0.
    pub(super) fn features(&self) -> &[u32] {
        &self.features
    }

    /// Returns the keypoint closer than `radius_px` to a pixel that is nearest by `distances`, the first feature of equal
    /// ones: the distance in the upper half, the feature below. `distances` are those of the block at a place in
    /// [`KeypointGrid::features`].
    ///
    /// Keypoints are looked at in blocks, some of which are farther away: that costs less than to mispredict which are.
    #[inline(always)]
    pub(super) fn nearest_around(
        &self,
        pixel: [f64; 2],
        radius_px: f64,
        distances: impl Fn(usize) -> [u32; BLOCK],
    ) -> Option<u64> {
        let mut nearest = u64::MAX;
        for stretch in self.stretches(pixel, radius_px) {
            for at in stretch.step_by(BLOCK) {
                let end = at + BLOCK;
                let (features, u, v) = (&self.features[at..end], &self.u[at..end], &self.v[at..end]);
                let distances = distances(at);
                for one in 0..BLOCK {
                    let is_near = is_closer(pixel, [u[one], v[one]], radius_px);
                    let key = u64::from(distances[one]) << 32 | u64::from(features[one]);
                    nearest = nearest.min(if is_near { key } else { u64::MAX });
                }
            }
        }
        (nearest != u64::MAX).then_some(nearest)
    }

    /// Returns where the keypoints of all cells within a radius are, row by row: cells of one row lie side by side.
    #[inline(always)]
    fn stretches(&self, [u, v]: [f64; 2], radius_px: f64) -> impl Iterator<Item = Range<usize>> + use<'_> {
        let columns = self.column(u - radius_px)..self.column(u + radius_px) + 1;
        let rows = self.row(v - radius_px)..self.row(v + radius_px) + 1;
        rows.map(move |row| {
            let (first, last) = (row * self.columns + columns.start, row * self.columns + columns.end);
            self.starts[first] as usize..self.starts[last] as usize
        })
    }

    #[inline(always)]
    fn column(&self, u: f64) -> usize {
        // A cast takes what is below 0 and what is no number to 0.
        ((u / CELL_PX) as usize).min(self.columns - 1)
    }

    #[inline(always)]
    fn row(&self, v: f64) -> usize {
        ((v / CELL_PX) as usize).min(self.rows - 1)
    }
}

#[inline(always)]
fn is_closer([u, v]: [f64; 2], [x, y]: [f64; 2], radius_px: f64) -> bool {
    (x - u) * (x - u) + (y - v) * (y - v) < radius_px * radius_px
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn it_finds_what_a_loop_over_all_finds(
            pixels in prop::collection::vec((-50.0..700.0f64, -50.0..530.0f64), 0..200),
            (u, v) in (-100.0..800.0f64, -100.0..600.0f64),
            radius in 0.0..120.0f64,
        ) {
            let camera = Camera { fx: 1.0, fy: 1.0, cx: 0.0, cy: 0.0, width: 640, height: 480 };
            let keypoint = |&(u, v): &(f64, f64)| Keypoint { u, v, octave: 0, angle_deg: None };
            let keypoints: Vec<_> = pixels.iter().map(keypoint).collect();
            let mut found: Vec<u32> = KeypointGrid::new(&keypoints, &camera).around([u, v], radius).collect();
            found.sort_unstable();
            let is_near = |&i: &u32| {
                let (x, y) = pixels[i as usize];
                (x - u) * (x - u) + (y - v) * (y - v) < radius * radius
            };
            prop_assert_eq!(found, (0..pixels.len() as u32).filter(is_near).collect::<Vec<_>>());
        }
    }
}
