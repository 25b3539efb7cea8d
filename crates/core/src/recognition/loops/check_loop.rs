//! "Is this keyframe a loop?": §V from query to verdict, on one screen.
//!
//! Each step stands on a line that is marked with its name in the paper; what we add is marked with its entry in
//! `docs/method.md`.

use std::collections::BTreeSet;

use super::anchor_check::{AnchorCheck, Counts};
use super::candidates::find_candidates;
use super::decision::{answer, settle_odds, settle_repeats, verify_candidate};
use super::evidence;
use super::features::FeatureSet;
use super::geometry_check::{Comparisons, PlacedQuery};
use super::query::Query;
use super::screening::{PreVerified, Screening};
use crate::domain::channel::Channel;
use crate::domain::verdict::{CandidateDecision, ReasonCode, Verdict, Verify};
use crate::recognition::map::index::MapIndex;

/// Decides whether a keyframe is a loop: checks 1 to 3 of §V, then geometry on the candidates that passed them and whose
/// features are given. `seed` is that of geometry's samples. Pure: the same arguments give the same verdict, to the bit.
///
/// A program that shares the map between threads calls the two halves: [`screen`] needs the map, and runs under its lock;
/// [`verify_and_decide`] needs the features alone.
pub fn check_loop(
    map: &MapIndex,
    query: &Query<'_>,
    verify: Verify,
    features: &FeatureSet,
    seed: u64,
) -> Verdict {
    /// The version that the verdict names, for programs without versions.
    const MAP_VERSION: u64 = 0;
    let screening = screen(map, MAP_VERSION, query, verify);
    verify_and_decide(screening, features, seed)
}

/// Runs checks 1 to 3 at this version of the map.
pub fn screen(map: &MapIndex, map_version: u64, query: &Query<'_>, verify: Verify) -> Screening {
    let settings = &map.properties().settings;
    let mut counts = Counts::around(map, &query.centre);
    // check 1: no keyframe that is covisible with the query (`Query::excludes`)
    // check 2: the best of each place by bag of words; by §III, those that show an anchor seen before; and ours, by global
    // descriptors (M54)
    let proposals = find_candidates(map, query, &mut counts.places);
    let min_score = settings.candidates_min_score_ratio * proposals.reference_score;
    // check 3, §V-A: the local anchor map around the query
    let anchors = AnchorCheck::new(map, query, verify, &mut counts);
    let mut check = |keyframe, score, channels: &[Channel]| {
        let candidate = proposals.unchecked(map, keyframe, score, channels)?;
        // check 3, §V-A: the local anchor map around the candidate; §V-B: Eq. (1) and Eq. (2) between the two
        anchors.check(keyframe, candidate, &mut counts)
    };
    let candidates = proposals.candidates.iter().filter_map(|proposal| {
        let (keyframe, score) = (proposal.keyframe, proposal.score);
        // check 2: no less alike than the query's own neighbours are, or a share of it (M9)
        if proposal.is_gated() && score.value() < min_score {
            let candidate = proposals.unchecked(map, keyframe, score, &proposal.channels)?;
            let reason = evidence::reason(ReasonCode::BowBelowReference, score.value(), min_score);
            return Some(PreVerified::stopped(keyframe, candidate, CandidateDecision::Rejected, reason));
        }
        let mut pre_verified = check(keyframe, score, &proposal.channels)?;
        // ours: keyframes around a near miss, which geometry may ask in its place
        if pre_verified.may_be_near_miss() {
            let of_place = proposal.neighbours.iter().filter(|(other, _)| !proposals.has(*other));
            let checked = of_place.filter_map(|(other, score)| check(*other, *score, &proposal.channels));
            pre_verified.add_neighbours(checked.collect());
        }
        Some(pre_verified)
    });
    let candidates: Vec<PreVerified> = candidates.collect();
    let mut screening = Screening::of_candidates(map, map_version, query, verify, candidates);
    screening.joined = joined(map, &screening.candidates);
    screening
}

/// Returns the pairs of candidates that are of one place: covisible, or near each other in one session's frame.
fn joined(map: &MapIndex, candidates: &[PreVerified]) -> BTreeSet<(usize, usize)> {
    let pairs = (0..candidates.len()).flat_map(|a| (a + 1..candidates.len()).map(move |b| (a, b)));
    let is_joined = |(a, b): &(usize, usize)| {
        let (a, b) = (candidates[*a].keyframe, candidates[*b].keyframe);
        map.are_near(a, b) || map.covisibility().joins(a, b)
    };
    pairs.filter(is_joined).collect()
}

/// Runs geometry on the candidates that passed checks 1 to 3, and decides.
pub fn verify_and_decide(screening: Screening, features: &FeatureSet, seed: u64) -> Verdict {
    let of_query = match screening.query {
        Some(seq) => features.stored.get(&seq),
        None => features.inline.as_ref(),
    };
    let comparisons = Comparisons::default();
    let seeing = screening.snapshot.as_ref().zip(of_query.map(AsRef::as_ref));
    let asked = seeing.map(|seeing| PlacedQuery::new(seeing, &comparisons));
    // the last step: geometric verification; and ours, the anchors under its transformation
    let verify = |pre_verified| verify_candidate(&screening, pre_verified, asked.as_ref(), features, seed);
    let mut verified: Vec<_> = screening.candidates.iter().map(verify).collect();
    // M64: other places of the map that are as likely
    settle_odds(&screening, &mut verified);
    // M63: a robot closes a return once
    let closed = settle_repeats(&screening.candidates, &mut verified);
    let mut candidates: Vec<_> = verified.into_iter().map(|one| one.candidate).collect();
    // One keyframe may stand in for two places that it is covisible with.
    let mut known = BTreeSet::new();
    candidates.retain(|candidate| known.insert(candidate.keyframe.clone()));
    candidates.sort_by(evidence::best_first);
    // the answer: a loop if one candidate is left that all checks let pass
    answer(&screening, candidates, closed)
}
