//! What speaks against a loop that a client confirms: checks 1 and 3 of §V on the two keyframes it names.
//!
//! The client decides, and may know more: its own geometry, or a query of an earlier version. So nothing is refused. Bag of
//! words and geometry are left out, because their data lie on disk.

use crate::domain::bow::{BowVector, Score};
use crate::domain::change::Loop;
use crate::domain::loop_warning::{LoopWarning, LoopWarningCode};
use crate::domain::verdict::{CandidateDecision, Reason, ReasonCode, Verify};
use crate::recognition::loops::anchor_check::{AnchorCheck, Counts};
use crate::recognition::loops::decision::concluded_without_view;
use crate::recognition::loops::evidence;
use crate::recognition::loops::query::Query;
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
    let bow = BowVector::default();
    let query = Query::stored(index, closed.keyframe, &bow)?;
    let mut counts = Counts::around(index, &query.centre);
    // A warning does not depend on what the server has configured, only on the map.
    let check = AnchorCheck::new(index, &query, Verify::Anchors, &mut counts);
    let unchecked = evidence::unchecked(index, closed.candidate, Score::default(), 0.0)?;
    let candidate = check.check(closed.candidate, unchecked, &mut counts)?;
    let settings = &index.properties().settings;
    let by_anchors = concluded_without_view(&candidate, settings);
    let contradicts = |reason: &Reason| reason.code == ReasonCode::Contradiction;
    match by_anchors.reason {
        _ if by_anchors.decision == CandidateDecision::Loop => None,
        Some(reason) if contradicts(&reason) => {
            let detail = format!("the anchors around the two contradict each other: {}", reason.detail);
            warning(LoopWarningCode::AnchorsContradict, detail)
        }
        // The query that the loop names has seen more than its anchors.
        _ if closed.query.is_some() => None,
        Some(reason) => {
            let detail =
                format!("a loop query would not support it ({}): {}", reason.code.as_str(), reason.detail);
            warning(LoopWarningCode::NotSupported, detail)
        }
        None => None,
    }
}
