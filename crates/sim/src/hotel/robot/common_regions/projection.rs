//! Projection: map points visible in a query where a transformation predicts them (ORB-SLAM3's `SearchByProjection`).

use super::window::WindowPoint;
use crate::geometry::hamming::distance_fixed;
use crate::geometry::{Point3, Pose};
use crate::hotel::sensing::camera::{CAMERA, project};
use crate::hotel::sensing::sensor::{Feature, OCTAVE_FACTOR, OCTAVES};
use crate::recognition::verification::keypoint_grid::KeypointGrid;

/// Maximum differing bits of similar descriptors (ORB-SLAM3's `TH_LOW`).
const ALIKE_BITS: f64 = 50.0;
/// Nearest distance at which a point is recognised, as a factor of the octaves' range.
const NEAREST_FACTOR: f64 = 0.8;
/// Farthest distance, likewise.
const FARTHEST_FACTOR: f64 = 1.2;
/// The cosine of the widest angle between two directions from which a point is recognised: 60 degrees.
const VIEW_COSINE: f64 = 0.5;

/// Limits of a search: the distance in the image and between descriptors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Search {
    /// In pixels, at octave 0.
    pub radius_px: f64,
    /// The multiple of [`ALIKE_BITS`] by which descriptors may differ.
    pub bits_factor: f64,
}

impl Search {
    /// Before refinement.
    pub const FIRST: Self = Self { radius_px: 8.0, bits_factor: 1.5 };
    /// After it.
    pub const REFINED: Self = Self { radius_px: 5.0, bits_factor: 1.0 };
    /// For neighbours of the query, and keyframes that follow it.
    pub const NEIGHBOURS: Self = Self { radius_px: 3.0, bits_factor: 1.5 };
}

/// A keyframe's features, indexed by pixel.
#[derive(Debug)]
pub struct Image<'a> {
    features: &'a [Feature],
    grid: KeypointGrid,
}

/// A map point and its feature.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Found {
    /// Its index among the window's points.
    pub point: usize,
    /// The feature's index in the image.
    pub feature: usize,
    /// The number of differing bits of the descriptors.
    pub distance: u32,
}

impl<'a> Image<'a> {
    /// Sorts the features by position.
    pub fn new(features: &'a [Feature]) -> Self {
        let keypoints: Vec<_> = features.iter().map(|feature| feature.keypoint).collect();
        Self { features, grid: KeypointGrid::new(&keypoints, &CAMERA) }
    }

    /// Returns the features.
    pub fn features(&self) -> &'a [Feature] {
        self.features
    }

    /// Searches for each point where `candidate_from_query` predicts it; a feature matches at most one point, the
    /// first.
    pub fn search(&self, points: &[WindowPoint], candidate_from_query: &Pose, search: Search) -> Vec<Found> {
        let mut is_taken = vec![false; self.features.len()];
        let query_centre = candidate_from_query.centre();
        let mut found = Vec::new();
        for (place, point) in points.iter().enumerate() {
            let in_query = candidate_from_query.inverse_transform(&point.in_candidate);
            let Some((pixel, octave)) = project(&in_query).zip(predicted_octave(point, &query_centre)) else {
                continue;
            };
            let radius_px = search.radius_px * OCTAVE_FACTOR.powi(i32::from(octave));
            let near = self.grid.around(pixel, radius_px).map(|feature| feature as usize);
            let might_be = near.filter(|feature| {
                let seen_in = self.features[*feature].keypoint.octave;
                !is_taken[*feature] && (seen_in == octave || seen_in + 1 == octave)
            });
            let by_distance = might_be.map(|feature| {
                (distance_fixed(&self.features[feature].descriptor, &point.descriptor), feature)
            });
            if let Some((distance, feature)) = by_distance.min()
                && f64::from(distance) <= ALIKE_BITS * search.bits_factor
            {
                is_taken[feature] = true;
                found.push(Found { point: place, feature, distance });
            }
        }
        found
    }
}

/// Predicts the octave in which a camera at `centre`, in the candidate's frame, sees a point. None if it is too near,
/// too far, or sees it from another side.
fn predicted_octave(point: &WindowPoint, centre: &Point3) -> Option<u8> {
    let (now, first) = (point.in_candidate - centre, point.in_candidate - point.first_seen_from);
    let (now_m, first_m) = (now.norm(), first.norm());
    let farthest_m = first_m * OCTAVE_FACTOR.powi(i32::from(point.octave));
    let nearest_m = farthest_m / OCTAVE_FACTOR.powf(OCTAVES - 1.0);
    if !(NEAREST_FACTOR * nearest_m..=FARTHEST_FACTOR * farthest_m).contains(&now_m)
        || now.dot(&first) < VIEW_COSINE * now_m * first_m
    {
        return None;
    }
    let octave = ((farthest_m / now_m).ln() / OCTAVE_FACTOR.ln()).ceil();
    Some(octave.clamp(0.0, OCTAVES - 1.0) as u8)
}
