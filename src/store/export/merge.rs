//! A merge of sessions as it was sent.

use std::collections::HashMap;

use super::operation_reader::{Export, Step};
use crate::domain::ids::{KeyframeSeq, SessionSeq};
use crate::domain::recorded::Recorded;
use crate::domain::session_merge::{Renumbering, SessionMergeRequest};
use crate::geometry::{Pose, Sim3};
use crate::store::StoreError;
use crate::store::rows::operation_rows::Operation;
use crate::store::rows::session_merge_rows::{MergedSession, session_after};

/// The merges of sessions up to an operation, in their order, and how many exported keyframes each session has by then.
#[derive(Default)]
pub(super) struct Merges {
    all: Vec<MergedSession>,
    /// By merge, how many exported keyframes moved: one that moved none would change nothing where it is played again.
    moved: Vec<usize>,
    keyframes: HashMap<SessionSeq, usize>,
}

impl Merges {
    /// Counts a keyframe that is exported.
    pub(super) fn add_keyframe(&mut self, session: SessionSeq) {
        *self.keyframes.entry(session).or_default() += 1;
    }

    /// Returns the session that a keyframe is of by now.
    pub(super) fn session_of(&self, keyframe: KeyframeSeq, sent: SessionSeq) -> SessionSeq {
        session_after(&self.all, keyframe, sent)
    }

    /// Takes a merge, and returns how many exported keyframes it moves.
    fn merge(&mut self, merge: MergedSession) -> usize {
        let moved = self.keyframes.remove(&merge.session).unwrap_or(0);
        *self.keyframes.entry(merge.into).or_default() += moved;
        self.all.push(merge);
        self.moved.push(moved);
        moved
    }

    /// Takes the last merge of a session back, and returns how many exported keyframes it had moved.
    fn revoke(&mut self, session: SessionSeq) -> usize {
        let Some(at) = self.all.iter().rposition(|merge| merge.session == session) else { return 0 };
        let (merge, moved) = (self.all.remove(at), self.moved.remove(at));
        *self.keyframes.entry(merge.session).or_default() += moved;
        let of_into = self.keyframes.entry(merge.into).or_default();
        *of_into = of_into.saturating_sub(moved);
        moved
    }
}

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
