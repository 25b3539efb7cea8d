//! The queue of triggered loop checks: bounded in how many wait, and in how many are in flight.

use std::sync::Arc;

use tokio::sync::{Mutex, MutexGuard, OwnedSemaphorePermit, Semaphore, mpsc};

use crate::domain::ids::{KeyframeId, MapId};

/// Maximum triggered loop checks in flight. Further triggers are dropped; clients can still query.
const CHECKS_MAX: usize = 64;

/// Maximum triggers of model answers that wait to be taken. Further ones are dropped.
const QUEUE_MAX: usize = 256;

/// A keyframe to be checked.
pub(in crate::engine) type Trigger = (MapId, KeyframeId);

/// The triggered loop checks, and the queue of those that model answers cause.
#[derive(Debug)]
pub(in crate::engine) struct TriggerQueue {
    slots: Arc<Semaphore>,
    queue: mpsc::Sender<Trigger>,
    queued: Mutex<mpsc::Receiver<Trigger>>,
}

impl Default for TriggerQueue {
    fn default() -> Self {
        let (queue, queued) = mpsc::channel(QUEUE_MAX);
        Self { slots: Arc::new(Semaphore::new(CHECKS_MAX)), queue, queued: Mutex::new(queued) }
    }
}

impl TriggerQueue {
    /// Queues a trigger, or drops it when the queue is full: clients can still query.
    pub fn offer(&self, trigger: Trigger) {
        let _ = self.queue.try_send(trigger);
    }

    /// Returns the end of the queue at which triggers are taken, by one at a time.
    pub async fn queued(&self) -> MutexGuard<'_, mpsc::Receiver<Trigger>> {
        self.queued.lock().await
    }

    /// Takes the slot of a check, which is in flight until the slot is dropped; `None` if no slot is free.
    pub fn slot(&self) -> Option<OwnedSemaphorePermit> {
        self.slots.clone().try_acquire_owned().ok()
    }

    /// Returns how many triggers wait to be taken.
    pub fn waiting(&self) -> u64 {
        (QUEUE_MAX - self.queue.capacity().min(QUEUE_MAX)) as u64
    }

    /// Returns how many checks are in flight.
    pub fn under_way(&self) -> u64 {
        (CHECKS_MAX - self.slots.available_permits().min(CHECKS_MAX)) as u64
    }
}
