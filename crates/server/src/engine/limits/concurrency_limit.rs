//! A concurrency limit with a wait queue bounded in length and time.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::time::timeout;

use crate::engine::{Result, ServiceError};

/// Longest time a request waits for a permit before it is rejected as overloaded.
const MAX_QUEUE_WAIT: Duration = Duration::from_secs(5);

/// The longest that a request waits for its turn. It hears that there is too much to do if it would wait longer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::engine) struct Wait(Duration);

impl Wait {
    /// As long as a request waits at most.
    pub const BOUNDED: Self = Self(MAX_QUEUE_WAIT);
    /// As long as it takes: for those who keep others waiting meanwhile, such as a stream of lines.
    pub const UNBOUNDED: Self = Self(Duration::MAX);

    /// Waits for what keeps a request from its turn, such as a lock.
    pub async fn until<T>(self, waiting: impl Future<Output = T>) -> Result<T> {
        timeout(self.0, waiting).await.map_err(|_| overloaded())
    }
}

/// A limit on how many callers hold a permit at once.
#[derive(Debug)]
pub(in crate::engine) struct ConcurrencyLimit {
    turns: Arc<Semaphore>,
    at_once: usize,
    waiting: AtomicUsize,
    waiting_max: usize,
}

impl ConcurrencyLimit {
    pub fn new(at_once: usize, waiting_max: usize) -> Arc<Self> {
        let turns = Arc::new(Semaphore::new(at_once));
        Arc::new(Self { turns, at_once, waiting: AtomicUsize::new(0), waiting_max })
    }

    /// Returns how many are inside.
    pub fn inside(&self) -> usize {
        self.at_once.saturating_sub(self.turns.available_permits())
    }

    /// Returns how many wait.
    pub fn waiting(&self) -> usize {
        self.waiting.load(Ordering::Relaxed)
    }

    /// Waits its turn.
    pub async fn enter(&self, wait: Wait) -> Result<OwnedSemaphorePermit> {
        if let Ok(permit) = self.turns.clone().try_acquire_owned() {
            return Ok(permit);
        }
        let waits = Waits::new(&self.waiting);
        if wait != Wait::UNBOUNDED && waits.before >= self.waiting_max {
            return Err(overloaded());
        }
        wait.until(self.turns.clone().acquire_owned()).await?.map_err(|_| ServiceError::closed())
    }
}

fn overloaded() -> ServiceError {
    ServiceError::Overloaded("too many requests wait for their turn".to_owned())
}

/// Counts one who waits, until dropped: a client may go away while it waits.
struct Waits<'w> {
    waiting: &'w AtomicUsize,
    before: usize,
}

impl<'w> Waits<'w> {
    fn new(waiting: &'w AtomicUsize) -> Self {
        Self { before: waiting.fetch_add(1, Ordering::Relaxed), waiting }
    }
}

impl Drop for Waits<'_> {
    fn drop(&mut self) {
        self.waiting.fetch_sub(1, Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn the_queue_is_bounded_in_number_and_in_time() {
        let gate = ConcurrencyLimit::new(1, 1);
        let wait = Wait(Duration::from_millis(10));
        let inside = gate.enter(wait).await.unwrap();
        let (first, second) = tokio::join!(gate.enter(wait), gate.enter(wait));
        let refused = |result: Result<_>| matches!(result, Err(ServiceError::Overloaded(_)));
        assert!(refused(first.map(drop)), "it has waited long enough");
        assert!(refused(second.map(drop)), "there was no room for it");
        drop(inside);
        assert!(gate.enter(wait).await.is_ok());
    }
}
