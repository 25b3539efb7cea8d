//! Rivals: geometry proves a view, not a place (M19).
//!
//! In a building that repeats itself sixty inliers are found on the wrong floor. So a candidate that geometry alone speaks
//! for is a loop only if the best candidate that is *known to be another place* looks much less like the query. Known to be
//! another place is one that odometry has elsewhere, or around which sure-enough identifiers differ.

use super::contradiction::Contradiction;
use super::distinctiveness::PlaceCounts;
use super::tracked_path::{TrackedPath, drift_m};
use crate::domain::ids::{KeyframeSeq, SessionSeq};
use crate::domain::settings::Settings;
use crate::domain::verdict::{Candidate, CandidateDecision};
use crate::geometry::Point3;
use crate::recognition::loops::anchor_map::{LocalAnchor, LocalAnchorMap, local_anchor_map};
use crate::recognition::loops::centre::Centre;
use crate::recognition::loops::comparison::compare;
use crate::recognition::loops::evidence;
use crate::recognition::loops::geometry_snapshot::GeometrySnapshot;
use crate::recognition::loops::screening::{CandidateStage, PreVerified};
use crate::recognition::map::index::{Certainty, MapIndex};

/// Whether nothing but geometry can make it a loop: no anchor that bears an identifier matches.
fn needs_geometry_alone(pre_verified: &PreVerified) -> bool {
    matches!(
        pre_verified.stage,
        CandidateStage::AskGeometry
            | CandidateStage::NeedsWitness
            | CandidateStage::TrackedOnly { has_witness: false }
    )
}

/// Notes the rivals of each candidate that geometry alone may make a loop, and has geometry look at them, too.
pub fn find_rivals(index: &MapIndex, candidates: &mut [PreVerified], places: &mut PlaceCounts) {
    if index.properties().settings.rival_min_ratio <= 0.0 || !candidates.iter().any(needs_geometry_alone) {
        return;
    }
    let found: Vec<Place> =
        candidates.iter().map(|candidate| Place::of(index, candidate.keyframe, places)).collect();
    for at in 0..candidates.len() {
        if !needs_geometry_alone(&candidates[at]) {
            continue;
        }
        for rival in (0..candidates.len()).filter(|other| *other != at) {
            if found[at].is_other_than(&found[rival], index) {
                candidates[at].rivalry.rivals.push(found[rival].keyframe);
                candidates[rival].rivalry.is_rival = true;
            }
        }
    }
    for rival in candidates.iter_mut().filter(|candidate| candidate.rivalry.is_rival) {
        if rival.snapshot.is_none() {
            rival.snapshot = GeometrySnapshot::stored(index, rival.keyframe);
        }
    }
}

/// A candidate's keyframe, and what stands around it.
struct Place {
    keyframe: KeyframeSeq,
    around: Option<LocalAnchorMap>,
}

impl Place {
    fn of(index: &MapIndex, keyframe: KeyframeSeq, places: &mut PlaceCounts) -> Self {
        let centre = Centre::stored(index, keyframe);
        Self { keyframe, around: centre.map(|centre| local_anchor_map(index, &centre, places)) }
    }

    /// Whether two keyframes are known to see different places.
    fn is_other_than(&self, other: &Self, index: &MapIndex) -> bool {
        odometry_has_apart(index, self.keyframe, other.keyframe) || self.is_contradicted_by(other, index)
    }

    fn is_contradicted_by(&self, other: &Self, index: &MapIndex) -> bool {
        let around = self.around.as_ref().zip(other.around.as_ref());
        around.is_some_and(|(own, other)| known_contradiction(own, other, index).is_some())
    }
}

/// Returns the heaviest pair of different identifiers, each read alike twice or described, that stand at the same relative
/// place around two keyframes, if such pairs outweigh what agrees.
pub(in crate::recognition) fn known_contradiction<'a>(
    own: &'a LocalAnchorMap,
    other: &'a LocalAnchorMap,
    index: &MapIndex,
) -> Option<(&'a LocalAnchor, &'a LocalAnchor)> {
    let comparison = compare(own, other, index, &index.properties().settings);
    let is_known = |anchor: &LocalAnchor| anchor.certainty > Certainty::ReadOnce;
    let known =
        || comparison.contradictions.iter().filter(|pair| is_known(pair.query) && is_known(pair.candidate));
    let weight = known().fold(0.0, |sum, pair| sum + pair.weight());
    if weight <= comparison.agreement() {
        return None;
    }
    let names = |pair: &Contradiction<'_>| (pair.query.name, pair.candidate.name);
    let heaviest =
        known().max_by(|a, b| a.weight().total_cmp(&b.weight()).then_with(|| names(b).cmp(&names(a))));
    heaviest.map(|pair| (pair.query, pair.candidate))
}

/// Whether the two are farther apart than odometry can be wrong on the way between them, and than one place is wide.
fn odometry_has_apart(index: &MapIndex, a: KeyframeSeq, b: KeyframeSeq) -> bool {
    let settings = &index.properties().settings;
    let centre = |keyframe| index.keyframe(keyframe).map(|keyframe| keyframe.map_from_camera.centre());
    let (Some(path), Some((a, b))) = (TrackedPath::between(index, a, b), centre(a).zip(centre(b))) else {
        return false;
    };
    let drifted_m = drift_m(path.length_m, settings.odometry_slack_m, settings);
    (a - b).norm() > drifted_m.max(settings.distinctive_place_radius_m)
}

/// A candidate after geometry.
#[derive(Clone, Debug)]
pub struct Concluded {
    /// With its verdict, but for rivals.
    pub candidate: Candidate,
    /// The outcome of geometry, if it ran.
    pub view: Option<Seen>,
}

/// The part of the query that geometry found in a candidate.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    /// The matches that one transformation explains.
    pub inliers: u32,
    /// The query's place in the candidate's session by that transformation, if the transformation has a length.
    pub query_in_session: Option<(SessionSeq, Point3)>,
}

impl Seen {
    /// Whether both put the query at one spot of one session: from there it sees them both.
    fn agrees_with(&self, other: &Self, settings: &Settings) -> bool {
        let both = self.query_in_session.zip(other.query_in_session);
        both.is_some_and(|(a, b)| a.0 == b.0 && (a.1 - b.1).norm() <= settings.odometry_slack_m)
    }
}

/// Leaves undecided what geometry alone cannot tell from a rival, and the rival, if it would have been a loop the same way.
pub fn settle_rivals(pre_verified: &[PreVerified], concluded: &mut [Concluded], settings: &Settings) {
    let at = |keyframe| pre_verified.iter().position(|other| other.keyframe == keyframe);
    let mut ambiguous: Vec<(usize, u32, u32)> = Vec::new();
    for (own, candidate) in pre_verified.iter().enumerate() {
        let is_loop = concluded[own].candidate.decision == CandidateDecision::Loop;
        let Some(view) = concluded[own].view.filter(|_| is_loop) else { continue };
        let rivals = candidate.rivalry.rivals.iter().filter_map(|rival| at(*rival));
        let seen = rivals.filter_map(|rival| Some((rival, concluded[rival].view?)));
        let elsewhere = seen.filter(|(_, of_rival)| !view.agrees_with(of_rival, settings));
        let Some((rival, of_rival)) = elsewhere.max_by_key(|(_, of_rival)| of_rival.inliers) else {
            continue;
        };
        if f64::from(view.inliers) < settings.rival_min_ratio * f64::from(of_rival.inliers) {
            ambiguous.push((own, view.inliers, of_rival.inliers));
            if needs_geometry_alone(&pre_verified[rival]) {
                ambiguous.push((rival, of_rival.inliers, view.inliers));
            }
        }
    }
    for (at, inliers, of_rival) in ambiguous {
        let candidate = &mut concluded[at].candidate;
        if candidate.decision == CandidateDecision::Loop {
            candidate.decision = CandidateDecision::Undecided;
            candidate.reason = Some(evidence::ambiguous_places(inliers, of_rival, settings.rival_min_ratio));
        }
    }
}
