//! Answer memory: a limit on the bytes of large responses not yet received by their clients.
//!
//! A response stays in memory until its last byte is sent, so a client that does not read keeps it there. If all
//! responses together would exceed the limit, the connection stalled longest is closed for the new response. If none
//! is stalled, the new one is rejected.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use tokio::time::Instant;

use super::connection_limit::ConnectionSlot;
use crate::engine::lock::lock;

/// A client that has received a piece within this time keeps its response.
const STALLED_AFTER: Duration = Duration::from_secs(1);

/// The memory that large answers share.
#[derive(Debug)]
pub struct AnswerMemory {
    most: usize,
    held: Mutex<Holders>,
}

#[derive(Debug, Default)]
struct Holders {
    bytes: usize,
    /// By increasing number, so that the first is the one stalled longest.
    answers: BTreeMap<u64, Leaving>,
    next: u64,
}

#[derive(Debug)]
struct Leaving {
    bytes: usize,
    taken: Instant,
    slot: Arc<ConnectionSlot>,
}

/// One response's share of the memory, until this is dropped.
#[derive(Debug)]
pub struct Share {
    memory: Arc<AnswerMemory>,
    number: u64,
}

impl AnswerMemory {
    /// Creates a shared memory of this many MiB.
    pub fn new(mebibytes: usize) -> Arc<Self> {
        Arc::new(Self { most: mebibytes.saturating_mul(1 << 20), held: Mutex::default() })
    }

    /// Reserves memory for a response, and returns the number of stalled connections closed for it.
    pub fn take(self: &Arc<Self>, bytes: usize, slot: &Arc<ConnectionSlot>) -> (Option<Share>, usize) {
        let mut held = lock(&self.held);
        let mut evictions = 0;
        // A response larger than the whole memory is sent while it is the only one.
        while held.bytes > 0 && held.bytes.saturating_add(bytes) > self.most {
            let stalled = held.answers.first_entry().filter(|first| {
                let Leaving { taken, .. } = first.get();
                taken.elapsed() > STALLED_AFTER
            });
            let Some(stalled) = stalled else { return (None, evictions) };
            let evicted = stalled.remove();
            held.bytes -= evicted.bytes;
            evicted.slot.request_close();
            evictions += 1;
        }
        held.bytes += bytes;
        let number = held.add(Leaving { bytes, taken: Instant::now(), slot: slot.clone() });
        (Some(Share { memory: self.clone(), number }), evictions)
    }
}

impl Holders {
    fn add(&mut self, leaving: Leaving) -> u64 {
        self.next += 1;
        self.answers.insert(self.next, leaving);
        self.next
    }
}

impl Share {
    /// Records that the client has received a piece.
    pub fn taken(&mut self) {
        let mut held = lock(&self.memory.held);
        if let Some(leaving) = held.answers.remove(&self.number) {
            self.number = held.add(Leaving { taken: Instant::now(), ..leaving });
        }
    }
}

impl Drop for Share {
    fn drop(&mut self) {
        let mut held = lock(&self.memory.held);
        // An evicted one has already been removed.
        if let Some(leaving) = held.answers.remove(&self.number) {
            held.bytes -= leaving.bytes;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::http::connection::connection_limit::ConnectionSlots;

    /// Backdates all responses, as if their clients had been stalled for this long.
    fn age(memory: &AnswerMemory, by: Duration) {
        for leaving in lock(&memory.held).answers.values_mut() {
            leaving.taken = leaving.taken.checked_sub(by).unwrap();
        }
    }

    #[tokio::test]
    async fn evicts_the_answer_of_which_nothing_was_taken_for_longest_and_none_that_is_being_taken() {
        let slots = ConnectionSlots::new(8);
        let memory = AnswerMemory::new(1);
        let half = 512 << 10;
        let take = |bytes, slot: &Arc<ConnectionSlot>| memory.take(bytes, slot).0;
        let slot = async || slots.acquire(None).await.unwrap();
        let (a, b, c) = (slot().await, slot().await, slot().await);
        let mut first = take(half, &a).unwrap();
        let second = take(half, &b).unwrap();
        assert!(take(half, &c).is_none(), "both were begun a moment ago");
        age(&memory, 2 * STALLED_AFTER);
        first.taken();
        let third = take(half, &c).unwrap();
        b.close_requested().await;
        assert!(take(half, &c).is_none(), "all that is left is being taken");
        drop((second, third));
        assert!(take(half, &c).is_some());
        drop(first);
        assert_eq!(lock(&memory.held).bytes, 0);
        assert!(take(5 << 20, &a).is_some(), "alone, an answer may be larger");
    }
}
