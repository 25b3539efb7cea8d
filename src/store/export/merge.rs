//! A merge of sessions as it was sent.

use super::operation_reader::{Export, Step};
use crate::domain::ids::{KeyframeSeq, SessionSeq};
use crate::domain::recorded::Recorded;
use crate::domain::session_merge::{Renumbering, SessionMergeRequest};
use crate::geometry::{Pose, Sim3};
use crate::store::StoreError;
use crate::store::rows::operation_rows::Operation;
use crate::store::rows::session_merge_rows::MergedSession;

impl Export {
    /// Takes a merge: keyframes before it are of the other session from here on. One of a
    /// session whose keyframes are all deleted is left out.
    pub(super) fn merge(&mut self, operation: Operation) -> Result<Step, StoreError> {
        let Operation::MergeSessions {
            session,
            into,
            next_keyframe,
            scale,
            translation,
            rotation,
            offset,
            listed,
        } = operation
        else {
            return Ok(Step::LeftOut);
        };
        let (session, into) = (SessionSeq(session), SessionSeq(into));
        let next_keyframe = KeyframeSeq(next_keyframe);
        if self.merges.merge(MergedSession { session, into, next_keyframe, is_open: false }) == 0 {
            return Ok(Step::LeftOut);
        }
        let into_from_session = Sim3::scaled(Pose::from_stored(translation, rotation), scale);
        let map_points = match (offset, listed) {
            (Some(offset), _) => Renumbering::Offset(offset),
            (None, Some(pairs)) => Renumbering::Listed(pairs),
            (None, None) => Renumbering::Same,
        };
        self.introduced.merge(session, into, &map_points);
        self.begun.insert(into);
        let (session, into) = (self.session(session)?.clone(), self.session(into)?.clone());
        Ok(Step::of(Recorded::SessionsMerged(SessionMergeRequest {
            session,
            into,
            into_from_session,
            map_points,
        })))
    }

    /// Takes a merge back, if it was exported: nothing was written on top of it.
    pub(super) fn revoke_merge(&mut self, session: SessionSeq) -> Result<Step, StoreError> {
        if self.merges.revoke(session) == 0 {
            return Ok(Step::LeftOut);
        }
        Ok(Step::of(Recorded::MergeRevoked(self.session(session)?.clone())))
    }
}
