//! Points projected into an image, and for each the feature around it whose descriptor is nearest.

use nalgebra::Vector3;

use super::correspondence::Map;
use super::keypoint_grid::{BLOCK, KeypointGrid};
use super::view::View;
use crate::geometry::hamming::distance_by;
use crate::geometry::instruction_set::Kernel;

/// A point to be looked for in an image.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wanted<'a> {
    /// Its place in the list it comes from.
    pub place: u32,
    /// Where it is, in the frame it comes from.
    pub point: Vector3<f64>,
    /// Its descriptor.
    pub descriptor: &'a [u64],
}

/// A feature found where a point is projected to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Found {
    /// The number of bits in which the descriptors differ.
    pub distance: u32,
    /// The feature.
    pub feature: u32,
    /// The place of the point.
    pub place: u32,
}

/// An image's features by place.
pub(super) struct IndexedImage<'a> {
    view: &'a View<'a>,
    grid: KeypointGrid,
    /// The descriptors in the order of the grid.
    descriptors: Vec<u64>,
}

impl<'a> IndexedImage<'a> {
    pub(super) fn new(view: &'a View<'a>) -> Self {
        let grid = KeypointGrid::new(view.keypoints, &view.camera);
        let mut descriptors = Vec::with_capacity(grid.features().len() * view.descriptors.words_each());
        if !view.keypoints.is_empty() {
            for &feature in grid.features() {
                descriptors.extend_from_slice(view.descriptors.get(feature as usize));
            }
        }
        Self { view, grid, descriptors }
    }

    /// Returns the number of bits of a descriptor.
    pub(super) fn descriptor_bits(&self) -> u32 {
        self.view.descriptors.bits()
    }
}

/// An image, and the points to be looked for in it.
pub(super) struct ProjectionSearch<'a> {
    pub image: &'a IndexedImage<'a>,
    /// What maps the points into the frame of the image's camera.
    pub map: &'a Map,
    pub wanted: &'a [Wanted<'a>],
    /// How far from the projection a feature may be, in pixels.
    pub radius_px: f64,
    /// The largest distance of the descriptors, in bits.
    pub max_distance: f64,
}

impl Kernel for ProjectionSearch<'_> {
    type Output = Vec<Found>;

    /// Ties in distance go to the first feature.
    #[inline(always)]
    fn run<const POPCNT: bool>(self) -> Vec<Found> {
        match self.image.view.descriptors.words_each() {
            4 => self.run_by::<POPCNT, 4>(),
            each => self.run_by_any::<POPCNT>(each),
        }
    }
}

impl ProjectionSearch<'_> {
    /// The search for descriptors of `N` words.
    #[inline(always)]
    fn run_by<const POPCNT: bool, const N: usize>(self) -> Vec<Found> {
        let descriptors = self.image.descriptors.as_chunks::<N>().0;
        self.find(|wanted, at| {
            let mut distances = [0; BLOCK];
            for (distance, near) in distances.iter_mut().zip(&descriptors[at..at + BLOCK]) {
                *distance = distance_by::<POPCNT>(wanted, near);
            }
            distances
        })
    }

    /// The search for descriptors of `each` words.
    #[inline(always)]
    fn run_by_any<const POPCNT: bool>(self, each: usize) -> Vec<Found> {
        self.find(|wanted, at| {
            let mut distances = [0; BLOCK];
            for (one, distance) in distances.iter_mut().enumerate() {
                *distance = distance_by::<POPCNT>(wanted, &self.image.descriptors[(at + one) * each..][..each]);
            }
            distances
        })
    }

    #[inline(always)]
    fn find(&self, distances: impl Fn(&[u64], usize) -> [u32; BLOCK]) -> Vec<Found> {
        let camera = self.image.view.pinhole();
        let mut all = Vec::new();
        for wanted in self.wanted {
            let Some(pixel) = camera.project(&self.map.apply(&wanted.point)) else { continue };
            let nearest = self.image.grid.nearest_around(pixel, self.radius_px, |at| {
                distances(wanted.descriptor, at)
            });
            let Some(nearest) = nearest else { continue };
            let (distance, feature) = ((nearest >> 32) as u32, nearest as u32);
            if f64::from(distance) <= self.max_distance {
                all.push(Found { distance, feature, place: wanted.place });
            }
        }
        all
    }
}
