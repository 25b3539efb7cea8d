//! From figures to evidence: what a verdict shows of each check, and the sentences that say why.

use std::cmp::Ordering;

use super::comparison::Comparison;
use crate::domain::bow::Score;
use crate::domain::counted::counted;
use crate::domain::ids::KeyframeSeq;
use crate::domain::settings::Settings;
use crate::domain::verdict::{
    AnchorEvidence, BowEvidence, Candidate, CandidateDecision, ClosedLoop, ContradictionEvidence,
    GeometryEvidence, GeometryFigures, GeometryStatus, MatchEvidence, Reason, ReasonCode,
};
use crate::recognition::extensions::contradiction::Contradiction;
use crate::recognition::extensions::worst_case::WorstCase;
use crate::recognition::map::index::MapIndex;
use crate::recognition::verification::{Failure, Verification};
use crate::semantics::TextKind;

/// Loops first, then undecided, then rejected; each by inliers, then S, then score, then the smallest id (M36).
/// S counts as 0 where all that agrees hangs in several places, for it says nothing of which.
pub(in crate::recognition) fn best_first(a: &Candidate, b: &Candidate) -> Ordering {
    let rank = |candidate: &Candidate| match candidate.decision {
        CandidateDecision::Loop => 0,
        CandidateDecision::Undecided => 1,
        CandidateDecision::Rejected => 2,
    };
    let similarity =
        |candidate: &Candidate| match candidate.anchors.as_ref().filter(|anchors| anchors.is_distinctive) {
            Some(anchors) => anchors.similarity,
            None => 0.0,
        };
    let inliers =
        |candidate: &Candidate| candidate.geometry.figures.as_ref().map_or(0, |figures| figures.inliers);
    (rank(a).cmp(&rank(b)))
        .then_with(|| inliers(b).cmp(&inliers(a)))
        .then_with(|| similarity(b).total_cmp(&similarity(a)))
        .then_with(|| b.bow.score.total_cmp(&a.bow.score))
        .then_with(|| a.keyframe.cmp(&b.keyframe))
}

pub(in crate::recognition) fn bow(score: Score, reference_score: f64) -> BowEvidence {
    BowEvidence { score: score.value(), common_words: score.common_words(), reference_score }
}

pub(in crate::recognition) fn anchors(comparison: &Comparison<'_>, settings: &Settings) -> AnchorEvidence {
    AnchorEvidence {
        similarity: comparison.similarity,
        threshold: settings.anchor_map_min_similarity,
        in_query: comparison.in_query,
        in_candidate: comparison.in_candidate,
        pending: comparison.pending,
        matches: comparison
            .matches
            .iter()
            .map(|pair| MatchEvidence {
                query_anchor: pair.query.name.public(),
                candidate_anchor: pair.candidate.name.public(),
                // Only described anchors match.
                kind: pair.query.kind.unwrap_or(TextKind::Unknown),
                level: pair.level,
                source: pair.source.as_str().to_owned(),
                angle_difference_rad: pair.query.bearing.angle_difference_rad(&pair.candidate.bearing),
                distance_difference_m: pair.query.bearing.distance_difference_m(&pair.candidate.bearing),
                weight: pair.weight(),
            })
            .collect(),
        is_distinctive: comparison.least_places() == Some(1),
        contradictions: comparison.contradictions.iter().map(contradiction).collect(),
    }
}

fn contradiction(pair: &Contradiction<'_>) -> ContradictionEvidence {
    ContradictionEvidence {
        query_anchor: pair.query.name.public(),
        candidate_anchor: pair.candidate.name.public(),
        reason: pair.reason(),
        weight: pair.weight(),
    }
}

/// Why geometry was skipped where a check before it decided: the candidate's own reason says it.
pub(in crate::recognition) const NOT_ASKED: &str = "";

pub(in crate::recognition) fn geometry_skipped(reason: &str) -> GeometryEvidence {
    let reason = (reason != NOT_ASKED).then(|| reason.to_owned());
    GeometryEvidence { status: GeometryStatus::Skipped, reason, figures: None }
}

pub(in crate::recognition) fn geometry(verification: &Verification) -> GeometryEvidence {
    GeometryEvidence {
        status: verification.status,
        reason: verification.failure.map(|failure| failure.to_string()),
        figures: Some(GeometryFigures {
            model: verification.model.as_str(),
            matches: verification.matches,
            hypotheses: verification.hypotheses,
            inliers: verification.inliers,
            log10_false_alarms: verification.log10_false_alarms,
            mean_reprojection_error_px: verification.mean_reprojection_error_px,
            candidate_from_query: verification.candidate_from_query,
            covariance: verification.covariance.filter(|_| verification.status == GeometryStatus::Verified),
        }),
    }
}

pub(in crate::recognition) fn stands_in(near_miss: &Candidate) -> String {
    let inliers = near_miss.geometry.figures.as_ref().map_or(0, |figures| figures.inliers);
    format!("stands in for {}, of the same place, which has {inliers} inliers", near_miss.keyframe)
}

pub(in crate::recognition) fn too_few_inliers(verification: &Verification, settings: &Settings) -> Reason {
    let (measured, limit) = match verification.failure {
        Some(Failure::TooFewInliers { inliers, limit }) => (inliers, limit),
        Some(Failure::TooFewSureInliers { sure, limit }) => (sure, limit),
        _ => (verification.inliers, settings.geometry_min_inliers),
    };
    let detail = verification.failure.map_or_else(String::new, |failure| failure.to_string());
    let (measured, limit) = (Some(f64::from(measured)), Some(f64::from(limit)));
    Reason { code: ReasonCode::TooFewInliers, measured, limit, detail }
}

pub(in crate::recognition) fn too_few_matches(matches: u32, limit: u32) -> Reason {
    let detail = format!(
        "{matches} descriptors match, and {limit} are needed for geometry: nothing shows that the two views are of one place"
    );
    let (measured, limit) = (Some(f64::from(matches)), Some(f64::from(limit)));
    Reason { code: ReasonCode::TooFewInliers, measured, limit, detail }
}

pub(in crate::recognition) fn reason(code: ReasonCode, measured: f64, limit: f64) -> Reason {
    let detail = match code {
        ReasonCode::BowBelowReference => {
            format!(
                "the words score {measured:.3}, below {limit:.3}, the share asked for of the reference score"
            )
        }
        _ => format!("the anchor maps agree by S = {measured:.3}, which does not exceed {limit}"),
    };
    Reason { code, measured: Some(measured), limit: Some(limit), detail }
}

pub(in crate::recognition) fn pending(comparison: &Comparison<'_>, code: ReasonCode) -> Reason {
    let detail = format!(
        "not described yet: {}; at best S would be {:.3}",
        counted(comparison.pending, "anchor"),
        comparison.best_case.similarity
    );
    let pending = comparison.pending as f64;
    Reason { code, measured: Some(pending), limit: Some(0.0), detail }
}

pub(in crate::recognition) fn awaited(worst: &WorstCase, code: ReasonCode) -> Reason {
    let crops = counted(worst.awaited, "crop");
    let detail = format!("not described yet: {crops}; at worst S would be {:.3}", worst.similarity);
    Reason { code, measured: Some(worst.awaited as f64), limit: Some(0.0), detail }
}

pub(in crate::recognition) fn no_anchors(comparison: &Comparison<'_>) -> Reason {
    let detail = which_has_no_anchors(comparison.in_query, comparison.in_candidate).to_owned();
    Reason { code: ReasonCode::NoAnchors, measured: Some(0.0), limit: Some(1.0), detail }
}

/// Says which of two local anchor maps is empty.
pub(in crate::recognition) fn which_has_no_anchors(in_query: usize, in_candidate: usize) -> &'static str {
    match (in_query, in_candidate) {
        (0, 0) => "neither keyframe has a described anchor around it",
        (0, _) => "the query has no described anchor around it",
        _ => "the candidate has no described anchor around it",
    }
}

pub(in crate::recognition) fn geometry_missing(missing: &str) -> Reason {
    let detail = format!("geometry must verify: {missing}");
    Reason { code: ReasonCode::NoFeatures, measured: None, limit: None, detail }
}

pub(in crate::recognition) fn already_closed(closed: &[ClosedLoop]) -> Reason {
    let detail = match closed {
        [one] => format!("its loop with {} is confirmed already, as {}", one.keyframe, one.id),
        several => format!("{} loops of this keyframe are confirmed already", several.len()),
    };
    Reason { code: ReasonCode::AlreadyClosed, measured: None, limit: None, detail }
}

/// Returns the reason of a candidate that a confirmed loop of the same return has joined already (M63).
pub(in crate::recognition) fn repeats(closed: &ClosedLoop) -> Reason {
    let ClosedLoop { id, keyframe } = closed;
    let detail =
        format!("this return is closed already, by {id} with {keyframe}: what matches here, it has joined");
    Reason { code: ReasonCode::AlreadyClosed, measured: None, limit: None, detail }
}

pub(in crate::recognition) fn no_candidates(empty_bow: bool) -> Reason {
    let (code, detail) = if empty_bow {
        (ReasonCode::EmptyBow, "the query has no words, and no anchor it sees was seen before")
    } else {
        (
            ReasonCode::NoCandidates,
            "no keyframe outside its covisible ones shares a word or an anchor with the query",
        )
    };
    Reason { code, measured: None, limit: None, detail: detail.to_owned() }
}

/// Returns the reason of a query that has no candidate, and for which this many keyframes were too recent (M53).
pub(in crate::recognition) fn too_recent(keyframes: usize, gap_s: f64) -> Reason {
    Reason {
        code: ReasonCode::TooRecent,
        measured: Some(keyframes as f64),
        limit: Some(gap_s),
        detail: format!(
            "{} of its session, taken less than {gap_s} s before or after it, left out; nothing else is alike",
            counted(keyframes, "keyframe")
        ),
    }
}

/// Returns a candidate before check 3; none if its keyframe was culled.
pub(in crate::recognition) fn unchecked(
    index: &MapIndex,
    keyframe: KeyframeSeq,
    score: Score,
    reference_score: f64,
) -> Option<Candidate> {
    Some(Candidate {
        keyframe: index.keyframe(keyframe)?.id.clone(),
        decision: CandidateDecision::Loop,
        proposed: None,
        bow: bow(score, reference_score),
        anchors: None,
        geometry: geometry_skipped(NOT_ASKED),
        odds: None,
        reason: None,
    })
}
