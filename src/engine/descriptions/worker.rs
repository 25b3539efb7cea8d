//! The worker: asks models for missing descriptions and judgements, in the background (§IV-A.3).
//!
//! Missing descriptions follow from each map's index, so a crash loses nothing. An answer is on disk before it is used, so
//! nothing is paid for twice. [`super::round`] is its loop; this is the handle to it.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use tokio::sync::Notify;
use tokio::task::JoinHandle;
use tokio_util::sync::CancellationToken;

use super::written_maps::WrittenMaps;
use crate::engine::maps::live::LiveMap;

/// State that the loop shares with the handle to the worker.
#[derive(Clone, Debug, Default)]
pub(super) struct Signals {
    /// Notified when there may be work.
    pub wake: Arc<Notify>,
    /// The maps that were written to.
    pub written: Arc<WrittenMaps>,
    /// Cancelled at shutdown.
    pub stop: CancellationToken,
    /// The number of jobs found and not done.
    pub open_jobs: Arc<AtomicU64>,
}

/// The handle to the worker; by default, to one that does not run yet.
#[derive(Debug, Default)]
pub(in crate::engine) struct Worker {
    signals: Signals,
    running: Mutex<Option<JoinHandle<()>>>,
}

impl Worker {
    /// Starts the loop, which ends after [`Self::stop`].
    pub fn start(&self, rounds: impl Future<Output = ()> + Send + 'static) {
        let running = tokio::spawn(rounds);
        *self.running.lock().unwrap_or_else(PoisonError::into_inner) = Some(running);
    }

    /// Returns what the loop shares with this handle.
    pub(super) fn signals(&self) -> Signals {
        self.signals.clone()
    }

    /// Notes that a map was written to, and wakes the worker. The map is named because it may leave memory before the
    /// next round, which would not find it there.
    pub fn note_write(&self, live: &LiveMap) {
        self.signals.written.note(live);
        self.wake();
    }

    /// Wakes the worker: there may be work.
    pub fn wake(&self) {
        self.signals.wake.notify_one();
    }

    /// Returns the number of jobs found and not done.
    pub fn open_jobs(&self) -> u64 {
        self.signals.open_jobs.load(Ordering::Relaxed)
    }

    /// Stops taking jobs, and lets those in flight finish.
    pub async fn stop(&self) {
        self.signals.stop.cancel();
        let running = self.running.lock().unwrap_or_else(PoisonError::into_inner).take();
        if let Some(running) = running {
            let _ = running.await;
        }
    }
}
