//! Answer memory: a bound on the bytes of large answers that their clients have not taken yet.
//!
//! An answer stays in memory until its last byte has left, and a client that does not read keeps it there. Where the
//! answers of all connections together would take more than is allowed, the connection that has taken nothing for longest
//! is closed for the new answer. Where all of them are being taken, the new one is refused.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use tokio::time::Instant;

use super::connection_limit::ConnectionSlot;

/// A client that has taken a piece within this time keeps its answer.
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
    /// The numbers grow with time: the first is the one of which nothing was taken for longest.
    answers: BTreeMap<u64, Leaving>,
    next: u64,
}

#[derive(Debug)]
struct Leaving {
    bytes: usize,
    taken: Instant,
    slot: Arc<ConnectionSlot>,
}

/// The place of one answer in the shared memory, until this is dropped.
#[derive(Debug)]
pub struct Share {
    memory: Arc<AnswerMemory>,
    number: u64,
}

impl AnswerMemory {
    /// Creates a memory of this many MiB.
    pub fn new(mebibytes: usize) -> Arc<Self> {
        Arc::new(Self { most: mebibytes.saturating_mul(1 << 20), held: Mutex::default() })
    }

    /// Takes memory for an answer, and says how many connections, whose clients take nothing, are closed for it.
    pub fn take(self: &Arc<Self>, bytes: usize, slot: &Arc<ConnectionSlot>) -> (Option<Share>, usize) {
        let mut held = self.lock();
        let mut evictions = 0;
        // An answer larger than the whole memory leaves when it is the only one.
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

    fn lock(&self) -> MutexGuard<'_, Holders> {
        // A table of numbers is whole after each of its operations.
        self.held.lock().unwrap_or_else(PoisonError::into_inner)
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
    /// Notes that the client has taken a piece.
    pub fn taken(&mut self) {
        let mut held = self.memory.lock();
        if let Some(leaving) = held.answers.remove(&self.number) {
            self.number = held.add(Leaving { taken: Instant::now(), ..leaving });
        }
    }
}

impl Drop for Share {
    fn drop(&mut self) {
        let mut held = self.memory.lock();
        // One that was evicted is not there any more.
        if let Some(leaving) = held.answers.remove(&self.number) {
            held.bytes -= leaving.bytes;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::http::connection::connection_limit::ConnectionSlots;

    /// Lets all answers look as if their clients had taken nothing for this long.
    fn age(memory: &AnswerMemory, by: Duration) {
        for leaving in memory.lock().answers.values_mut() {
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
        assert_eq!(memory.lock().bytes, 0);
        assert!(take(5 << 20, &a).is_some(), "alone, an answer may be larger");
    }
}
