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
    /// Position in the frame it comes from.
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
    /// The transformation of the points into the frame of the image's camera.
    pub map: &'a Map,
    pub wanted: &'a [Wanted<'a>],
    /// Largest distance of a feature from the projection, in pixels.
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
                *distance =
                    distance_by::<POPCNT>(wanted, &self.image.descriptors[(at + one) * each..][..each]);
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
            let nearest =
                self.image.grid.nearest_around(pixel, self.radius_px, |at| distances(wanted.descriptor, at));
            let Some(nearest) = nearest else { continue };
            let (distance, feature) = ((nearest >> 32) as u32, nearest as u32);
            if f64::from(distance) <= self.max_distance {
                all.push(Found { distance, feature, place: wanted.place });
            }
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::domain::keyframe::{Camera, Keypoint};
    use crate::geometry::hamming::{PackedDescriptors, distance};
    use crate::geometry::instruction_set::dispatch;
    use crate::geometry::instruction_set::portable::portably;
    use crate::geometry::{Point3, Sim3};

    const CAMERA: Camera = Camera { fx: 100.0, fy: 100.0, cx: 100.0, cy: 80.0, width: 200, height: 160 };

    /// The place of a keypoint, and the byte that its descriptor consists of.
    type Feature = ((f64, f64), u8);

    /// The bytes of a descriptor, and features inside and outside the image.
    fn features() -> impl Strategy<Value = (usize, Vec<Feature>)> {
        let feature = ((-20.0..220.0f64, -20.0..180.0f64), 0..4_u8);
        (prop_oneof![Just(8_usize), Just(32), Just(40)], prop::collection::vec(feature, 0..150))
    }

    proptest! {
        #[test]
        fn it_finds_what_a_loop_over_all_finds(
            (each, features) in features(),
            (u, v) in (-40.0..240.0f64, -40.0..200.0f64),
            radius_px in 0.0..60.0f64,
            max_distance in 0..40_u32,
        ) {
            let keypoint = |&((u, v), _): &Feature| Keypoint { u, v, octave: 0, angle_deg: None };
            let keypoints: Vec<Keypoint> = features.iter().map(keypoint).collect();
            let bytes: Vec<u8> = features.iter().flat_map(|(_, byte)| vec![*byte; each]).collect();
            let descriptors = PackedDescriptors::from_bytes(each, &bytes).expect("whole descriptors");
            let points: Vec<Option<Point3>> = vec![None; keypoints.len()];
            let view = View {
                camera: CAMERA,
                keypoints: &keypoints,
                descriptors: &descriptors,
                nodes: None,
                points_in_camera: &points,
            };
            let zero = vec![0; each / 8];
            let point = Vector3::new((u - 100.0) / 50.0, (v - 80.0) / 50.0, 2.0);
            let wanted = [Wanted { place: 7, point, descriptor: &zero }];
            let (image, map) = (IndexedImage::new(&view), Map::of(&Sim3::identity()));
            let max_distance = f64::from(max_distance);
            let search =
                || dispatch(ProjectionSearch { image: &image, map: &map, wanted: &wanted, radius_px, max_distance });

            let pixel = view.pinhole().project(&point).expect("in front");
            let near = keypoints.iter().enumerate().filter(|(_, at)| {
                (at.u - pixel[0]).powi(2) + (at.v - pixel[1]).powi(2) < radius_px * radius_px
            });
            let nearest = near.map(|(at, _)| (distance(&zero, descriptors.get(at)), at as u32)).min();
            let nearest = nearest.filter(|(distance, _)| f64::from(*distance) <= max_distance);
            let expected: Vec<Found> =
                nearest.map(|(distance, feature)| Found { distance, feature, place: 7 }).into_iter().collect();
            prop_assert_eq!(search(), expected.clone());
            prop_assert_eq!(portably(search), expected);
        }
    }
}
