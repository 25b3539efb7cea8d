//! Points projected into an image, and for each the feature around it whose descriptor is nearest.

use nalgebra::Vector3;

use super::correspondence::Map;
use super::keypoint_grid::KeypointGrid;
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

/// An image, and the points to be looked for in it.
pub(super) struct ProjectionSearch<'a> {
    pub view: &'a View<'a>,
    pub grid: &'a KeypointGrid,
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
        let mut all = Vec::new();
        let camera = self.view.pinhole();
        for wanted in self.wanted {
            let Some(pixel) = camera.project(&self.map.apply(&wanted.point)) else { continue };
            let distance_to = |feature: u32| {
                distance_by::<POPCNT>(wanted.descriptor, self.view.descriptors.get(feature as usize))
            };
            let Some(least) = self.grid.least_around(pixel, self.radius_px, distance_to) else { continue };
            let (distance, feature) = ((least >> 32) as u32, least as u32);
            if f64::from(distance) <= self.max_distance {
                all.push(Found { distance, feature, place: wanted.place });
            }
        }
        all
    }
}
