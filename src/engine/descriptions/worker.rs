//! The worker: asks models for missing descriptions and judgements, in the background (§IV-A.3).
//!
//! Missing descriptions follow from each map's index, so a crash loses nothing. An answer is on disk before it is used, so
//! nothing is paid for twice. [`super::round`] is its loop; this is the handle to it.

use std::collections::HashMap;
use std::sync::Mutex;
use std::sync::atomic::AtomicU64;

use super::background::Background;
use crate::domain::ids::MapId;
use crate::engine::lock::lock;
use crate::engine::maps::live::LiveMap;
use crate::store::MapKey;

/// The handle to the worker.
#[derive(Debug, Default)]
pub(in crate::engine) struct Worker {
    /// The handle to its loop.
    pub background: Background,
    /// The maps that were written to since the last round, each with its name and the newest version that was decided.
    pub(super) written: Mutex<HashMap<MapKey, (MapId, u64)>>,
    /// The number of jobs found and not done.
    pub open_jobs: AtomicU64,
}

impl Worker {
    /// Notes that a map was written to, and wakes the worker. The map is named because it may leave memory before the
    /// next round, which would not find it there.
    pub fn note_write(&self, live: &LiveMap) {
        lock(&self.written).insert(live.key, (live.id.clone(), live.newest_version()));
        self.background.wake();
    }
}
