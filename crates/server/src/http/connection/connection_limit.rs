//! Connection limit: evicts the longest-idle connection when all slots are in use.
//!
//! A connection either waits (for its client's first or next request) or works on one. When every slot is in use, a
//! new connection evicts the one that has waited longest, so idle connections cannot lock others out. If all of them
//! work, the new one is rejected.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};

use tokio::sync::{Notify, OwnedSemaphorePermit, Semaphore};
use tokio::time::Instant;

use crate::engine::lock::lock;

/// The slots of a server.
#[derive(Debug)]
pub struct ConnectionSlots {
    free: Arc<Semaphore>,
    /// The waiting connections by increasing number, the longest-waiting first.
    waiting: Mutex<BTreeMap<u64, Arc<Notify>>>,
    next: AtomicU64,
    open: AtomicUsize,
}

/// The result of a claim for a new connection.
pub enum SlotClaim {
    /// A free slot.
    Free(OwnedSemaphorePermit),
    /// The slot of an evicted connection, which has been notified.
    Instead,
    /// No slot.
    Full,
}

/// A connection's slot.
#[derive(Debug)]
pub struct ConnectionSlot {
    slots: Arc<ConnectionSlots>,
    phase: Mutex<Phase>,
    told: Arc<Notify>,
    requests: AtomicU64,
    _permit: OwnedSemaphorePermit,
}

/// The activity of a connection.
#[derive(Clone, Copy, Debug)]
pub enum Phase {
    /// It waits for its client.
    Waits {
        /// Whether nothing of the request has arrived, and others were answered before.
        idle: bool,
        /// The start of the wait.
        since: Instant,
        /// Its number in [`ConnectionSlots::waiting`].
        number: u64,
    },
    /// A request is in progress.
    Works,
}

impl ConnectionSlots {
    /// Creates a limiter with `count` slots.
    pub fn new(count: usize) -> Arc<Self> {
        Arc::new(Self {
            free: Arc::new(Semaphore::new(count.min(Semaphore::MAX_PERMITS))),
            waiting: Mutex::default(),
            next: AtomicU64::new(0),
            open: AtomicUsize::new(0),
        })
    }

    /// Claims a slot for a new connection, and notifies the evicted connection, if any.
    pub fn claim(&self) -> SlotClaim {
        if let Ok(permit) = self.free.clone().try_acquire_owned() {
            return SlotClaim::Free(permit);
        }
        match lock(&self.waiting).pop_first() {
            Some((_, told)) => {
                told.notify_one();
                SlotClaim::Instead
            }
            None => SlotClaim::Full,
        }
    }

    /// Takes the slot; after [`SlotClaim::Instead`], as soon as the evicted connection has closed.
    pub async fn acquire(
        self: &Arc<Self>,
        claimed: Option<OwnedSemaphorePermit>,
    ) -> Option<Arc<ConnectionSlot>> {
        let permit = match claimed {
            Some(permit) => permit,
            None => self.free.clone().acquire_owned().await.ok()?,
        };
        self.open.fetch_add(1, Ordering::Relaxed);
        let told = Arc::new(Notify::new());
        let phase = self.waits(&told, false);
        Some(Arc::new(ConnectionSlot {
            slots: self.clone(),
            phase: Mutex::new(phase),
            told,
            requests: AtomicU64::new(0),
            _permit: permit,
        }))
    }

    /// Returns the number of connections with a slot.
    pub fn open(&self) -> usize {
        self.open.load(Ordering::Relaxed)
    }

    fn waits(&self, told: &Arc<Notify>, idle: bool) -> Phase {
        let number = self.next.fetch_add(1, Ordering::Relaxed);
        lock(&self.waiting).insert(number, told.clone());
        Phase::Waits { idle, since: Instant::now(), number }
    }
}

impl ConnectionSlot {
    /// Returns the connection's activity.
    pub fn phase(&self) -> Phase {
        *lock(&self.phase)
    }

    /// Records the first bytes of a request. The connection keeps its position in the eviction order, because a byte
    /// now and then must not protect it from eviction.
    pub fn on_read(&self) {
        if let Phase::Waits { idle: idle @ true, since, .. } = &mut *lock(&self.phase) {
            (*idle, *since) = (false, Instant::now());
        }
    }

    /// Records that some of a response was received. This restarts the idle time, but keeps the position in the
    /// eviction order.
    pub fn speaks(&self) {
        if let Phase::Waits { idle: true, since, .. } = &mut *lock(&self.phase) {
            *since = Instant::now();
        }
    }

    /// Returns the number of requests that have arrived.
    pub fn requests(&self) -> u64 {
        self.requests.load(Ordering::Relaxed)
    }

    /// Records that a request has arrived.
    pub fn works(&self) {
        self.requests.fetch_add(1, Ordering::Relaxed);
        let was = std::mem::replace(&mut *lock(&self.phase), Phase::Works);
        if let Phase::Waits { number, .. } = was {
            lock(&self.slots.waiting).remove(&number);
        }
    }

    /// Records that the response has been sent.
    pub fn rests(&self) {
        let mut phase = lock(&self.phase);
        if matches!(*phase, Phase::Works) {
            *phase = self.slots.waits(&self.told, true);
        }
    }

    /// Requests that the connection be closed.
    pub fn request_close(&self) {
        self.told.notify_one();
    }

    /// Resolves when the connection is evicted.
    pub async fn close_requested(&self) {
        self.told.notified().await;
    }
}

impl Drop for ConnectionSlot {
    fn drop(&mut self) {
        self.works();
        self.slots.open.fetch_sub(1, Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn evicts_the_longest_idle_connection_and_never_a_busy_one() {
        let slots = ConnectionSlots::new(2);
        let (first, second) = (slots.acquire(None).await.unwrap(), slots.acquire(None).await.unwrap());
        first.works();
        first.rests();
        assert!(matches!(slots.claim(), SlotClaim::Instead));
        second.close_requested().await;
        drop(second);
        let third = slots.acquire(None).await.unwrap();
        first.works();
        third.works();
        assert!(matches!(slots.claim(), SlotClaim::Full));
        third.rests();
        assert!(matches!(slots.claim(), SlotClaim::Instead));
        third.close_requested().await;
        drop(third);
        assert_eq!(slots.open(), 1);
        assert!(matches!(slots.claim(), SlotClaim::Free(_)));
    }
}
