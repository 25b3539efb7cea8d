//! Uses of a release that are not on disk yet: which robots asked it, and how often.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::sync::Mutex;

use crate::domain::ids::SessionId;
use crate::domain::keyframe::Stamp;
use crate::domain::release::ReleaseUse;
use crate::engine::lock::lock;
use crate::store::RELEASE_USES_MAX;

/// Uses that are not on disk yet.
#[derive(Debug, Default)]
pub(in crate::engine) struct ReleaseUses(Mutex<Waiting>);

#[derive(Debug, Default)]
struct Waiting {
    by_session: BTreeMap<SessionId, (u64, Stamp)>,
    /// Whether a job is on its way to the disk.
    is_writing: bool,
}

impl ReleaseUses {
    /// Counts a query. Of more robots at once than a release's list names, the last are not counted.
    pub fn add(&self, session: SessionId, at: Stamp) {
        let mut waiting = lock(&self.0);
        let is_full = waiting.by_session.len() >= RELEASE_USES_MAX as usize;
        match waiting.by_session.entry(session) {
            Entry::Occupied(mut uses) => *uses.get_mut() = (uses.get().0 + 1, at),
            Entry::Vacant(_) if is_full => {}
            Entry::Vacant(first) => drop(first.insert((1, at))),
        }
    }

    /// Takes what is to be written, unless a job is under way.
    pub fn take(&self) -> Option<Vec<ReleaseUse>> {
        let mut waiting = lock(&self.0);
        if waiting.is_writing || waiting.by_session.is_empty() {
            return None;
        }
        waiting.is_writing = true;
        let uses = std::mem::take(&mut waiting.by_session).into_iter();
        Some(uses.map(|(session, (queries, last))| ReleaseUse { session, queries, last }).collect())
    }

    /// Notes that the uses taken are on disk, or will never be.
    pub fn written(&self) {
        lock(&self.0).is_writing = false;
    }
}
