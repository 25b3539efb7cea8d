//! The decision on a candidate by its odds, and the reason.

use super::bet::Bet;
use super::log_odds::LogOdds;
use super::sum::Sum;
use super::weights;
use crate::domain::counted::counted;
use crate::domain::settings::{Settings, WithoutAnchors};
use crate::domain::verdict::{
    Candidate, CandidateDecision, EvidenceKind, GeometryStatus, Reason, ReasonCode, Verify,
};
use crate::recognition::loops::evidence::{geometry_missing, which_has_no_anchors};

/// Decides on a candidate by the sum of its evidence.
pub fn conclude(candidate: &mut Candidate, sum: &Sum, bet: &Bet, verify: Verify, settings: &Settings) {
    let total = sum.total();
    let least = LogOdds::of_probability(settings.loop_min_confidence);
    candidate.odds = Some(sum.odds());
    let lacks_geometry = verify == Verify::Geometry && candidate.geometry.status != GeometryStatus::Verified;
    let (decision, reason) = if total >= least && lacks_geometry {
        let missing = candidate.geometry.reason.clone().unwrap_or_default();
        (CandidateDecision::Undecided, Some(geometry_missing(&missing)))
    } else if total >= least {
        (CandidateDecision::Loop, None)
    } else {
        let reason = reason(candidate, sum, bet, settings);
        (decision_without_loop(candidate, sum, bet, least, settings), Some(reason))
    };
    candidate.decision = decision;
    candidate.reason = reason;
}

fn decision_without_loop(
    candidate: &Candidate,
    sum: &Sum,
    bet: &Bet,
    least: LogOdds,
    settings: &Settings,
) -> CandidateDecision {
    use CandidateDecision::{Rejected, Undecided};
    // A name that is still to be read may turn it, or another passage.
    let may_turn = bet.pending > 0 && sum.total() + weights::NAME * bet.pending >= least;
    if may_turn || bet.is_tracked_only {
        return Undecided;
    }
    // What nobody has read yet keeps a place from being a loop, and speaks against none.
    let unread = sum.of(EvidenceKind::Unread);
    if unread < LogOdds::EVEN && sum.total() - unread > -least {
        return Undecided;
    }
    if sum.total() - unread <= -least {
        return Rejected;
    }
    if sum.speaks_for() || sum.terms.iter().any(|(term, _)| term.kind == EvidenceKind::SharedName) {
        return Undecided;
    }
    match settings.without_anchors {
        WithoutAnchors::Undecided | WithoutAnchors::Geometry if has_no_anchors(candidate) => Undecided,
        _ => Rejected,
    }
}

fn has_no_anchors(candidate: &Candidate) -> bool {
    candidate.anchors.as_ref().is_none_or(|anchors| anchors.in_query == 0 || anchors.in_candidate == 0)
}

/// Returns the reason: the term that weighs most against it, or what is missing.
fn reason(candidate: &Candidate, sum: &Sum, bet: &Bet, settings: &Settings) -> Reason {
    let confidence = sum.total().probability();
    let of = |code, detail: String| Reason {
        code,
        measured: Some(confidence),
        limit: Some(settings.loop_min_confidence),
        detail,
    };
    let against = sum.terms.iter().filter(|(term, weight)| {
        *weight < LogOdds::EVEN && !matches!(term.kind, EvidenceKind::Copy | EvidenceKind::Neighbour)
    });
    let heaviest = against.min_by_key(|(term, weight)| (term.kind == EvidenceKind::Unread, *weight));
    if let Some((term, _)) = heaviest {
        return match term.kind {
            EvidenceKind::OtherName => {
                let names = term.about.split_once(" / ").unwrap_or((&term.about, ""));
                of(ReasonCode::Contradiction, format!("reads {} where {} hung", names.0, names.1))
            }
            EvidenceKind::DisplacedName => {
                of(ReasonCode::AnchorsDisplaced, format!("{} would hang in two places", term.about))
            }
            EvidenceKind::Absent => of(
                ReasonCode::TooLittleEvidence,
                format!("the query reads {} that nobody read there", term.about),
            ),
            EvidenceKind::StrangeNames => of(
                ReasonCode::Contradiction,
                format!("one of the two shows {} that the other does not", term.about),
            ),
            EvidenceKind::Apart => of(
                ReasonCode::TooLittleEvidence,
                format!("the two cameras are {} apart: the robot is near that place, not at it", term.about),
            ),
            EvidenceKind::NoView => of(ReasonCode::TooFewInliers, term.about.clone()),
            EvidenceKind::Odometry => of(
                ReasonCode::OdometryDisagreesWithTransform,
                format!("its odometry says otherwise: {}", term.about),
            ),
            EvidenceKind::Unread => of(bet.missing, format!("not described yet: {}", term.about)),
            _ => of(ReasonCode::AmbiguousPlaces, format!("as likely as {}", term.about)),
        };
    }
    if let Some((term, _)) = sum.terms.iter().find(|(term, _)| term.kind == EvidenceKind::SharedName) {
        return of(ReasonCode::NotDistinctive, format!("{} hangs in several places", term.about));
    }
    if bet.is_tracked_only {
        let detail = "all that agrees was seen on this same pass: nothing shows that the robot came back";
        return of(ReasonCode::TrackedOnly, detail.to_owned());
    }
    if sum.terms.iter().any(|(term, _)| term.kind == EvidenceKind::Neighbour) {
        let detail = "the names say that it is near, and nothing that it is this very place";
        return of(ReasonCode::TooLittleEvidence, detail.to_owned());
    }
    if sum.of(EvidenceKind::Name) > LogOdds::EVEN {
        return of(
            ReasonCode::TooLittleEvidence,
            String::from("the name was read once, by a reader that was not confident"),
        );
    }
    if sum.speaks_for() {
        let detail =
            String::from("a copy of this place would show the same: no name or code tells the two apart");
        return of(ReasonCode::TooLittleEvidence, detail);
    }
    if bet.pending > 0 {
        return of(bet.missing, format!("not described yet: {}", counted(bet.pending, "anchor")));
    }
    if has_no_anchors(candidate) {
        let (in_query, in_candidate) =
            candidate.anchors.as_ref().map_or((0, 0), |anchors| (anchors.in_query, anchors.in_candidate));
        let detail = which_has_no_anchors(in_query, in_candidate);
        return of(ReasonCode::NoAnchors, detail.to_owned());
    }
    of(ReasonCode::TooLittleEvidence, String::from("nothing that is read in one is read in the other"))
}
