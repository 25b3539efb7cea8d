//! Merges of sessions that can be revoked still: nothing was written on top of them (M59).

use std::collections::{BTreeMap, BTreeSet};

use crate::domain::ids::{KeyframeSeq, SessionSeq};
use crate::domain::session_merge::MergeUndo;

/// A merge that can be revoked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OpenMerge {
    /// The session that it merged into.
    pub into: SessionSeq,
    /// The number that the next keyframe had. Two merges of one session differ in it, as the second has keyframes to merge.
    pub next_keyframe: KeyframeSeq,
}

/// The merges of a map that can be revoked, by the session that went.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct OpenMerges(BTreeMap<SessionSeq, OpenMerge>);

impl OpenMerges {
    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Returns the merge of a session.
    pub fn of(&self, session: SessionSeq) -> Option<OpenMerge> {
        self.0.get(&session).copied()
    }

    /// Returns the sessions whose merge is from or into one of these.
    pub fn touching(&self, written: &BTreeSet<SessionSeq>) -> Vec<SessionSeq> {
        let is_touched = |session: &SessionSeq, open: &OpenMerge| {
            written.contains(session) || written.contains(&open.into)
        };
        let touched = self.0.iter().filter(|(session, open)| is_touched(session, open));
        touched.map(|(session, _)| *session).collect()
    }

    pub(super) fn open(&mut self, undo: &MergeUndo) {
        let open = OpenMerge { into: undo.into, next_keyframe: undo.next_keyframe };
        self.0.insert(undo.session, open);
    }

    pub(super) fn close(&mut self, session: SessionSeq) {
        self.0.remove(&session);
    }
}
