//! The last step of §V and the answer: decides on a candidate by geometry, and by the anchors under its transformation; and on
//! the query by its candidates.

use std::collections::BTreeMap;

use super::equation_2;
use super::evidence;
use super::features::FeatureSet;
use super::geometry_check::{GeometryOutcome, PlacedQuery, check_geometry};
use super::screening::{CandidateStage, PreVerified, Screening};
use crate::domain::verdict::{
    CLOSED_MAX, Candidate, CandidateDecision, ClosedLoop, Decision, GeometryStatus, Reason, ReasonCode,
    Verdict, Verify,
};
use crate::recognition::extensions::returning::Returning;
use crate::recognition::extensions::rivals::{Concluded, Seen};
use crate::recognition::verification::{Failure, Status, Verification};

/// Runs geometry on one candidate, and decides by what it found.
pub(super) fn verify_candidate(
    screening: &Screening,
    pre_verified: &PreVerified,
    asked: Option<&PlacedQuery<'_>>,
    features: &FeatureSet,
    seed: u64,
) -> Concluded {
    let mut candidate = pre_verified.candidate.clone();
    let is_stopped = pre_verified.stage == CandidateStage::Stopped;
    if is_stopped && !pre_verified.rivalry.is_rival {
        return Concluded { candidate, view: None };
    }
    let checked = check_geometry(screening, pre_verified, asked, features, seed);
    let is_near_miss = checked.as_ref().is_ok_and(GeometryOutcome::is_near_miss);
    let view = checked.as_ref().ok().map(|checked| seen(pre_verified, &checked.verification));
    if !is_stopped {
        decide(screening, pre_verified, checked, &mut candidate);
    }
    if is_near_miss && candidate.decision != CandidateDecision::Loop {
        let asked = |neighbour| verify_candidate(screening, neighbour, asked, features, seed);
        if let Some(mut found) = pre_verified.neighbours.iter().map(asked).find(is_verified_loop) {
            found.candidate.geometry.reason = Some(evidence::stands_in(&candidate));
            return found;
        }
    }
    Concluded { candidate, view }
}

/// Whether a neighbour may stand in for what geometry rejected: geometry on map points, and not its anchors alone, has found
/// the place.
fn is_verified_loop(neighbour: &Concluded) -> bool {
    let Concluded { candidate, view } = neighbour;
    candidate.decision == CandidateDecision::Loop
        && candidate.geometry.status == GeometryStatus::Verified
        && view.is_some_and(|view| view.query_in_session.is_some())
}

/// Returns what geometry found, to be held against rivals.
fn seen(pre_verified: &PreVerified, verification: &Verification) -> Seen {
    let metric = verification.candidate_from_query.filter(|_| verification.model.is_metric());
    let query_in_session =
        metric.zip(pre_verified.snapshot.as_ref()).and_then(|(found, snapshot)| snapshot.place(&found));
    Seen { inliers: verification.inliers, query_in_session }
}

/// Decides on a candidate that passed the anchors by what geometry found, or by what is missing for it.
pub(in crate::recognition) fn decide(
    screening: &Screening,
    pre_verified: &PreVerified,
    checked: Result<GeometryOutcome, &'static str>,
    candidate: &mut Candidate,
) {
    let (missing, skipped) = match checked {
        Ok(checked) if checked.verification.status != Status::Skipped => {
            candidate.geometry = evidence::geometry(&checked.verification);
            judge_geometry(screening, pre_verified, &checked, candidate);
            if candidate.decision == CandidateDecision::Loop && !checked.verification.model.is_metric() {
                judge_view(pre_verified, candidate);
            }
            judge_vouched(pre_verified, &checked.verification, candidate);
            judge_twins(screening, pre_verified, &checked.verification, candidate);
            return;
        }
        Ok(checked) => {
            candidate.geometry = evidence::geometry(&checked.verification);
            let why = checked.verification.failure.map_or_else(String::new, |failure| failure.to_string());
            (why, Some(checked))
        }
        Err(missing) => {
            candidate.geometry = evidence::geometry_skipped(missing);
            (missing.to_owned(), None)
        }
    };
    // A check that cannot run rejects nothing: where it need not, the anchors decide.
    if let Some(reason) = &pre_verified.contradicted {
        reject(candidate, reason.clone());
        return;
    }
    match pre_verified.stage {
        CandidateStage::Vouched => leave_unvouched(pre_verified, candidate),
        _ if screening.verify == Verify::Geometry || pre_verified.stage == CandidateStage::AskGeometry => {
            leave_undecided(candidate, evidence::geometry_missing(&missing));
        }
        CandidateStage::TrackedOnly { .. } => leave_undecided(candidate, evidence::tracked_only()),
        CandidateStage::NeedsWitness => leave_undecided(candidate, evidence::no_witness()),
        CandidateStage::Stopped | CandidateStage::AnchorsAgree | CandidateStage::AskGeometry => {
            // Two views of one sign have something in common; one from behind the wall has not.
            if let Some((matches, limit)) = skipped.and_then(|checked| unseen(pre_verified, &checked)) {
                leave_undecided(candidate, evidence::too_few_matches(matches, limit));
            }
        }
    }
}

/// Returns the matches and their limit where so few match that the two need not see one place, whatever their anchors say.
fn unseen(pre_verified: &PreVerified, checked: &GeometryOutcome) -> Option<(u32, u32)> {
    let is_open = checked.are_triangulated || pre_verified.identifier != Returning::InView;
    match checked.verification.failure {
        Some(Failure::TooFewMatches { matches, limit }) if is_open => Some((matches, limit)),
        _ => None,
    }
}

/// A view without map points may be that of another floor: it makes nothing sure, and witnesses nothing.
fn judge_view(pre_verified: &PreVerified, candidate: &mut Candidate) {
    if let Some(reason) = &pre_verified.contradicted {
        reject(candidate, reason.clone());
    } else if lacks_witness(pre_verified.stage) {
        leave_undecided(candidate, evidence::no_witness());
    }
}

/// Geometry alone closes no loop in a map that has shown one view in two places (M16).
fn judge_twins(
    screening: &Screening,
    pre_verified: &PreVerified,
    verification: &Verification,
    candidate: &mut Candidate,
) {
    let is_alone = pre_verified.stage == CandidateStage::AskGeometry;
    if screening.twins > 0 && is_alone && candidate.decision == CandidateDecision::Loop {
        leave_undecided(candidate, evidence::twins_known(verification.inliers));
    }
}

fn reject(candidate: &mut Candidate, reason: Reason) {
    candidate.decision = CandidateDecision::Rejected;
    candidate.reason = Some(reason);
}

fn leave_undecided(candidate: &mut Candidate, reason: Reason) {
    candidate.decision = CandidateDecision::Undecided;
    candidate.reason = Some(reason);
}

/// Says that neighbours vouch for what geometry on map points verifies, and takes back what it does not.
fn judge_vouched(pre_verified: &PreVerified, verification: &Verification, candidate: &mut Candidate) {
    let Some(vouched) = &pre_verified.vouched else { return };
    if verification.status == Status::Verified && verification.model.is_metric() {
        if candidate.decision == CandidateDecision::Loop {
            candidate.reason = Some(evidence::neighbours_vouch(vouched.by, verification.inliers));
        }
    } else {
        leave_unvouched(pre_verified, candidate);
    }
}

/// Decides as if nobody vouched.
fn leave_unvouched(pre_verified: &PreVerified, candidate: &mut Candidate) {
    if let Some(vouched) = &pre_verified.vouched {
        let (decision, reason) = vouched.otherwise.clone();
        candidate.decision = decision;
        candidate.reason = Some(reason);
    }
}

/// Whether nothing but texts that need a witness agrees.
fn lacks_witness(stage: CandidateStage) -> bool {
    matches!(stage, CandidateStage::NeedsWitness | CandidateStage::TrackedOnly { has_witness: false })
}

/// What geometry found decides, and then the anchors under its transformation.
fn judge_geometry(
    screening: &Screening,
    pre_verified: &PreVerified,
    checked: &GeometryOutcome,
    candidate: &mut Candidate,
) {
    let (settings, verification) = (&screening.settings, &checked.verification);
    let is_metric = verification.model.is_metric();
    if verification.status == Status::Failed {
        let reason = evidence::too_few_inliers(verification, settings);
        if is_metric || pre_verified.identifier == Returning::No {
            reject(candidate, reason);
        } else if screening.verify == Verify::Geometry {
            leave_undecided(candidate, reason);
        }
        return;
    }
    let alone = settings.geometry_alone_min_inliers;
    if pre_verified.stage == CandidateStage::AskGeometry && !is_metric {
        if verification.inliers < alone {
            leave_undecided(candidate, evidence::too_few_alone(verification, alone));
            return;
        }
        // The next frame of one drive shows the same view.
        if pre_verified.is_here {
            leave_undecided(candidate, evidence::tracked_only());
            return;
        }
    }
    // A translation of unknown length puts nothing anywhere.
    let metric_transform = verification.candidate_from_query.filter(|_| is_metric);
    if let Some((path, transform)) = pre_verified.path.zip(metric_transform)
        && let Some(discrepancy) = path.discrepancy(&transform, &screening.settings)
    {
        reject(candidate, evidence::disagrees_with_odometry(discrepancy, path.length_m));
        return;
    }
    let Some(transform) = metric_transform.filter(|_| pre_verified.compared.has_anchors()) else { return };
    let aligned = pre_verified.compared.under(&checked.between_poses(&transform), settings);
    if let Some(anchors) = &mut candidate.anchors {
        evidence::align(anchors, &aligned);
    }
    let contradicting: f64 = aligned.contradictions.iter().fold(0.0, |sum, pair| sum + pair.weight());
    let agreed = pre_verified.stage != CandidateStage::AskGeometry;
    let reason = if contradicting > aligned.agreement {
        evidence::contradicted(&aligned.contradictions, contradicting, aligned.agreement)
    } else if agreed && !equation_2::passes(aligned.similarity, settings) {
        evidence::reason(
            ReasonCode::AnchorsDisagreeWithTransform,
            aligned.similarity,
            settings.anchor_map_min_similarity,
        )
    } else if contradicting + aligned.displaced > aligned.agreement {
        evidence::displaced(contradicting + aligned.displaced, aligned.agreement)
    } else if let Some(places) = aligned.least_places.filter(|places| agreed && *places > 1) {
        leave_undecided(candidate, evidence::not_distinctive(places));
        return;
    } else {
        return;
    };
    reject(candidate, reason);
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

/// Takes back each loop that repeats a confirmed one. Returns those confirmed loops, by id.
pub(super) fn settle_repeats(pre_verified: &[PreVerified], concluded: &mut [Concluded]) -> Vec<ClosedLoop> {
    let mut closed = BTreeMap::new();
    for (pre_verified, Concluded { candidate, .. }) in pre_verified.iter().zip(concluded) {
        // A neighbour that stands in for a near miss is of the same place.
        let Some(repeated) = &pre_verified.repeats else { continue };
        if candidate.decision == CandidateDecision::Loop {
            reject(candidate, evidence::repeats(repeated));
            closed.insert(repeated.id.clone(), repeated.clone());
        }
    }
    closed.into_values().collect()
}

/// Returns the verdict on a query whose candidates are decided, the best first, and of which some repeat these confirmed loops.
pub(super) fn answer(
    screening: &Screening,
    candidates: Vec<Candidate>,
    repeated: Vec<ClosedLoop>,
) -> Verdict {
    let of = |decision| candidates.iter().filter(move |c: &&Candidate| c.decision == decision);
    let loops: Vec<_> = of(CandidateDecision::Loop).map(|candidate| candidate.keyframe.clone()).collect();
    let nothing_to_compare = candidates.is_empty() && screening.empty_bow;
    let mut closed = screening.closed.clone();
    closed.extend(repeated.iter().filter(|repeated| !screening.closed.contains(repeated)).cloned());
    closed.truncate(CLOSED_MAX);
    let decision = if !loops.is_empty() {
        Decision::Loop
    } else if !repeated.is_empty() {
        Decision::NoLoop
    } else if nothing_to_compare
        || of(CandidateDecision::Undecided).any(|candidate| !is_far(screening, candidate))
    {
        Decision::Undecided
    } else {
        Decision::NoLoop
    };
    let reason = if let (Decision::NoLoop, Some(repeated)) = (decision, repeated.first()) {
        Some(evidence::repeats(repeated))
    } else if decision == Decision::NoLoop && !closed.is_empty() {
        Some(evidence::already_closed(&closed))
    } else if candidates.is_empty() && screening.too_recent > 0 && !screening.empty_bow {
        Some(evidence::too_recent(screening.too_recent, screening.settings.candidates_min_gap_s))
    } else {
        candidates.is_empty().then(|| evidence::no_candidates(screening.empty_bow))
    };
    Verdict {
        map_version: screening.map_version,
        decision,
        best: loops.first().cloned(),
        loops,
        degraded: screening.degraded,
        has_twins: screening.twins > 0,
        excluded_covisible: screening.excluded_covisible,
        closed,
        reason,
        candidates,
    }
}
