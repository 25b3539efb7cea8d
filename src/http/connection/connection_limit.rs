//! Connection limit: evicts the longest-idle connection when all slots are in use.
//!
//! A connection either waits (for its client's first or next request) or works on one. When every seat is taken, a new
//! connection gets that of the one that has waited longest: a client that has opened connections and says nothing cannot
//! lock others out. When all are at work, the new one is refused.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use tokio::sync::{Notify, OwnedSemaphorePermit, Semaphore};
use tokio::time::Instant;

/// Every seat of a server.
#[derive(Debug)]
pub struct ConnectionSlots {
    free: Arc<Semaphore>,
    /// Those that wait for their clients, longest first; the numbers grow with time.
    waiting: Mutex<BTreeMap<u64, Arc<Notify>>>,
    next: AtomicU64,
    open: AtomicUsize,
}

/// What a new connection gets.
pub enum SlotClaim {
    /// A seat that nobody has.
    Free(OwnedSemaphorePermit),
    /// That of another, which has been told to go.
    Instead,
    /// None.
    Full,
}

/// A connection's seat.
#[derive(Debug)]
pub struct ConnectionSlot {
    slots: Arc<ConnectionSlots>,
    phase: Mutex<Phase>,
    told: Arc<Notify>,
    requests: AtomicU64,
    _permit: OwnedSemaphorePermit,
}

/// What a connection is about.
#[derive(Clone, Copy, Debug)]
pub enum Phase {
    /// It waits for its client; since when, and its number among those that wait.
    Waits {
        /// Nothing of the request has arrived, and others were answered before.
        idle: bool,
        /// Since when.
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

    /// Returns what a new connection gets; another may be told to go for it.
    pub fn claim(&self) -> SlotClaim {
        if let Ok(permit) = self.free.clone().try_acquire_owned() {
            return SlotClaim::Free(permit);
        }
        match self.lock().pop_first() {
            Some((_, told)) => {
                told.notify_one();
                SlotClaim::Instead
            }
            None => SlotClaim::Full,
        }
    }

    /// Sits down; after [`SlotClaim::Instead`] as soon as the other has gone.
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

    /// Connections that have a seat.
    pub fn open(&self) -> usize {
        self.open.load(Ordering::Relaxed)
    }

    fn waits(&self, told: &Arc<Notify>, idle: bool) -> Phase {
        let number = self.next.fetch_add(1, Ordering::Relaxed);
        self.lock().insert(number, told.clone());
        Phase::Waits { idle, since: Instant::now(), number }
    }

    fn lock(&self) -> MutexGuard<'_, BTreeMap<u64, Arc<Notify>>> {
        // A map is whole after each of its operations.
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl ConnectionSlot {
    /// Returns what the connection is about.
    pub fn phase(&self) -> Phase {
        *self.lock()
    }

    /// The first bytes of a request arrived. Its place among those that wait is kept: a byte now and then must not save
    /// a connection from giving way.
    pub fn on_read(&self) {
        if let Phase::Waits { idle: idle @ true, since, .. } = &mut *self.lock() {
            (*idle, *since) = (false, Instant::now());
        }
    }

    /// Some of an answer was taken: the client is not idle yet. Its place among those that wait is kept here, too.
    pub fn speaks(&self) {
        if let Phase::Waits { idle: true, since, .. } = &mut *self.lock() {
            *since = Instant::now();
        }
    }

    /// Requests that have arrived.
    pub fn requests(&self) -> u64 {
        self.requests.load(Ordering::Relaxed)
    }

    /// A request has arrived.
    pub fn works(&self) {
        self.requests.fetch_add(1, Ordering::Relaxed);
        let was = std::mem::replace(&mut *self.lock(), Phase::Works);
        if let Phase::Waits { number, .. } = was {
            self.slots.lock().remove(&number);
        }
    }

    /// The answer has left.
    pub fn rests(&self) {
        let mut phase = self.lock();
        if matches!(*phase, Phase::Works) {
            *phase = self.slots.waits(&self.told, true);
        }
    }

    /// Has the connection closed.
    pub fn request_close(&self) {
        self.told.notify_one();
    }

    /// Resolves when it has to give way.
    pub async fn close_requested(&self) {
        self.told.notified().await;
    }

    fn lock(&self) -> MutexGuard<'_, Phase> {
        // A value that is replaced as a whole.
        self.phase.lock().unwrap_or_else(PoisonError::into_inner)
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
    async fn who_has_waited_longest_gives_way_and_who_works_never_does() {
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
