//! "Is this keyframe a loop?": the whole funnel of §V on one screen.

use super::anchor_map::{Centre, LocalAnchorMap, local_anchor_map};
use super::candidates::{Proposal, Proposals, find_candidates};
use super::comparison::{Comparison, compare};
use super::distinctiveness::PlaceCounts;
use super::evidence;
use super::index::MapIndex;
use super::query::Query;
use crate::model::settings::WithoutAnchors;
use crate::model::verdict::{Candidate, CandidateDecision, Decision, Reason, ReasonCode, Verdict, Verify};

/// Answers a query at this version of the map. Pure: the same arguments give the same answer.
pub fn check_loop(index: &MapIndex, map_version: u64, query: &Query<'_>, verify: Verify) -> Verdict {
    let mut places = PlaceCounts::default();
    // Checks 1 and 2: not covisible, and alike by bag of words or by an anchor seen before.
    let proposals = find_candidates(index, query, &mut places);
    // Check 3: the local anchor maps.
    let around_query = local_anchor_map(index, &query.centre, &mut places);
    let mut candidates: Vec<Candidate> = (proposals.candidates.iter())
        .filter_map(|proposal| {
            let centre = Centre::stored(index, proposal.keyframe)?;
            let around_candidate = local_anchor_map(index, &centre, &mut places);
            check_candidate(index, &proposals, *proposal, &around_query, &around_candidate, verify)
        })
        .collect();
    candidates.sort_by(evidence::best_first);
    answer(map_version, query, candidates)
}

fn check_candidate(
    index: &MapIndex,
    proposals: &Proposals,
    proposal: Proposal,
    around_query: &LocalAnchorMap,
    around_candidate: &LocalAnchorMap,
    verify: Verify,
) -> Option<Candidate> {
    let settings = &index.properties().settings;
    let bow = evidence::bow(proposal, proposals.reference_score);
    let mut candidate = Candidate {
        keyframe: index.keyframe(proposal.keyframe)?.id.clone(),
        decision: CandidateDecision::Loop,
        bow,
        anchors: None,
        geometry: evidence::geometry_not_run(verify),
        reason: None,
    };
    let min_score = settings.candidates_min_score_ratio * proposals.reference_score;
    if bow.score < min_score {
        let reason = evidence::reason(ReasonCode::BowBelowReference, bow.score, min_score);
        return Some(stopped(candidate, CandidateDecision::Rejected, reason));
    }
    let comparison = compare(around_query, around_candidate, index.texts(), settings);
    candidate.anchors = Some(evidence::anchors(&comparison, settings));
    let geometry_must_verify = verify == Verify::Geometry;
    Some(match judge_anchors(&comparison, settings.without_anchors, settings.anchor_map_min_similarity) {
        Err((decision, reason)) => stopped(candidate, decision, reason),
        Ok(AnchorsSay::Same) if !geometry_must_verify => candidate,
        Ok(AnchorsSay::Same | AnchorsSay::AskGeometry) => {
            stopped(candidate, CandidateDecision::Undecided, evidence::geometry_missing())
        }
    })
}

/// What a comparison that stops nobody says.
enum AnchorsSay {
    /// The two places are one.
    Same,
    /// Without anchors, geometry alone decides.
    AskGeometry,
}

/// Check 3 of §V: contradictions first, since they name what S only measures.
fn judge_anchors(
    comparison: &Comparison<'_>,
    without_anchors: WithoutAnchors,
    min_similarity: f64,
) -> Result<AnchorsSay, (CandidateDecision, Reason)> {
    use CandidateDecision::{Rejected, Undecided};
    let (agreeing, contradicting) = (comparison.agreeing_weight(), comparison.contradicting_weight());
    if contradicting > agreeing {
        return Err((Rejected, evidence::contradicted(comparison, contradicting, agreeing)));
    }
    if comparison.similarity > min_similarity {
        return Ok(AnchorsSay::Same);
    }
    let measured = evidence::reason(ReasonCode::ScoreBelowThreshold, comparison.similarity, min_similarity);
    if comparison.similarity_at_best > min_similarity {
        return Err((Undecided, evidence::pending(comparison)));
    }
    if comparison.in_query > 0 && comparison.in_candidate > 0 {
        return Err((Rejected, measured));
    }
    match without_anchors {
        WithoutAnchors::Undecided => Err((Undecided, evidence::no_anchors(comparison))),
        WithoutAnchors::Reject => Err((Rejected, evidence::no_anchors(comparison))),
        WithoutAnchors::Geometry => Ok(AnchorsSay::AskGeometry),
    }
}

fn stopped(mut candidate: Candidate, decision: CandidateDecision, reason: Reason) -> Candidate {
    candidate.decision = decision;
    candidate.reason = Some(reason);
    candidate
}

fn answer(map_version: u64, query: &Query<'_>, candidates: Vec<Candidate>) -> Verdict {
    let of = |decision| candidates.iter().filter(move |c: &&Candidate| c.decision == decision);
    let loops: Vec<_> = of(CandidateDecision::Loop).map(|candidate| candidate.keyframe.clone()).collect();
    let nothing_to_compare = candidates.is_empty() && query.bow.is_empty();
    let decision = if !loops.is_empty() {
        Decision::Loop
    } else if nothing_to_compare || of(CandidateDecision::Undecided).next().is_some() {
        Decision::Undecided
    } else {
        Decision::NoLoop
    };
    Verdict {
        map_version,
        decision,
        best: loops.first().cloned(),
        loops,
        degraded: false,
        excluded_covisible: query.covisible().count(),
        reason: candidates.is_empty().then(|| evidence::no_candidates(query.bow.is_empty())),
        candidates,
    }
}
