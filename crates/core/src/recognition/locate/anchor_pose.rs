//! Poses from anchors alone: where must the camera be, for the anchors that it sees to hang where the map has them?
//!
//! Three anchors that are not on a line fix a pose. Two fix it if the vertical is known on both sides; without that, only
//! under the assumption that both cameras are equally upright. One anchor fixes none. Every pair of sighted anchors that lie
//! as far from each other as their anchors of the map gives a hypothesis; the one that most distinctive texts agree with
//! stands, refined on all that agree.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Vector3;

use super::pose::{sighting_sigma_m, uncertainty};
use super::sighted_anchor::{AnchorPair, SightedAnchor};
use crate::domain::ids::{AnchorSeq, SessionSeq};
use crate::domain::location::{Assumption, LocatedPose, PoseSource};
use crate::geometry::absolute_orientation::{Scale, align};
use crate::geometry::upright_alignment::align_upright;
use crate::geometry::{Point3, Pose};

/// An anchor agrees with a pose that puts it within this many standard deviations of its place.
pub(in crate::recognition) const AGREES_WITHIN_SIGMAS: f64 = 3.0;
/// Three anchors are not on a line if the smallest is this far from the line through the others, in metres.
pub(in crate::recognition) const OFF_LINE_MIN_M: f64 = 0.5;
/// Poses of one session that are kept: the best, and the best that is elsewhere.
const KEPT_PER_SESSION: usize = 2;

/// The direction of gravity on both sides.
#[derive(Clone, Copy, Debug)]
pub struct Verticals {
    /// In the first keyframe's camera frame.
    pub down_in_camera: Vector3<f64>,
    /// In the session's frame.
    pub down_in_session: Vector3<f64>,
    /// Whether either is assumed.
    pub is_assumed: bool,
}

/// A pose from anchors.
#[derive(Clone, Debug)]
pub struct AnchorPose {
    /// The session in whose frame it is.
    pub session: SessionSeq,
    /// The pose of the first keyframe's camera.
    pub pose: LocatedPose,
    /// The objects of the map that agree, by sighted anchor.
    pub objects: BTreeMap<usize, AnchorSeq>,
    /// The identifiers among them that hang in one place only.
    pub identifiers: BTreeSet<String>,
}

impl AnchorPose {
    /// Orders poses: the most distinctive identifiers, then the most anchors, then the least uncertainty.
    fn is_better_than(&self, other: &Self) -> bool {
        let figures = |pose: &Self| (pose.identifiers.len(), pose.objects.len());
        figures(self) > figures(other)
            || figures(self) == figures(other)
                && self.pose.uncertainty.translation_m < other.pose.uncertainty.translation_m
    }
}

/// Returns the best poses in one session's frame that at least two sighted anchors agree with, one identifier that hangs in
/// one place only among them; the best first, each farther than `apart_m` from those before it.
pub fn anchor_poses(
    session: SessionSeq,
    sighted: &[SightedAnchor],
    pairs: &[AnchorPair],
    verticals: &Verticals,
    apart_m: f64,
) -> Vec<AnchorPose> {
    let mut found: Vec<AnchorPose> = Vec::new();
    for (at, first) in pairs.iter().enumerate() {
        for second in &pairs[at + 1..] {
            if !is_as_far_apart(sighted, first, second) {
                continue;
            }
            let seed = seed(sighted, [first, second], verticals);
            if let Some(pose) = seed.and_then(|seed| agreed(session, sighted, pairs, verticals, &seed)) {
                found.push(pose);
            }
        }
    }
    let mut kept: Vec<AnchorPose> = Vec::new();
    while kept.len() < KEPT_PER_SESSION {
        let centre = |pose: &AnchorPose| pose.pose.map_from_camera.centre();
        let is_elsewhere =
            |pose: &&AnchorPose| kept.iter().all(|known| (centre(pose) - centre(known)).norm() > apart_m);
        let best = found.iter().filter(is_elsewhere);
        let Some(best) = best.reduce(|best, other| if other.is_better_than(best) { other } else { best })
        else {
            break;
        };
        kept.push(best.clone());
    }
    kept
}

/// Whether two sighted anchors lie as far from each other as the anchors of the map, and far enough to tell a direction.
fn is_as_far_apart(sighted: &[SightedAnchor], first: &AnchorPair, second: &AnchorPair) -> bool {
    if first.sighted == second.sighted || first.object == second.object {
        return false;
    }
    let (a, b) = (&sighted[first.sighted].centre, &sighted[second.sighted].centre);
    let own_m = (a - b).norm();
    let of_map_m = (first.centre_in_session - second.centre_in_session).norm();
    let sigma_m = libm::hypot(sighting_sigma_m(a), sighting_sigma_m(b));
    (own_m - of_map_m).abs() <= AGREES_WITHIN_SIGMAS * sigma_m
}

/// Returns the upright pose that two pairs give.
fn seed(sighted: &[SightedAnchor], pairs: [&AnchorPair; 2], verticals: &Verticals) -> Option<Pose> {
    let points = pairs.map(|pair| (sighted[pair.sighted].centre, pair.centre_in_session));
    align_upright(&points, &verticals.down_in_camera, &verticals.down_in_session)
}

/// Returns the pose refined on all anchors that agree with a first one.
fn agreed(
    session: SessionSeq,
    sighted: &[SightedAnchor],
    pairs: &[AnchorPair],
    verticals: &Verticals,
    seed: &Pose,
) -> Option<AnchorPose> {
    let agreeing = agreeing_pairs(sighted, pairs, seed);
    let points: Vec<(Point3, Point3)> =
        agreeing.values().map(|pair| (sighted[pair.sighted].centre, pair.centre_in_session)).collect();
    let identifiers: BTreeSet<String> =
        agreeing.values().filter_map(|pair| pair.identifier.clone()).collect();
    if points.len() < 2 || identifiers.is_empty() {
        return None;
    }
    let is_free = verticals.is_assumed && !are_on_a_line(&points);
    let free = || align(&points, Scale::Fixed).ok().map(|found| found.without_scale());
    let upright = || align_upright(&points, &verticals.down_in_camera, &verticals.down_in_session);
    let free = is_free.then(free).flatten();
    let map_from_camera = free.or_else(upright)?;
    let has_free_rotation = free.is_some();
    let assumed =
        if verticals.is_assumed && !has_free_rotation { vec![Assumption::Upright] } else { Vec::new() };
    let uncertainty = uncertainty(&points, &map_from_camera, &assumed, has_free_rotation);
    Some(AnchorPose {
        session,
        pose: LocatedPose { map_from_camera, uncertainty, source: PoseSource::Anchors, assumed },
        objects: agreeing.into_iter().map(|(sighted, pair)| (sighted, pair.object)).collect(),
        identifiers,
    })
}

/// Returns the nearest agreeing pair of each sighted anchor; no object twice.
fn agreeing_pairs<'p>(
    sighted: &[SightedAnchor],
    pairs: &'p [AnchorPair],
    pose: &Pose,
) -> BTreeMap<usize, &'p AnchorPair> {
    let mut within: Vec<(f64, &AnchorPair)> = pairs
        .iter()
        .filter_map(|pair| {
            let own = &sighted[pair.sighted].centre;
            let sigmas = (pose.transform(own) - pair.centre_in_session).norm() / sighting_sigma_m(own);
            (sigmas <= AGREES_WITHIN_SIGMAS).then_some((sigmas, pair))
        })
        .collect();
    within.sort_by(|(a, first), (b, second)| {
        a.total_cmp(b).then_with(|| (first.sighted, first.object).cmp(&(second.sighted, second.object)))
    });
    let mut agreeing: BTreeMap<usize, &AnchorPair> = BTreeMap::new();
    let mut taken: BTreeSet<AnchorSeq> = BTreeSet::new();
    for (_, pair) in within {
        if !agreeing.contains_key(&pair.sighted) && taken.insert(pair.object) {
            agreeing.insert(pair.sighted, pair);
        }
    }
    agreeing
}

/// Whether positions leave the turn about their own line open.
fn are_on_a_line(points: &[(Point3, Point3)]) -> bool {
    let Some((first, _)) = points.first() else { return true };
    let offsets = || points.iter().map(|(own, _)| own - first);
    let longest = offsets().fold(Vector3::zeros(), |best: Vector3<f64>, offset| {
        if offset.norm_squared() > best.norm_squared() { offset } else { best }
    });
    let Some(direction) = longest.try_normalize(1e-9) else { return true };
    let off_line = offsets().map(|offset| (offset - direction * direction.dot(&offset)).norm());
    off_line.fold(0.0, f64::max) < OFF_LINE_MIN_M
}
