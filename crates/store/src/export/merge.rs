//! A merge of sessions as it was sent.

use revisit_core::domain::change::SessionMerge;
use revisit_core::domain::ids::SessionSeq;
use revisit_core::domain::recorded::Recorded;
use revisit_core::domain::session_merge::SessionMergeRequest;

use super::operation_reader::{Export, Step};
use crate::StoreError;
use crate::rows::session_merge_rows::MergedSession;

impl Export {
    /// Takes a merge: keyframes before it are of the other session from here on. One of a
    /// session whose keyframes are all deleted is left out.
    pub(super) fn merge(&mut self, merge: SessionMerge) -> Result<Step, StoreError> {
        let SessionMerge { session, into, next_keyframe, into_from_session, map_points } = merge;
        if self.merges.merge(MergedSession { session, into, next_keyframe, is_open: false }) == 0 {
            return Ok(Step::LeftOut);
        }
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
