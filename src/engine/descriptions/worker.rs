//! The worker: asks models for missing descriptions and judgements, in the background (§IV-A.3).
//!
//! Missing descriptions follow from each map's index, so a crash loses nothing. An answer is on disk before it is used, so
//! nothing is paid for twice. [`super::round`] is its loop; this is the handle to it.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use tokio::sync::Notify;
use tokio::task::JoinHandle;
use tokio_util::sync::CancellationToken;

use super::round::{Round, Signals};
use super::written_maps::WrittenMaps;
use crate::engine::Service;
use crate::engine::maps::live::LiveMap;
use crate::llm::Models;

/// The handle to the worker.
#[derive(Debug)]
pub(in crate::engine) struct Worker {
    wake: Arc<Notify>,
    written: Arc<WrittenMaps>,
    stop: CancellationToken,
    open_jobs: Arc<AtomicU64>,
    running: Mutex<Option<JoinHandle<()>>>,
}

impl Worker {
    /// Creates a worker that does not run yet.
    pub fn new() -> Arc<Self> {
        Arc::new(Self {
            wake: Arc::default(),
            written: Arc::default(),
            stop: CancellationToken::new(),
            open_jobs: Arc::default(),
            running: Mutex::default(),
        })
    }

    /// Starts looking for work, until [`Self::stop`].
    pub fn start(&self, service: Service, models: Arc<Models>) {
        let running = tokio::spawn(self.round(service, models).run());
        *self.running.lock().unwrap_or_else(PoisonError::into_inner) = Some(running);
    }

    /// Returns the worker's loop, which runs one round after the other.
    pub(super) fn round(&self, service: Service, models: Arc<Models>) -> Round {
        let signals = Signals {
            wake: self.wake.clone(),
            written: self.written.clone(),
            stop: self.stop.clone(),
            open_jobs: self.open_jobs.clone(),
        };
        Round::new(service, models, signals)
    }

    /// Notes that a map was written to, and wakes the worker. The map is named because it may leave memory before the
    /// next round, which would not find it there.
    pub fn note_write(&self, live: &LiveMap) {
        self.written.note(live);
        self.wake();
    }

    /// Wakes the worker: there may be work.
    pub fn wake(&self) {
        self.wake.notify_one();
    }

    /// Returns the number of jobs found and not done.
    pub fn open_jobs(&self) -> u64 {
        self.open_jobs.load(Ordering::Relaxed)
    }

    /// Stops taking jobs, and lets those in flight finish.
    pub async fn stop(&self) {
        self.stop.cancel();
        let running = self.running.lock().unwrap_or_else(PoisonError::into_inner).take();
        if let Some(running) = running {
            let _ = running.await;
        }
    }
}
