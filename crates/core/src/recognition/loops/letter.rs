//! The paper's letter: decides by S of Eq. (2), then by geometry, and by nothing else (`"method": "paper"`).

use super::comparison::Comparison;
use super::equation_2;
use super::evidence;
use super::geometry_check::GeometryOutcome;
use super::screening::{PreVerified, Screening, Stage};
use crate::domain::settings::{Settings, WithoutAnchors};
use crate::domain::verdict::{Candidate, CandidateDecision, GeometryStatus, Reason, ReasonCode, Verify};
use crate::recognition::extensions::returning::Returning;
use crate::recognition::extensions::worst_case::WorstCase;
use crate::recognition::verification::Failure;

/// Decides by the anchors alone, §V-B: lets a candidate pass, or stops it. `missing` is what descriptions wait for.
pub fn judge_anchors(
    settings: &Settings,
    comparison: &Comparison<'_>,
    worst: Option<WorstCase>,
    missing: ReasonCode,
) -> Result<Stage, (CandidateDecision, Reason)> {
    use CandidateDecision::{Rejected, Undecided};
    let passes = |similarity| equation_2::passes(similarity, settings);
    if passes(comparison.similarity) {
        return match worst.filter(|worst| !passes(worst.similarity)) {
            Some(worst) => Err((Undecided, evidence::awaited(&worst, missing))),
            None => Ok(Stage::AnchorsAgree),
        };
    }
    if comparison.pending > 0 && passes(comparison.best_case.similarity) {
        return Err((Undecided, evidence::pending(comparison, missing)));
    }
    if comparison.in_query > 0 && comparison.in_candidate > 0 {
        let (measured, limit) = (comparison.similarity, settings.anchor_map_min_similarity);
        return Err((Rejected, evidence::reason(ReasonCode::ScoreBelowThreshold, measured, limit)));
    }
    match settings.without_anchors {
        WithoutAnchors::Undecided => Err((Undecided, evidence::no_anchors(comparison))),
        WithoutAnchors::Reject => Err((Rejected, evidence::no_anchors(comparison))),
        WithoutAnchors::Geometry => Ok(Stage::AskGeometry),
    }
}

/// Decides on a candidate that passed the anchors by what geometry found, or by what is missing for it.
pub fn decide(
    screening: &Screening,
    pre_verified: &PreVerified,
    checked: Result<GeometryOutcome, &'static str>,
    candidate: &mut Candidate,
) {
    let mut settle = |decision, reason| {
        candidate.decision = decision;
        candidate.reason = Some(reason);
    };
    let must_verify = screening.verify == Verify::Geometry || pre_verified.stage == Stage::AskGeometry;
    match &checked {
        Ok(outcome) if outcome.verification.status == GeometryStatus::Failed => {
            let reason = evidence::too_few_inliers(&outcome.verification, &screening.settings);
            let is_metric = outcome.verification.model.is_metric();
            if is_metric || pre_verified.identifier == Returning::No {
                settle(CandidateDecision::Rejected, reason);
            } else if screening.verify == Verify::Geometry {
                settle(CandidateDecision::Undecided, reason);
            }
        }
        Ok(outcome) if outcome.verification.status == GeometryStatus::Skipped => {
            // A check that cannot run rejects nothing: where it need not, the anchors decide.
            if must_verify {
                let why =
                    outcome.verification.failure.map_or_else(String::new, |failure| failure.to_string());
                settle(CandidateDecision::Undecided, evidence::geometry_missing(&why));
            } else if let Some((matches, limit)) = unseen(pre_verified, outcome) {
                settle(CandidateDecision::Undecided, evidence::too_few_matches(matches, limit));
            }
        }
        Err(missing) if must_verify => {
            settle(CandidateDecision::Undecided, evidence::geometry_missing(missing));
        }
        Ok(_) | Err(_) => {}
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
