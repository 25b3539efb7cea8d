//! Merges of sessions that were met so far, and the sessions of exported keyframes.

use std::collections::HashMap;

use revisit_core::domain::ids::{KeyframeSeq, SessionSeq};

use crate::rows::session_merge_rows::{MergedSession, session_after};

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
    pub(super) fn merge(&mut self, merge: MergedSession) -> usize {
        let moved = self.keyframes.remove(&merge.session).unwrap_or(0);
        *self.keyframes.entry(merge.into).or_default() += moved;
        self.all.push(merge);
        self.moved.push(moved);
        moved
    }

    /// Takes the last merge of a session back, and returns how many exported keyframes it had moved.
    pub(super) fn revoke(&mut self, session: SessionSeq) -> usize {
        let Some(at) = self.all.iter().rposition(|merge| merge.session == session) else { return 0 };
        let (merge, moved) = (self.all.remove(at), self.moved.remove(at));
        *self.keyframes.entry(merge.session).or_default() += moved;
        let of_into = self.keyframes.entry(merge.into).or_default();
        *of_into = of_into.saturating_sub(moved);
        moved
    }
}
