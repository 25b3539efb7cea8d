//! Uses of a release: which robots asked it, and how often. Counted in memory and written behind, one job at a time.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::sync::{Arc, Mutex};

use super::live::LiveMap;
use crate::domain::ids::SessionId;
use crate::domain::keyframe::Stamp;
use crate::domain::release::ReleaseUse;
use crate::engine::lock::lock;
use crate::store::{Job, RELEASE_USES_MAX, Store};

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

impl LiveMap {
    /// Counts a query that this release answered to a robot.
    pub fn count_use(self: &Arc<Self>, store: &Store, session: SessionId, at: Stamp) {
        self.uses.add(session, at);
        self.write_uses(store.clone());
    }

    fn write_uses(self: &Arc<Self>, store: Store) {
        if store.committer().refuses(false).is_some() || self.is_over() {
            return;
        }
        let Some(uses) = self.uses.take() else { return };
        let job = Job::CountUses { release: self.key, uses };
        let (live, after) = (self.clone(), store.clone());
        let done = move |_| {
            live.uses.written();
            live.write_uses(after);
        };
        // Nobody waits for it: it shares the sync of what comes next. After an erasure it would name what was erased.
        store.committer().submit_held(job, self.line(), done);
    }
}
