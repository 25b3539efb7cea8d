//! The worker: asks models for missing descriptions and judgements, in the background (§IV-A.3).
//!
//! Missing descriptions follow from each map's index, so a crash loses nothing. An answer is on disk before it is used, so
//! nothing is paid for twice. [`super::round`] is its loop; this has the handle to it, and to any runner in the
//! background.

use std::collections::HashMap;
use std::sync::Mutex;
use std::sync::atomic::AtomicU64;
use std::time::Duration;

use tokio::sync::Notify;
use tokio_util::sync::CancellationToken;
use tokio_util::task::AbortOnDropHandle;

use crate::domain::ids::MapId;
use crate::engine::lock::lock;
use crate::engine::maps::live::LiveMap;
use crate::store::MapKey;

/// Questions under way when the server stops may finish within this time. Answers so far are kept anyway.
const DRAIN: Duration = Duration::from_secs(8);

/// The handle to a runner; by default, to one that does not run yet.
#[derive(Debug, Default)]
pub(in crate::engine) struct Background {
    /// Notified when there may be work.
    pub(super) wake: Notify,
    /// Cancelled at shutdown.
    pub(super) stop: CancellationToken,
    running: Mutex<Option<AbortOnDropHandle<()>>>,
}

impl Background {
    /// Starts the runner, which ends after [`Self::stop`].
    pub fn start(&self, runner: impl Future<Output = ()> + Send + 'static) {
        *lock(&self.running) = Some(AbortOnDropHandle::new(tokio::spawn(runner)));
    }

    /// Looks for work now.
    pub fn wake(&self) {
        self.wake.notify_one();
    }

    /// Begins nothing more, and lets the questions under way finish.
    pub async fn stop(&self) {
        self.stop.cancel();
        let running = lock(&self.running).take();
        if let Some(running) = running {
            // It is aborted when its time is over.
            let _ = tokio::time::timeout(DRAIN, running).await;
        }
    }
}

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
