//! With a transformation in hand, more matches: points projected into the other image, descriptors compared nearby.

use std::collections::HashSet;

use nalgebra::Vector3;

use super::correspondence::{Correspondence, Hypothesis, Reprojection};
use super::keypoint_grid::KeypointGrid;
use super::limits::Limits;
use super::view::{Landmark, View};
use crate::geometry::hamming::distance;
use crate::geometry::pinhole::Pinhole;

/// What a feature of the query is matched with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
enum Target {
    /// A feature of the candidate.
    Feature(u32),
    /// A landmark of the window, by its id.
    Landmark(u64),
}

/// A match found by projection, to be compared with the others.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Proposal {
    distance: u32,
    query: u32,
    target: Target,
    /// The place of the landmark in the window; 0 for a feature.
    place: u32,
}

/// The two keyframes and the window, indexed by place in the image.
pub struct GuidedSearch<'a> {
    query: &'a View<'a>,
    candidate: &'a View<'a>,
    window: &'a [Landmark<'a>],
    limits: &'a Limits,
    query_grid: KeypointGrid,
    candidate_grid: KeypointGrid,
}

impl<'a> GuidedSearch<'a> {
    /// Indexes the keypoints of the two images.
    pub fn new(
        query: &'a View<'a>,
        candidate: &'a View<'a>,
        window: &'a [Landmark<'a>],
        limits: &'a Limits,
    ) -> Self {
        let query_grid = KeypointGrid::new(query.keypoints, &query.camera);
        let candidate_grid = KeypointGrid::new(candidate.keypoints, &candidate.camera);
        Self { query, candidate, window, limits, query_grid, candidate_grid }
    }

    /// Returns the pairs in `kept`, and those that projection and descriptors add to them, ascending by the query's
    /// feature. Each feature and each landmark is in one pair at most; the nearest descriptors choose first, ties by
    /// the smaller feature.
    pub fn search(&self, hypothesis: &Hypothesis, kept: Vec<Correspondence>) -> Vec<Correspondence> {
        let mut proposals = Vec::new();
        self.project_candidate_features(hypothesis, &mut proposals);
        self.project_landmarks(hypothesis, &mut proposals);
        self.project_query_features(hypothesis, &mut proposals);
        proposals.sort_unstable();
        let mut taken_of_query = vec![false; self.query.keypoints.len()];
        let mut taken: HashSet<Target> = HashSet::new();
        for pair in &kept {
            taken_of_query[pair.query_feature as usize] = true;
            taken.extend(pair.candidate_feature.map(Target::Feature));
        }
        let mut pairs = kept;
        for proposal in &proposals {
            let is_taken = &mut taken_of_query[proposal.query as usize];
            if !*is_taken && taken.insert(proposal.target) {
                *is_taken = true;
                pairs.push(self.correspondence(proposal));
            }
        }
        pairs.sort_by_key(|pair| pair.query_feature);
        pairs
    }

    fn project_candidate_features(&self, hypothesis: &Hypothesis, proposals: &mut Vec<Proposal>) {
        for (feature, point) in located(self.candidate) {
            let descriptor = self.candidate.descriptors.get(feature as usize);
            let found = self.nearest_query_feature(&hypothesis.in_query(&point), descriptor);
            let target = Target::Feature(feature);
            proposals.extend(found.map(|(distance, query)| Proposal { distance, query, target, place: 0 }));
        }
    }

    fn project_landmarks(&self, hypothesis: &Hypothesis, proposals: &mut Vec<Proposal>) {
        for (place, landmark) in self.window.iter().enumerate() {
            let point = landmark.point_in_camera.coords;
            let found = self.nearest_query_feature(&hypothesis.in_query(&point), landmark.descriptor);
            let (target, place) = (Target::Landmark(landmark.id), place as u32);
            proposals.extend(found.map(|(distance, query)| Proposal { distance, query, target, place }));
        }
    }

    fn project_query_features(&self, hypothesis: &Hypothesis, proposals: &mut Vec<Proposal>) {
        for (query, point) in located(self.query) {
            let descriptor = self.query.descriptors.get(query as usize);
            let projected = self.candidate.pinhole().project(&hypothesis.in_candidate(&point));
            let found = projected
                .and_then(|pixel| self.nearest(pixel, descriptor, self.candidate, &self.candidate_grid));
            proposals.extend(found.map(|(distance, feature)| Proposal {
                distance,
                query,
                target: Target::Feature(feature),
                place: 0,
            }));
        }
    }

    fn nearest_query_feature(&self, point_in_query: &Vector3<f64>, descriptor: &[u64]) -> Option<(u32, u32)> {
        let pixel = self.query.pinhole().project(point_in_query)?;
        self.nearest(pixel, descriptor, self.query, &self.query_grid)
    }

    /// Returns the feature around a pixel whose descriptor is nearest, and its distance.
    fn nearest(
        &self,
        pixel: [f64; 2],
        descriptor: &[u64],
        view: &View,
        grid: &KeypointGrid,
    ) -> Option<(u32, u32)> {
        let max_distance = self.limits.guided.max_distance * f64::from(view.descriptors.bits());
        let radius_px = self.limits.guided.radius * self.limits.variance_px2(0).sqrt();
        grid.around(pixel, radius_px)
            .map(|feature| (distance(descriptor, view.descriptors.get(feature as usize)), feature))
            .filter(|&(distance, _)| f64::from(distance) <= max_distance)
            .min()
    }

    fn correspondence(&self, proposal: &Proposal) -> Correspondence {
        let query = proposal.query as usize;
        let in_query = self.query.points_in_camera[query].map(|point| point.coords);
        let (in_candidate, candidate_feature, seen) = match proposal.target {
            Target::Feature(feature) => {
                let point = self.candidate.points_in_camera[feature as usize].map(|point| point.coords);
                (point, Some(feature), Some(sighting(self.candidate, feature as usize, self.limits)))
            }
            Target::Landmark(_) => {
                let point = self.window[proposal.place as usize].point_in_camera.coords;
                (Some(point), None, virtual_sighting(&point, &self.candidate.pinhole(), self.limits))
            }
        };
        let depth_of = |point: Option<Vector3<f64>>| point.and_then(|point| self.limits.depth(point.z));
        let reprojection =
            |point, (pixel, inverse_variance), depth| Reprojection { point, pixel, inverse_variance, depth };
        let seen_by_query = sighting(self.query, query, self.limits);
        Correspondence {
            into_query: in_candidate.map(|point| reprojection(point, seen_by_query, depth_of(in_query))),
            into_candidate: in_query
                .zip(seen)
                .map(|(point, seen)| reprojection(point, seen, depth_of(in_candidate))),
            distance: proposal.distance,
            query_feature: proposal.query,
            candidate_feature,
        }
    }
}

/// A pixel and its inverse variance.
type Sighting = ([f64; 2], f64);

/// Where an image shows a feature.
pub(super) fn sighting(view: &View, feature: usize, limits: &Limits) -> Sighting {
    let keypoint = &view.keypoints[feature];
    ([keypoint.u, keypoint.v], limits.variance_px2(keypoint.octave).recip())
}

/// Where the candidate's image would show a landmark that only its neighbours saw; `None` behind the camera.
fn virtual_sighting(point: &Vector3<f64>, camera: &Pinhole, limits: &Limits) -> Option<Sighting> {
    Some((camera.project(point)?, limits.variance_px2(0).recip()))
}

/// Returns the features that have a position, with it.
fn located<'a>(view: &'a View) -> impl Iterator<Item = (u32, Vector3<f64>)> + 'a {
    let points = view.points_in_camera.iter().enumerate();
    points.filter_map(|(feature, point)| Some((feature as u32, (*point)?.coords)))
}
