//! The last step of §V and the answer: decides on a candidate by geometry, and by the sum of its evidence; and on the query by its
//! candidates.

use std::collections::BTreeMap;

use super::evidence;
use super::features::FeatureSet;
use super::geometry_check::{GeometryOutcome, PlacedQuery, check_geometry};
use super::letter;
use super::screening::{PreVerified, Screening, Stage};
use crate::domain::look_for::{LookFor, NearbySign};
use crate::domain::settings::Settings;
use crate::domain::verdict::{
    CLOSED_MAX, Candidate, CandidateDecision, ClosedLoop, Decision, EvidenceKind, GeometryStatus, Reason,
    ReasonCode, Verdict, Verify,
};
use crate::recognition::locate::explained_cells::cells;
use crate::recognition::locate::look_for::telling_signs;
use crate::recognition::odds::bet::Bet;
use crate::recognition::odds::conclusion::conclude;
use crate::recognition::odds::rivals::strongest_rival;
use crate::recognition::odds::sum::{Sum, ViewFound};
use crate::recognition::odds::why::why;

/// A candidate without anchors whose words score below this share of the reference score does not make the answer undecided.
pub(in crate::recognition) const UNDECIDED_MIN_SCORE_SHARE: f64 = 0.3;
/// Undecided candidates whose signs an answer names.
const OPEN_MAX: usize = 3;

/// A candidate after geometry.
#[derive(Clone, Debug)]
pub struct Concluded {
    /// With its verdict, but for rivals.
    pub candidate: Candidate,
    /// The sum of its evidence; none under the paper's method, or where an earlier check stopped it.
    pub sum: Option<Sum>,
}

/// Runs geometry on one candidate, and decides by what it found.
pub(super) fn verify_candidate(
    screening: &Screening,
    pre_verified: &PreVerified,
    asked: Option<&PlacedQuery<'_>>,
    features: &FeatureSet,
    seed: u64,
) -> Concluded {
    if pre_verified.stage == Stage::Stopped && pre_verified.bet.is_none() {
        return Concluded { candidate: pre_verified.candidate.clone(), sum: None };
    }
    let checked = match pre_verified.stage {
        Stage::Stopped => Err(evidence::NOT_ASKED),
        _ => check_geometry(screening, pre_verified, asked, features, seed),
    };
    let is_near_miss =
        screening.settings.is_ours() && checked.as_ref().is_ok_and(GeometryOutcome::is_near_miss);
    let concluded = conclude_view(screening, pre_verified, checked);
    if is_near_miss && concluded.candidate.decision != CandidateDecision::Loop {
        let asked = |neighbour| verify_candidate(screening, neighbour, asked, features, seed);
        if let Some(mut found) = pre_verified.neighbours.iter().map(asked).find(is_verified_loop) {
            found.candidate.geometry.reason = Some(evidence::stands_in(&concluded.candidate));
            return found;
        }
    }
    concluded
}

/// Decides on a candidate by what geometry found, or by what is missing for it.
pub(in crate::recognition) fn conclude_view(
    screening: &Screening,
    pre_verified: &PreVerified,
    checked: Result<GeometryOutcome, &'static str>,
) -> Concluded {
    let mut candidate = pre_verified.candidate.clone();
    candidate.geometry = match &checked {
        Ok(outcome) => evidence::geometry(&outcome.verification),
        Err(missing) => evidence::geometry_skipped(missing),
    };
    let Some(bet) = &pre_verified.bet else {
        letter::decide(screening, pre_verified, checked, &mut candidate);
        return Concluded { candidate, sum: None };
    };
    let sum = sum(screening, pre_verified, bet, checked.as_ref().ok());
    conclude(&mut candidate, &sum, bet, screening.verify, &screening.settings);
    Concluded { candidate, sum: Some(sum) }
}

/// Returns a candidate by its anchors alone.
pub(in crate::recognition) fn concluded_without_view(
    pre_verified: &PreVerified,
    settings: &Settings,
) -> Candidate {
    let mut candidate = pre_verified.candidate.clone();
    if let Some(bet) = &pre_verified.bet {
        conclude(&mut candidate, &bet.sum(None, settings), bet, Verify::Anchors, settings);
    }
    candidate
}

fn sum(
    screening: &Screening,
    pre_verified: &PreVerified,
    bet: &Bet,
    outcome: Option<&GeometryOutcome>,
) -> Sum {
    let view =
        outcome.map(|outcome| ViewFound { outcome, cells: common_cells(screening, pre_verified, outcome) });
    bet.sum(view, &screening.settings)
}

/// Whether a neighbour may stand in for a near miss: geometry on map points, and not its anchors alone, has found the place.
fn is_verified_loop(neighbour: &Concluded) -> bool {
    let Concluded { candidate, .. } = neighbour;
    let has_length = candidate.geometry.figures.as_ref().is_some_and(|figures| figures.covariance.is_some());
    candidate.decision == CandidateDecision::Loop
        && candidate.geometry.status == GeometryStatus::Verified
        && has_length
}

/// Returns the number of cells that the two images have in common: the smaller of the two sides.
fn common_cells(screening: &Screening, pre_verified: &PreVerified, outcome: &GeometryOutcome) -> usize {
    let cameras = screening.snapshot.as_ref().zip(pre_verified.snapshot.as_ref());
    cameras.map_or(0, |(own, other)| {
        let [in_query, in_candidate] = &outcome.verification.explained_pixels;
        cells(0, &own.camera, in_query).len().min(cells(0, &other.camera, in_candidate).len())
    })
}

/// Takes from each candidate what its strongest rival has.
pub(super) fn settle_odds(screening: &Screening, concluded: &mut [Concluded]) {
    let pre_verified = &screening.candidates;
    let sums: Vec<Option<Sum>> = concluded.iter().map(|one| one.sum.clone()).collect();
    let is_joined = |a: usize, b: usize| screening.joined.contains(&(a.min(b), a.max(b)));
    for at in 0..concluded.len() {
        if concluded[at].candidate.decision != CandidateDecision::Loop {
            continue;
        }
        let Some((rival, total)) = strongest_rival(&sums, at, is_joined) else { continue };
        let Some(mut sum) = sums[at].clone() else { continue };
        let name = concluded[rival].candidate.keyframe.to_string();
        sum.add(EvidenceKind::Rival, Vec::new(), name, -total);
        if let Some(bet) = &pre_verified[at].bet {
            conclude(&mut concluded[at].candidate, &sum, bet, screening.verify, &screening.settings);
        }
    }
}

fn reject(candidate: &mut Candidate, reason: Reason) {
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
    let share = if screening.settings.is_ours() { UNDECIDED_MIN_SCORE_SHARE } else { 0.0 };
    let least = share * candidate.bow.reference_score;
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
    let best = candidates.first();
    let look_for = match decision {
        Decision::Undecided => look_for(screening, &candidates),
        Decision::Loop | Decision::NoLoop => Vec::new(),
    };
    let why = why(decision, best, reason.as_ref(), &look_for);
    let confidence = best.and_then(|best| best.odds.as_ref()).map(|odds| odds.confidence);
    Verdict {
        map_version: screening.map_version,
        decision,
        why,
        confidence,
        best: loops.first().cloned(),
        loops,
        degraded: screening.degraded,
        has_twins: screening.twins > 0,
        excluded_covisible: screening.excluded_covisible,
        closed,
        reason,
        look_for,
        candidates,
    }
}

/// Returns the signs that would tell the likeliest of the undecided candidates from each other, or that it is the only one.
fn look_for(screening: &Screening, candidates: &[Candidate]) -> Vec<LookFor> {
    let nearby = |candidate: &Candidate| {
        let asked =
            screening.candidates.iter().find(|asked| asked.candidate.keyframe == candidate.keyframe)?;
        Some(asked.bet.as_ref()?.nearby.as_slice())
    };
    let open = candidates.iter().enumerate();
    let open = open.filter(|(_, candidate)| candidate.decision == CandidateDecision::Undecided);
    let places: Vec<(usize, &[NearbySign])> =
        open.take(OPEN_MAX).filter_map(|(at, candidate)| Some((at, nearby(candidate)?))).collect();
    telling_signs(&places)
}
