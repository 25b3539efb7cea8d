//! Counting of a release's uses: in memory and written behind, one job at a time.

use std::sync::Arc;

use super::live::LiveMap;
use crate::domain::ids::SessionId;
use crate::domain::keyframe::Stamp;
use crate::store::{Job, Store};

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
        store.committer().submit_held(job, &self.line, done);
    }
}
