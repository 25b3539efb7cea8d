//! "Is this keyframe a loop?": the whole funnel of §V on one screen.
//!
//! Checks 1 to 3 need the map and run under its lock ([`screen`]); what passes them and has features waits for
//! geometry, which needs descriptors from disk and no map ([`super::decision`]).

use super::anchor_check::{AnchorCheck, Counts};
use super::candidates::find_candidates;
use super::evidence;
use super::query::Query;
use super::screening::{CandidateStage, PreVerified, Screening};
use crate::domain::bow::Score;
use crate::domain::ids::KeyframeSeq;
use crate::domain::verdict::{Candidate, CandidateDecision, ReasonCode, Verify};
use crate::recognition::extensions::rivals::find_rivals;
use crate::recognition::extensions::tracked_path::TrackedPath;
use crate::recognition::extensions::witness::{loop_joins, odometry_agrees};
use crate::recognition::map::index::MapIndex;

/// Runs checks 1 to 3 at this version of the map. Pure: the same arguments give the same answer.
pub fn screen(index: &MapIndex, map_version: u64, query: &Query<'_>, verify: Verify) -> Screening {
    let mut counts = Counts::around(index, &query.centre);
    // Checks 1 and 2: not covisible, and alike by bag of words or by an anchor seen before.
    let proposals = find_candidates(index, query, &mut counts.places);
    // Check 3: the local anchor maps.
    let anchors = AnchorCheck::new(index, query, verify, &mut counts);
    let settings = &index.properties().settings;
    let min_score = settings.candidates_min_score_ratio * proposals.reference_score;
    let mut check = |keyframe, score| {
        let candidate = unchecked(index, keyframe, score, proposals.reference_score)?;
        Some(borne_out(index, query, anchors.check(keyframe, candidate, &mut counts)?))
    };
    let candidates = (proposals.candidates.iter()).filter_map(|proposal| {
        let (keyframe, score) = (proposal.keyframe, proposal.score);
        if proposal.by_words && score.value() < min_score {
            let candidate = unchecked(index, keyframe, score, proposals.reference_score)?;
            let reason = evidence::reason(ReasonCode::BowBelowReference, score.value(), min_score);
            return Some(PreVerified::stopped(keyframe, candidate, CandidateDecision::Rejected, reason));
        }
        let mut screened = check(keyframe, score)?;
        if screened.may_be_near_miss() {
            let of_place = proposal.neighbours.iter().filter(|(other, _)| !proposals.has(*other));
            screened.add_neighbours(of_place.filter_map(|(other, score)| check(*other, *score)).collect());
        }
        Some(screened)
    });
    let mut candidates: Vec<PreVerified> = candidates.collect();
    if verify != Verify::Anchors && query.sight.is_some() {
        find_rivals(index, &mut candidates, &mut counts.places);
    }
    Screening::of_candidates(index, map_version, query, verify, candidates)
}

/// Adds where odometry has a candidate, and lets it agree if odometry or a confirmed loop bears it out.
fn borne_out(index: &MapIndex, query: &Query<'_>, mut screened: PreVerified) -> PreVerified {
    if screened.standing == CandidateStage::Stopped {
        return screened;
    }
    let settings = &index.properties().settings;
    let tracked = query.keyframe.filter(|_| settings.odometry_max_drift_share > 0.0);
    screened.path = tracked.and_then(|query| TrackedPath::between(index, query, screened.keyframe));
    let is_borne_out = || {
        screened.path.is_some_and(|path| odometry_agrees(&path, &screened.compared, settings))
            || loop_joins(index, &query.centre.covisible, screened.keyframe)
    };
    if screened.standing == CandidateStage::NeedsWitness && is_borne_out() {
        screened.standing = CandidateStage::AnchorsAgree;
    }
    screened
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
        bow: evidence::bow(score, reference_score),
        anchors: None,
        geometry: evidence::geometry_skipped("an earlier check decided"),
        reason: None,
    })
}
