//! The last step of §V and the answer: geometry on what passed the anchors, the anchors under its transformation,
//! and the best of what is left.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::evidence;
use super::features::MatchableFeatures;
use super::screening::{Screened, Screening, Standing};
use super::sight::Sight;
use super::verification::essential::verify_essential;
use super::verification::{Limits, Model, Status, Verification, View, verify};
use crate::model::ids::KeyframeSeq;
use crate::model::verdict::{Candidate, CandidateDecision, Decision, ReasonCode, Verdict, Verify};

/// The features that were read for a query.
#[derive(Clone, Debug, Default)]
pub struct FeatureSet {
    /// The query's own, if it is not stored.
    pub inline: Option<Arc<MatchableFeatures>>,
    /// Those of the map's keyframes.
    pub stored: BTreeMap<KeyframeSeq, Arc<MatchableFeatures>>,
}

/// Concludes a query. Pure, and without the map: the same arguments give the same answer, on any thread.
pub fn conclude(screening: Screening, features: &FeatureSet, seed: u64) -> Verdict {
    let of_query = match screening.query {
        Some(seq) => features.stored.get(&seq),
        None => features.inline.as_ref(),
    };
    let asked = screening.sight.as_ref().zip(of_query.map(AsRef::as_ref));
    let mut candidates: Vec<Candidate> = (screening.candidates.iter())
        .map(|screened| conclude_candidate(&screening, screened, asked, features, seed))
        .collect();
    candidates.sort_by(evidence::best_first);
    answer(&screening, candidates)
}

fn conclude_candidate(
    screening: &Screening,
    screened: &Screened,
    asked: Option<(&Sight, &MatchableFeatures)>,
    features: &FeatureSet,
    seed: u64,
) -> Candidate {
    let mut candidate = screened.candidate.clone();
    if screened.standing == Standing::Stopped {
        return candidate;
    }
    let found = screened.sight.as_ref().zip(features.stored.get(&screened.keyframe).map(AsRef::as_ref));
    match run_geometry(screening, asked, found, features, seed) {
        Ok(verification) => {
            candidate.geometry = evidence::geometry(&verification);
            judge_geometry(screening, screened, &verification, &mut candidate);
            // A view without map points may be that of another floor.
            let is_witness = verification.model == Model::Sim3;
            if lacks_witness(screened.standing)
                && !is_witness
                && candidate.decision == CandidateDecision::Loop
            {
                candidate.decision = CandidateDecision::Undecided;
                candidate.reason = Some(evidence::no_witness());
            }
        }
        Err(missing) => {
            candidate.geometry = evidence::geometry_skipped(missing);
            let reason = match screened.standing {
                Standing::TrackedOnly { .. } => Some(evidence::tracked_only()),
                Standing::NeedsWitness => Some(evidence::no_witness()),
                _ => None,
            };
            if reason.is_some() {
                candidate.decision = CandidateDecision::Undecided;
                candidate.reason = reason;
            }
            if screening.verify == Verify::Geometry || screened.standing == Standing::AskGeometry {
                candidate.decision = CandidateDecision::Undecided;
                candidate.reason = Some(evidence::geometry_missing(missing));
            }
        }
    }
    candidate
}

/// Whether nothing but texts that need a witness agrees.
fn lacks_witness(standing: Standing) -> bool {
    matches!(standing, Standing::NeedsWitness | Standing::TrackedOnly { has_witness: false })
}

/// Runs geometry on one candidate, or tells what is missing for it.
fn run_geometry(
    screening: &Screening,
    asked: Option<(&Sight, &MatchableFeatures)>,
    found: Option<(&Sight, &MatchableFeatures)>,
    features: &FeatureSet,
    seed: u64,
) -> Result<Verification, &'static str> {
    if screening.verify == Verify::Anchors {
        return Err("the query asks for anchors alone");
    }
    let (query_sight, query) = asked.ok_or("the query has no features or no camera")?;
    let (candidate_sight, candidate) = found.ok_or("the candidate has no features or no camera")?;
    let limits = limits(screening);
    let query_points = query_sight.points_in_camera(query);
    let candidate_points = candidate_sight.points_in_camera(candidate);
    let min_matches = limits.min_matches as usize;
    if query.keypoints.len() < min_matches || candidate.keypoints.len() < min_matches {
        return Err("one of the two has fewer features than geometry_min_matches");
    }
    let triangulated = |points: &[Option<_>]| points.iter().flatten().count() >= min_matches;
    if !triangulated(&query_points) || !triangulated(&candidate_points) {
        // Monocular, before scale: directions alone can confirm the place.
        let query = view(query_sight, query, &query_points);
        let candidate = view(candidate_sight, candidate, &candidate_points);
        return Ok(verify_essential(&query, &candidate, &limits, seed));
    }
    let window: Vec<_> = (candidate_sight.window.iter())
        .filter_map(|seq| Some((*seq, features.stored.get(seq)?.as_ref())))
        .collect();
    let landmarks = candidate_sight.landmarks(candidate, &window, (query_sight, query));
    let query = view(query_sight, query, &query_points);
    let candidate = view(candidate_sight, candidate, &candidate_points);
    Ok(verify(&query, &candidate, &landmarks, &limits, seed))
}

fn limits(screening: &Screening) -> Limits {
    Limits {
        min_matches: screening.settings.geometry_min_matches,
        min_inliers: screening.settings.geometry_min_inliers,
        fixed_scale: screening.metric,
        ..Limits::default()
    }
}

fn view<'a>(
    sight: &Sight,
    features: &'a MatchableFeatures,
    points_in_camera: &'a [Option<crate::geometry::Point3>],
) -> View<'a> {
    View {
        camera: sight.camera,
        keypoints: &features.keypoints,
        descriptors: &features.descriptors,
        nodes: features.nodes.as_deref(),
        points_in_camera,
    }
}

/// What geometry found decides, and then the anchors under its transformation.
fn judge_geometry(
    screening: &Screening,
    screened: &Screened,
    verification: &Verification,
    candidate: &mut Candidate,
) {
    let settings = &screening.settings;
    if verification.status == Status::Failed {
        candidate.decision = CandidateDecision::Rejected;
        candidate.reason = Some(evidence::too_few_inliers(verification, settings));
        return;
    }
    // A translation of unknown length puts nothing anywhere.
    let is_metric = verification.model == Model::Sim3;
    let metric_transform = verification.candidate_from_query.filter(|_| is_metric);
    if let Some((path, transform)) = screened.path.zip(metric_transform)
        && let Some(discrepancy) = path.discrepancy(&transform)
    {
        candidate.decision = CandidateDecision::Rejected;
        candidate.reason = Some(evidence::disagrees_with_odometry(discrepancy, path.length_m));
        return;
    }
    let Some(transform) = metric_transform.filter(|_| screened.compared.has_anchors()) else { return };
    let aligned = screened.compared.under(&transform, settings);
    if let Some(anchors) = &mut candidate.anchors {
        evidence::align(anchors, &aligned);
    }
    let contradicting: f64 = aligned.contradictions.iter().fold(0.0, |sum, pair| sum + pair.weight());
    let min_similarity = settings.anchor_map_min_similarity;
    let agreed = screened.standing != Standing::AskGeometry;
    let reason = if contradicting > aligned.agreement {
        evidence::contradicted(&aligned.contradictions, contradicting, aligned.agreement)
    } else if agreed && aligned.similarity <= min_similarity {
        evidence::reason(ReasonCode::AnchorsDisagreeWithTransform, aligned.similarity, min_similarity)
    } else if contradicting + aligned.displaced > aligned.agreement {
        evidence::displaced(contradicting + aligned.displaced, aligned.agreement)
    } else if let Some(places) = aligned.least_places.filter(|places| agreed && *places > 1) {
        candidate.decision = CandidateDecision::Undecided;
        candidate.reason = Some(evidence::not_distinctive(places));
        return;
    } else {
        return;
    };
    candidate.decision = CandidateDecision::Rejected;
    candidate.reason = Some(reason);
}

/// Whether an undecided candidate looks too little alike for what it lacks to matter: nothing that is on its way, such as a
/// description, could turn it, and a client would wait or ask again for nothing.
fn is_far(screening: &Screening, candidate: &Candidate) -> bool {
    let lacks_all = candidate
        .reason
        .as_ref()
        .is_some_and(|reason| matches!(reason.code, ReasonCode::NoAnchors | ReasonCode::NoFeatures));
    let agrees = candidate.anchors.as_ref().is_some_and(|anchors| !anchors.matches.is_empty());
    let least = screening.settings.undecided_min_score_ratio * candidate.bow.reference_score;
    lacks_all && !agrees && candidate.bow.score < least
}

fn answer(screening: &Screening, candidates: Vec<Candidate>) -> Verdict {
    let of = |decision| candidates.iter().filter(move |c: &&Candidate| c.decision == decision);
    let loops: Vec<_> = of(CandidateDecision::Loop).map(|candidate| candidate.keyframe.clone()).collect();
    let nothing_to_compare = candidates.is_empty() && screening.empty_bow;
    let decision = if !loops.is_empty() {
        Decision::Loop
    } else if nothing_to_compare
        || of(CandidateDecision::Undecided).any(|candidate| !is_far(screening, candidate))
    {
        Decision::Undecided
    } else {
        Decision::NoLoop
    };
    let reason = if decision == Decision::NoLoop && !screening.closed.is_empty() {
        Some(evidence::already_closed(&screening.closed))
    } else {
        candidates.is_empty().then(|| evidence::no_candidates(screening.empty_bow))
    };
    Verdict {
        map_version: screening.map_version,
        decision,
        best: loops.first().cloned(),
        loops,
        degraded: screening.degraded,
        excluded_covisible: screening.excluded_covisible,
        closed: screening.closed.clone(),
        reason,
        candidates,
    }
}
