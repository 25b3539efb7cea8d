//! With a transformation in hand, more matches: points projected into the other image, descriptors compared nearby.

use nalgebra::Vector3;

use super::correspondence::{Correspondence, Hypothesis, Map, Reprojection};
use super::limits::Limits;
use super::projection_search::{Found, IndexedImage, ProjectionSearch, Wanted};
use super::view::{Landmark, View};
use crate::geometry::instruction_set::dispatch;
use crate::geometry::pinhole::Pinhole;

/// What a feature of the query is matched with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Target {
    /// A feature of the candidate.
    Feature(u32),
    /// A landmark of the window, by the rank of its id.
    Landmark(u32),
}

/// A match found by projection, to be compared with the others.
#[derive(Clone, Copy, Debug)]
struct Proposal {
    distance: u32,
    query: u32,
    target: Target,
    /// The place of the landmark in the window; 0 for a feature.
    place: u32,
}

impl Proposal {
    /// Returns what proposals are ordered by: the nearest descriptors first, then the smaller feature of the query, then
    /// features before landmarks.
    fn order(&self) -> (u64, Target, u32) {
        (u64::from(self.distance) << 32 | u64::from(self.query), self.target, self.place)
    }
}

/// The two keyframes and the window, indexed by place in the image.
pub struct GuidedSearch<'a> {
    query: &'a View<'a>,
    candidate: &'a View<'a>,
    window: &'a [Landmark<'a>],
    limits: &'a Limits,
    query_image: IndexedImage<'a>,
    candidate_image: IndexedImage<'a>,
    query_points: Vec<Wanted<'a>>,
    candidate_points: Vec<Wanted<'a>>,
    window_points: Vec<Wanted<'a>>,
    /// The rank of each landmark's id among all ids of the window.
    ranks: Vec<u32>,
}

impl<'a> GuidedSearch<'a> {
    /// Indexes the keypoints of the two images.
    pub fn new(
        query: &'a View<'a>,
        candidate: &'a View<'a>,
        window: &'a [Landmark<'a>],
        limits: &'a Limits,
    ) -> Self {
        let landmark = |(place, landmark): (u32, &Landmark<'a>)| Wanted {
            place,
            point: landmark.point_in_camera.coords,
            descriptor: landmark.descriptor,
        };
        Self {
            query,
            candidate,
            window,
            limits,
            query_image: IndexedImage::new(query),
            candidate_image: IndexedImage::new(candidate),
            query_points: located(query),
            candidate_points: located(candidate),
            window_points: (0..).zip(window).map(landmark).collect(),
            ranks: ranks(window),
        }
    }

    /// Returns the pairs at the places `kept` of `matched`, which ascend by the query's feature, and those that projection
    /// and descriptors add to them, ascending by the query's feature. Each feature and each landmark is in one pair at most;
    /// the nearest descriptors choose first, ties by the smaller feature.
    pub fn search(
        &self,
        hypothesis: &Hypothesis,
        matched: &[Correspondence],
        kept: &[u32],
    ) -> Vec<Correspondence> {
        let mut query_taken = vec![false; self.query.keypoints.len()];
        let mut candidate_taken = vec![false; self.candidate.keypoints.len()];
        let mut landmark_taken = vec![false; self.ranks.len()];
        for pair in kept.iter().map(|&place| &matched[place as usize]) {
            query_taken[pair.query_feature as usize] = true;
            if let Some(feature) = pair.candidate_feature {
                candidate_taken[feature as usize] = true;
            }
        }
        let mut added = self.proposals(hypothesis);
        added.sort_unstable_by_key(Proposal::order);
        added.retain(|proposal| {
            let target_taken = match proposal.target {
                Target::Feature(feature) => &mut candidate_taken[feature as usize],
                Target::Landmark(rank) => &mut landmark_taken[rank as usize],
            };
            let query_taken = &mut query_taken[proposal.query as usize];
            let is_free = !*query_taken && !*target_taken;
            *target_taken |= is_free;
            *query_taken |= is_free;
            is_free
        });
        added.sort_unstable_by_key(|proposal| proposal.query);
        let mut added = added.iter().peekable();
        let mut pairs = Vec::with_capacity(kept.len() + added.len());
        for pair in kept.iter().map(|&place| &matched[place as usize]) {
            while let Some(before) = added.next_if(|proposal| proposal.query < pair.query_feature) {
                pairs.push(self.correspondence(before));
            }
            pairs.push(*pair);
        }
        pairs.extend(added.map(|proposal| self.correspondence(proposal)));
        pairs
    }

    /// Returns what projection and descriptors propose: points of either side in the image of the other.
    fn proposals(&self, hypothesis: &Hypothesis) -> Vec<Proposal> {
        let (into_query, into_candidate) =
            (&hypothesis.query_from_candidate, &hypothesis.candidate_from_query);
        let features = self.look_for(&self.candidate_points, into_query, &self.query_image);
        let landmarks = self.look_for(&self.window_points, into_query, &self.query_image);
        let back = self.look_for(&self.query_points, into_candidate, &self.candidate_image);
        let features = features.iter().map(|it| (it, it.feature, Target::Feature(it.place), 0));
        let landmarks = landmarks
            .iter()
            .map(|it| (it, it.feature, Target::Landmark(self.ranks[it.place as usize]), it.place));
        let back = back.iter().map(|it| (it, it.place, Target::Feature(it.feature), 0));
        let all = features.chain(landmarks).chain(back);
        all.map(|(it, query, target, place)| Proposal { distance: it.distance, query, target, place })
            .collect()
    }

    fn look_for(&self, wanted: &[Wanted], map: &Map, image: &IndexedImage) -> Vec<Found> {
        let max_distance = self.limits.guided.max_distance * f64::from(image.descriptor_bits());
        let radius_px = self.limits.guided.radius * self.limits.variance_px2(0).sqrt();
        dispatch(ProjectionSearch { image, map, wanted, radius_px, max_distance })
    }

    fn correspondence(&self, proposal: &Proposal) -> Correspondence {
        let in_query = self.query.points_in_camera[proposal.query as usize].map(|point| point.coords);
        let (in_candidate, candidate_feature, seen) = match proposal.target {
            Target::Feature(feature) => {
                let point = self.candidate.points_in_camera[feature as usize].map(|point| point.coords);
                (point, Some(feature), Some(sighting(self.candidate, feature, self.limits)))
            }
            Target::Landmark(_) => {
                let point = self.window[proposal.place as usize].point_in_camera.coords;
                (Some(point), None, virtual_sighting(&point, &self.candidate.pinhole(), self.limits))
            }
        };
        let depth_of = |point: Option<Vector3<f64>>| point.and_then(|point| self.limits.depth(point.z));
        let reprojection =
            |point, (pixel, inverse_variance), depth| Reprojection { point, pixel, inverse_variance, depth };
        let seen_by_query = sighting(self.query, proposal.query, self.limits);
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
pub(super) fn sighting(view: &View, feature: u32, limits: &Limits) -> Sighting {
    (view.pixel(feature), limits.variance_px2(view.keypoints[feature as usize].octave).recip())
}

/// Where the candidate's image would show a landmark that only its neighbours saw; `None` behind the camera.
fn virtual_sighting(point: &Vector3<f64>, camera: &Pinhole, limits: &Limits) -> Option<Sighting> {
    Some((camera.project(point)?, limits.variance_px2(0).recip()))
}

/// Returns the features that have a position.
fn located<'a>(view: &View<'a>) -> Vec<Wanted<'a>> {
    let points = (0..).zip(view.points_in_camera);
    points
        .filter_map(|(place, point)| {
            let point = (*point)?.coords;
            Some(Wanted { place, point, descriptor: view.descriptors.get(place as usize) })
        })
        .collect()
}

/// Returns the rank of each landmark's id: equal ids have one rank.
fn ranks(window: &[Landmark]) -> Vec<u32> {
    let mut ids: Vec<u64> = window.iter().map(|landmark| landmark.id).collect();
    ids.sort_unstable();
    ids.dedup();
    window.iter().map(|landmark| ids.partition_point(|id| *id < landmark.id) as u32).collect()
}
