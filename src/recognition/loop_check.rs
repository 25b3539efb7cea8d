//! "Is this keyframe a loop?": the whole funnel of §V on one screen.
//!
//! Checks 1 to 3 need the map and run under its lock ([`screen`]); what passes them and has features waits for
//! geometry, which needs descriptors from disk and no map ([`super::conclusion`]).

use super::alignment::Compared;
use super::anchor_map::{Centre, LocalAnchorMap, local_anchor_map};
use super::candidates::{Proposal, Proposals, find_candidates};
use super::company::Companies;
use super::comparison::{Comparison, compare};
use super::difference::find_differing;
use super::distinctiveness::PlaceCounts;
use super::evidence;
use super::index::MapIndex;
use super::passage::is_tracked_only;
use super::query::Query;
use super::screening::{Screened, Screening, Standing};
use super::sight::Sight;
use super::standing_in::{AtWorst, at_worst, awaited, model_is_missed};
use super::tracked_path::TrackedPaths;
use super::witness::{lacks_witness, odometry_agrees};
use crate::model::change::Loop;
use crate::model::settings::Settings;
use crate::model::settings::WithoutAnchors;
use crate::model::verdict::{
    CLOSED_MAX, Candidate, CandidateDecision, ClosedLoop, Reason, ReasonCode, Verify,
};

/// Runs checks 1 to 3 at this version of the map. Pure: the same arguments give the same answer.
pub fn screen(index: &MapIndex, map_version: u64, query: &Query<'_>, verify: Verify) -> Screening {
    let mut places = PlaceCounts::around(index, &query.centre);
    // Checks 1 and 2: not covisible, and alike by bag of words or by an anchor seen before.
    let proposals = find_candidates(index, query, &mut places);
    // Check 3: the local anchor maps.
    let around_query = local_anchor_map(index, &query.centre, &mut places);
    let settings = &index.properties().settings;
    let mut companies = Companies::default();
    let candidates: Vec<Screened> = (proposals.candidates.iter())
        .filter_map(|proposal| {
            let centre = Centre::stored(index, proposal.keyframe)?;
            let around_candidate = local_anchor_map(index, &centre, &mut places);
            let maps = [&around_query, &around_candidate];
            let mut comparison = compare(&around_query, &around_candidate, index.texts(), settings);
            if settings.company {
                companies.weigh(index, &mut comparison, maps, &mut places);
            }
            check_candidate(index, &proposals, *proposal, query, maps, comparison, verify)
        })
        .collect();
    let candidates = with_tracked_paths(index, query, candidates);
    Screening {
        map_version,
        settings: settings.clone(),
        metric: index.properties().metric,
        verify,
        empty_bow: query.bow.is_empty(),
        excluded_covisible: query.covisible().count(),
        closed: closed_loops(index, query),
        degraded: candidates.iter().any(|candidate| candidate.stood_in),
        query: query.keyframe,
        sight: query.sight.clone(),
        candidates,
    }
}

/// Returns the confirmed loops of the query's keyframe.
fn closed_loops(index: &MapIndex, query: &Query<'_>) -> Vec<ClosedLoop> {
    let Some(own) = query.keyframe else { return Vec::new() };
    let other = |closed: &Loop| {
        let is_start = closed.keyframe == own;
        if is_start { closed.candidate_id.clone() } else { closed.keyframe_id.clone() }
    };
    let closed = index.loops_of(own).take(CLOSED_MAX);
    closed.map(|closed| ClosedLoop { id: closed.id.clone(), keyframe: other(closed) }).collect()
}

/// Adds where odometry has the candidates that geometry is to look at, or that need a witness.
fn with_tracked_paths(index: &MapIndex, query: &Query<'_>, mut candidates: Vec<Screened>) -> Vec<Screened> {
    let checks_transform = index.properties().settings.aligned_anchors;
    let waits = |screened: &Screened| match screened.standing {
        Standing::Stopped => false,
        Standing::NeedsWitness => true,
        Standing::AnchorsAgree | Standing::TrackedOnly { .. } | Standing::AskGeometry => {
            checks_transform && screened.sight.is_some()
        }
    };
    if let Some(keyframe) = query.keyframe
        && candidates.iter().any(waits)
    {
        let paths = TrackedPaths::from(index, keyframe);
        for screened in candidates.iter_mut().filter(|screened| waits(screened)) {
            let path = paths.to(index, keyframe, screened.keyframe);
            if screened.standing == Standing::NeedsWitness
                && path.is_some_and(|path| odometry_agrees(&path, &screened.compared))
            {
                screened.standing = Standing::AnchorsAgree;
            }
            screened.path = path.filter(|_| checks_transform);
        }
    }
    candidates
}

fn check_candidate(
    index: &MapIndex,
    proposals: &Proposals,
    proposal: Proposal,
    query: &Query<'_>,
    [around_query, around_candidate]: [&LocalAnchorMap; 2],
    comparison: Comparison<'_>,
    verify: Verify,
) -> Option<Screened> {
    let settings = &index.properties().settings;
    let bow = evidence::bow(proposal, proposals.reference_score);
    let mut candidate = Candidate {
        keyframe: index.keyframe(proposal.keyframe)?.id.clone(),
        decision: CandidateDecision::Loop,
        bow,
        anchors: None,
        geometry: evidence::geometry_skipped("an earlier check decided"),
        reason: None,
    };
    let min_score = settings.candidates_min_score_ratio * proposals.reference_score;
    if proposal.by_words && bow.score < min_score {
        let reason = evidence::reason(ReasonCode::BowBelowReference, bow.score, min_score);
        return Some(Screened::stopped(proposal.keyframe, candidate, CandidateDecision::Rejected, reason));
    }
    let stood_in = model_is_missed(index, around_query, around_candidate);
    let differing = find_differing(around_query, around_candidate, &comparison, index.texts(), settings);
    candidate.anchors = Some(evidence::anchors(&comparison, &differing, settings));
    // Only where a model reads crops does a description come by itself.
    let reads = query.roles.vision || index.model_away();
    let worst = reads.then(|| at_worst(index, around_query, around_candidate, &comparison)).flatten();
    let missing = match () {
        () if !reads || awaited(index, around_query, around_candidate) == 0 => ReasonCode::NotDescribed,
        () if index.model_away() => ReasonCode::LlmUnavailable,
        () => ReasonCode::LlmPending,
    };
    let is_tracked_only = || {
        // What is not stored is where the newest of its neighbours is.
        let query = query.keyframe.or(query.centre.covisible.last().copied());
        query.is_some_and(|query| is_tracked_only(index, &comparison, query, proposal.keyframe))
    };
    let standing = judge_anchors(&comparison, settings, worst, missing).map(|standing| match standing {
        Standing::AnchorsAgree | Standing::NeedsWitness
            if settings.tracked_loops_need_geometry && is_tracked_only() =>
        {
            Standing::TrackedOnly { has_witness: standing == Standing::AnchorsAgree }
        }
        other => other,
    });
    let mut screened = match standing {
        Err((decision, reason)) => Screened::stopped(proposal.keyframe, candidate, decision, reason),
        Ok(standing) => Screened {
            keyframe: proposal.keyframe,
            candidate,
            standing,
            compared: Compared::of(&comparison, differing),
            path: None,
            sight: if verify == Verify::Anchors { None } else { Sight::stored(index, proposal.keyframe) },
            stood_in: false,
        },
    };
    screened.stood_in = stood_in;
    Some(screened)
}

/// Check 3 of §V: contradictions first, since they name what S only measures.
pub(super) fn judge_anchors(
    comparison: &Comparison<'_>,
    settings: &Settings,
    worst: Option<AtWorst>,
    missing: ReasonCode,
) -> Result<Standing, (CandidateDecision, Reason)> {
    use CandidateDecision::{Rejected, Undecided};
    let min_similarity = settings.anchor_map_min_similarity;
    let (agreeing, contradicting) = (comparison.agreement(), comparison.contradicting_weight());
    let could_turn = comparison.pending > 0
        && comparison.at_best.similarity > min_similarity
        && comparison.at_best.agreeing_weight >= contradicting;
    let contradicted = contradicting > agreeing;
    if !contradicted && comparison.similarity > min_similarity {
        let turns =
            |worst: &AtWorst| worst.similarity <= min_similarity || worst.contradicting_weight > agreeing;
        return match (worst.filter(turns), comparison.least_places()) {
            (Some(worst), _) => Err((Undecided, evidence::awaited(&worst, missing))),
            (None, Some(places)) if places > 1 => Err((Undecided, evidence::not_distinctive(places))),
            _ if settings.single_text_needs_witness && lacks_witness(comparison) => {
                Ok(Standing::NeedsWitness)
            }
            _ => Ok(Standing::AnchorsAgree),
        };
    }
    if could_turn {
        return Err((Undecided, evidence::pending(comparison, missing)));
    }
    if contradicted {
        return Err((Rejected, evidence::contradicted(&comparison.contradictions, contradicting, agreeing)));
    }
    if comparison.in_query > 0 && comparison.in_candidate > 0 {
        let reason = evidence::reason(ReasonCode::ScoreBelowThreshold, comparison.similarity, min_similarity);
        return Err((Rejected, reason));
    }
    match settings.without_anchors {
        WithoutAnchors::Undecided => Err((Undecided, evidence::no_anchors(comparison))),
        WithoutAnchors::Reject => Err((Rejected, evidence::no_anchors(comparison))),
        WithoutAnchors::Geometry => Ok(Standing::AskGeometry),
    }
}
