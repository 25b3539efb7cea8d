//! Said: the changes of a version that its rows do not tell.

use std::borrow::Cow;
use std::collections::HashSet;

use revisit_core::domain::change::{Change, MergeUndo};
use revisit_core::domain::ids::{AnchorSeq, PointId, SessionSeq};

use crate::jobs::job::Batch;

/// Returns what part 0 of a version keeps: what rows do not tell, and of its poses and points those that replaced others.
pub(crate) fn said<'c>(batch: &'c Batch) -> Vec<Cow<'c, Change>> {
    let replaced: HashSet<(SessionSeq, PointId)> =
        batch.former.points.iter().map(|(session, id, _)| (*session, *id)).collect();
    let prior = |change: &Change| if let Change::PriorSet(anchor, _) = change { Some(*anchor) } else { None };
    let priors: HashSet<AnchorSeq> = batch.changes.iter().filter_map(prior).collect();
    let culls = batch.changes.iter().any(|change| matches!(change, Change::KeyframeRemoved(..)));
    let kept = |change: &'c Change| {
        let stays = match change {
            Change::PoseSet(..) => !batch.former.poses.is_empty(),
            Change::PointSet(session, id, _) => replaced.contains(&(*session, *id)),
            Change::AnchorAdded(anchor, _) => priors.contains(anchor),
            // One that went with its last keyframe was not deleted by anybody.
            Change::AnchorRemoved(_) => !culls,
            Change::MergeRevoked(undo) => {
                let named = MergeUndo::naming(undo.session, undo.into, undo.next_keyframe);
                return Some(Cow::Owned(Change::MergeRevoked(Box::new(named))));
            }
            Change::MapSet(_)
            | Change::ObservationsSent(_)
            | Change::SessionsMerged(_)
            | Change::LoopAdded(_)
            | Change::LoopRemoved(_)
            | Change::DescriptionSet(..)
            | Change::PriorSet(..) => true,
            _ => false,
        };
        stays.then_some(Cow::Borrowed(change))
    };
    batch.changes.iter().filter_map(kept).collect()
}
