//! Twins: one view in two places (M16).
//!
//! Two floors that look alike give a verified transformation for a loop that is none. Where signs tell the two apart, the
//! building has shown that geometry alone proves nothing in it. That is found when a keyframe arrives or a sign is
//! described, and kept: nothing runs geometry at load.

use std::ops::Range;

use super::contradiction::Contradiction;
use super::distinctiveness::PlaceCounts;
use crate::domain::bow::BowVector;
use crate::domain::change::{Change, Twins};
use crate::domain::channel::Channel;
use crate::domain::ids::{AnchorSeq, KeyframeSeq};
use crate::domain::settings::WithoutAnchors;
use crate::domain::verdict::{CandidateDecision, GeometryStatus, ReasonCode, Verify};
use crate::recognition::loops::anchor_map::{LocalAnchor, LocalAnchorMap, local_anchor_map};
use crate::recognition::loops::candidates::find_candidates;
use crate::recognition::loops::centre::Centre;
use crate::recognition::loops::comparison::compare;
use crate::recognition::loops::evidence;
use crate::recognition::loops::features::FeatureSet;
use crate::recognition::loops::geometry_check::{Comparisons, PlacedQuery, check_geometry};
use crate::recognition::loops::geometry_snapshot::GeometrySnapshot;
use crate::recognition::loops::query::Query;
use crate::recognition::loops::screening::{PreVerified, Screening, Stage};
use crate::recognition::loops::wanted_features::WantedFeatures;
use crate::recognition::map::index::{Certainty, MapIndex};
use crate::recognition::map::recorder::{Decided, Recorder};

/// Pairs of a map that are kept: one is enough, and the next stands in where its signs change.
pub const KEPT_MAX: usize = 8;

/// Inliers without map points from which two views are alike: a homography, a rotation or an essential matrix.
pub(in crate::recognition) const ALONE_MIN_INLIERS: u32 = 100;

/// The seed of the verification, whatever the seeds of queries.
const SEED: u64 = 0;

/// Candidates that the anchors contradict, at most one of each place, by bag-of-words score.
#[derive(Clone, Debug)]
pub struct Suspects {
    keyframe: KeyframeSeq,
    screening: Screening,
    /// Of each candidate, the two signs that contradict.
    signs: Vec<(AnchorSeq, AnchorSeq)>,
}

/// Whether views may close loops in a map, and not enough twins are known already.
pub fn are_looked_for(index: &MapIndex) -> bool {
    let settings = &index.properties().settings;
    let matters = settings.is_ours() && settings.without_anchors == WithoutAnchors::Geometry;
    matters && index.twins().count() < KEPT_MAX
}

/// Finds what the view from a keyframe of the map may be a twin of; `None` if there is nothing to look at.
pub fn suspects(index: &MapIndex, keyframe: KeyframeSeq, bow: &BowVector) -> Option<Suspects> {
    if !are_looked_for(index) {
        return None;
    }
    let query = &Query::stored(index, keyframe, bow)?;
    if query.snapshot.is_none() || !query.seen.iter().any(|root| names_itself(index, *root)) {
        return None;
    }
    let mut places = PlaceCounts::default();
    let around = local_anchor_map(index, &query.centre, &mut places);
    let proposals = find_candidates(index, query, &mut places);
    let (mut candidates, mut signs) = (Vec::new(), Vec::new());
    for proposal in proposals.candidates.iter().filter(|proposal| proposal.is_by(Channel::Bow)) {
        let of_place =
            [(proposal.keyframe, proposal.score)].into_iter().chain(proposal.neighbours.iter().copied());
        let contradicted = of_place.into_iter().find_map(|(candidate, score)| {
            let centre = Centre::stored(index, candidate)?;
            let theirs = local_anchor_map(index, &centre, &mut places);
            let (own, other) = known_contradiction(&around, &theirs, index)?;
            Some((candidate, score, own.name.object()?, other.name.object()?))
        });
        let Some((candidate, score, own, other)) = contradicted else { continue };
        let Some(snapshot) = GeometrySnapshot::stored(index, candidate) else { continue };
        let Some(unchecked) = evidence::unchecked(index, candidate, score, proposals.reference_score) else {
            continue;
        };
        let reason = evidence::reason(ReasonCode::Contradiction, 0.0, 0.0);
        let mut pre_verified =
            PreVerified::stopped(candidate, unchecked, CandidateDecision::Rejected, reason);
        // By the numbers that would have let geometry alone close the loop.
        (pre_verified.stage, pre_verified.snapshot) = (Stage::AskGeometry, Some(snapshot));
        candidates.push(pre_verified);
        signs.push((own, other));
    }
    if candidates.is_empty() {
        return None;
    }
    let screening = Screening::of_candidates(index, 0, query, Verify::Geometry, candidates);
    Some(Suspects { keyframe, screening, signs })
}

/// Returns the heaviest pair of different identifiers, each read alike twice or described, that stand at the same relative
/// place around two keyframes, if such pairs outweigh what agrees.
fn known_contradiction<'a>(
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

/// Whether an object has an identifier that was read alike twice, or described.
fn names_itself(index: &MapIndex, root: AnchorSeq) -> bool {
    let described = index.objects().get(root).and_then(|object| object.description.as_ref());
    described
        .is_some_and(|description| description.certainty > Certainty::ReadOnce && description.text.has_name())
}

impl Suspects {
    /// Returns the places of all in the list, the likest first.
    pub fn places(&self) -> Range<usize> {
        0..self.signs.len()
    }

    /// Returns the keyframes whose features geometry needs for one of them, ascending; the written one is among them.
    pub fn wanted_features(&self, at: usize) -> WantedFeatures {
        let candidate = &self.screening.candidates[at];
        let mut wanted = WantedFeatures::default();
        wanted.add(candidate.keyframe, candidate.snapshot.as_ref());
        wanted.add_alone(self.keyframe, self.screening.snapshot.as_ref());
        wanted
    }

    /// Runs geometry on one of them. Returns the pair if it would have closed a loop by itself.
    pub fn verify(&self, at: usize, features: &FeatureSet) -> Option<Twins> {
        let of_query = features.stored.get(&self.keyframe).map(AsRef::as_ref);
        let comparisons = Comparisons::default();
        let seeing = self.screening.snapshot.as_ref().zip(of_query);
        let asked = seeing.map(|seeing| PlacedQuery::new(seeing, &comparisons));
        let pre_verified = &self.screening.candidates[at];
        let found =
            check_geometry(&self.screening, pre_verified, asked.as_ref(), features, SEED).ok()?.verification;
        let is_alike = found.status == GeometryStatus::Verified
            && (found.model.is_metric() || found.inliers >= ALONE_MIN_INLIERS);
        let (anchor, candidate_anchor) = self.signs[at];
        is_alike.then_some(Twins {
            keyframe: self.keyframe,
            candidate: pre_verified.keyframe,
            anchor,
            candidate_anchor,
        })
    }
}

/// Keeps a found pair, unless it is none any more: the map went on while geometry looked. Pairs that are none any more make
/// room for it.
pub fn keep(index: &mut MapIndex, twins: Twins) -> Option<Decided> {
    if !are_looked_for(index) || !index.are_twins(&twins) {
        return None;
    }
    let gone = index.kept_twins().filter(|kept| !index.are_twins(kept)).copied();
    let changes = gone.map(Change::TwinsWithdrawn).chain([Change::TwinsFound(twins)]).collect();
    let mut record = Recorder::new(index);
    record.apply(changes);
    Some(record.finish())
}
