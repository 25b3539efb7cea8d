//! A concurrency limit with a wait queue bounded in length and time.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use tokio::sync::{OwnedSemaphorePermit, Semaphore};

use crate::engine::{Result, ServiceError};

/// Longest time a request waits for a permit before it is rejected as overloaded.
const MAX_QUEUE_WAIT: Duration = Duration::from_secs(5);

/// A limit on how many callers hold a permit at once.
#[derive(Debug)]
pub(in crate::engine) struct ConcurrencyLimit {
    turns: Arc<Semaphore>,
    at_once: usize,
    waiting: AtomicUsize,
    waiting_max: usize,
    patience: Duration,
}

impl ConcurrencyLimit {
    pub fn new(at_once: usize, waiting_max: usize) -> Arc<Self> {
        let turns = Arc::new(Semaphore::new(at_once));
        Arc::new(Self { turns, at_once, waiting: AtomicUsize::new(0), waiting_max, patience: MAX_QUEUE_WAIT })
    }

    /// Returns how many are inside.
    pub fn inside(&self) -> usize {
        self.at_once.saturating_sub(self.turns.available_permits())
    }

    /// Returns how many wait.
    pub fn waiting(&self) -> usize {
        self.waiting.load(Ordering::Relaxed)
    }

    /// Waits for something else that keeps a request from its turn, such as a lock, or hears that it takes too long.
    pub async fn in_time<T>(waiting: impl Future<Output = T>) -> Result<T> {
        tokio::time::timeout(MAX_QUEUE_WAIT, waiting).await.map_err(|_| overloaded())
    }

    /// Waits its turn, or hears that it would take too long.
    pub async fn enter(&self) -> Result<OwnedSemaphorePermit> {
        if let Ok(permit) = self.turns.clone().try_acquire_owned() {
            return Ok(permit);
        }
        let waits = Waits::new(&self.waiting);
        if waits.before >= self.waiting_max {
            return Err(overloaded());
        }
        match tokio::time::timeout(self.patience, self.turns.clone().acquire_owned()).await {
            Ok(permit) => permit.map_err(|_| ServiceError::closed()),
            Err(_) => Err(overloaded()),
        }
    }

    /// Waits its turn however long it takes: for those who keep others waiting meanwhile, such as a stream of lines.
    pub async fn acquire_unbounded(&self) -> Result<OwnedSemaphorePermit> {
        let _waits = Waits::new(&self.waiting);
        self.turns.clone().acquire_owned().await.map_err(|_| ServiceError::closed())
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
        let gate = ConcurrencyLimit {
            patience: Duration::from_millis(10),
            ..Arc::into_inner(ConcurrencyLimit::new(1, 1)).unwrap()
        };
        let inside = gate.enter().await.unwrap();
        let (first, second) = tokio::join!(gate.enter(), gate.enter());
        let refused = |result: Result<_>| matches!(result, Err(ServiceError::Overloaded(_)));
        assert!(refused(first.map(drop)), "it has waited long enough");
        assert!(refused(second.map(drop)), "there was no room for it");
        drop(inside);
        assert!(gate.enter().await.is_ok());
    }
}
