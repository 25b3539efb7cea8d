//! What speaks against a loop that a client confirms: checks 1 and 3 of §V on the two keyframes it names.
//!
//! The client decides, and may know more: its own geometry, or a query of an earlier version. So nothing is refused. Bag of
//! words and geometry are left out, because their data lie on disk.

use super::distinctiveness::PlaceCounts;
use super::worst_case::worst_case;
use crate::domain::change::Loop;
use crate::domain::loop_warning::{LoopWarning, LoopWarningCode};
use crate::domain::verdict::ReasonCode;
use crate::recognition::loops::anchor_check::judge_anchors;
use crate::recognition::loops::anchor_map::local_anchor_map;
use crate::recognition::loops::centre::Centre;
use crate::recognition::loops::comparison::compare;
use crate::recognition::loops::screening::{CandidateStage, Passed};
use crate::recognition::map::index::MapIndex;

/// Returns the warning about a loop that the index does not hold yet, if anything speaks against it.
pub fn loop_warning(index: &MapIndex, closed: &Loop) -> Option<LoopWarning> {
    let warning = |code, detail| Some(LoopWarning { code, detail });
    let (keyframe, candidate) = (&closed.keyframe_id, &closed.candidate_id);
    if index.covisibility().joins_by_sight(closed.keyframe, closed.candidate) {
        let detail = format!("{keyframe} and {candidate} are covisible: the present place, not a return");
        return warning(LoopWarningCode::AlreadyCovisible, detail);
    }
    let joins = |other: &&Loop| other.keyframe == closed.candidate || other.candidate == closed.candidate;
    if let Some(other) = index.loops_of(closed.keyframe).find(joins) {
        let detail = format!("{keyframe} and {candidate} are joined already, by {}", other.id);
        return warning(LoopWarningCode::AlreadyCovisible, detail);
    }
    let mut places = PlaceCounts::default();
    let centres = Centre::stored(index, closed.keyframe).zip(Centre::stored(index, closed.candidate));
    let (query, candidate) = centres?;
    let around_query = local_anchor_map(index, &query, &mut places);
    let around_candidate = local_anchor_map(index, &candidate, &mut places);
    let settings = &index.properties().settings;
    let comparison = compare(&around_query, &around_candidate, index, settings);
    let worst = index
        .model_away()
        .then(|| worst_case(index, &around_query, &around_candidate, &comparison))
        .flatten();
    // A warning does not depend on what the server has configured, only on the map.
    let missing = if index.model_away() { ReasonCode::LlmUnavailable } else { ReasonCode::NotDescribed };
    match judge_anchors(index, &comparison, worst, missing) {
        Ok(Passed { contradicted: Some(reason), .. }) if closed.query.is_none() => {
            let detail = format!("the anchors around the two contradict each other: {}", reason.detail);
            warning(LoopWarningCode::AnchorsContradict, detail)
        }
        Ok(Passed { stage: CandidateStage::AskGeometry, .. }) if closed.query.is_none() => {
            let detail =
                "there are no anchors to compare, and the loop names no query whose geometry verified it";
            warning(LoopWarningCode::NotSupported, detail.to_owned())
        }
        Ok(Passed { stage: CandidateStage::NeedsWitness, .. }) if closed.query.is_none() => {
            let detail =
                "only texts without an identifier agree, and the loop names no query that found a witness";
            warning(LoopWarningCode::NotSupported, detail.to_owned())
        }
        Ok(_) => None,
        Err((_, reason)) if reason.code == ReasonCode::Contradiction => {
            let detail = format!("the anchors around the two contradict each other: {}", reason.detail);
            warning(LoopWarningCode::AnchorsContradict, detail)
        }
        Err((_, reason)) => {
            let detail =
                format!("a loop query would not support it ({}): {}", reason.code.as_str(), reason.detail);
            warning(LoopWarningCode::NotSupported, detail)
        }
    }
}
