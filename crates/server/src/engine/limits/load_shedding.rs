//! Load shedding: how much is being worked on, and what is left out when it is too much.
//!
//! | requests worked on, of `--max-requests` | what is left out |
//! |---|---|
//! | half | background work rests: triggered loop checks are passed over, the models' worker takes no new jobs, and a loop query's `max_wait_ms` is not waited for |
//! | three quarters | reads and questions beyond a quarter are refused with 503; a map goes on being recorded |
//! | three quarters, all writes | writes are refused with 503, too: the last quarter is for reads and questions |
//! | all | everything is refused with 503 |
//!
//! So neither kind can keep the other out: a fleet that writes more than can be stored still hears which keyframes are
//! loops, and one that asks too much is still recorded.
//!
//! Nothing queues in front of this: who is refused hears it at once, and comes back. What is admitted waits for its turn
//! at a [`super::concurrency_limit`], which is bounded in number and time. Answers do not change under pressure: a verdict is the same
//! bytes or a 503, never a cheaper verdict.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};

use crate::engine::lock::lock;

/// How much is being worked on.
#[derive(Debug)]
pub struct LoadShedding {
    /// Requests worked on, by kind.
    working: Mutex<[usize; 2]>,
    most: AtomicUsize,
}

/// What a request is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// It changes nothing, and can be asked again.
    Read,
    /// It brings something that its client may not keep.
    Write,
}

/// One request that is being worked on, until this is dropped.
#[derive(Debug)]
pub struct RequestPermit {
    pressure: Arc<LoadShedding>,
    kind: Kind,
    counts: AtomicBool,
}

impl Default for LoadShedding {
    fn default() -> Self {
        Self { working: Mutex::default(), most: AtomicUsize::new(usize::MAX) }
    }
}

impl LoadShedding {
    /// Sets the maximum of requests in flight.
    pub fn allow(&self, most: usize) {
        self.most.store(most, Ordering::Relaxed);
    }

    /// Begins to work on a request, unless there is too much.
    pub fn admit(self: &Arc<Self>, kind: Kind) -> Option<RequestPermit> {
        let mut working = lock(&self.working);
        let most = self.most.load(Ordering::Relaxed);
        let quarter = most / 4;
        let ([reads, writes], three_quarters) = (*working, most - quarter);
        let fits = match kind {
            Kind::Read => reads + writes < three_quarters || reads < quarter,
            Kind::Write => writes < three_quarters,
        };
        if !fits || reads + writes >= most {
            return None;
        }
        working[kind as usize] += 1;
        Some(RequestPermit { pressure: self.clone(), kind, counts: AtomicBool::new(true) })
    }

    /// Requests worked on.
    pub fn working(&self) -> usize {
        lock(&self.working).iter().sum()
    }

    /// Whether it is time for background work to rest.
    pub fn is_high(&self) -> bool {
        let most = self.most.load(Ordering::Relaxed);
        // One request alone is no pressure, however small the limit.
        let working = self.working();
        working > 1 && working >= most / 2
    }
}

impl RequestPermit {
    /// It waits for its client, who may take long: it does not count meanwhile.
    pub fn pause(&self) {
        if self.counts.swap(false, Ordering::Relaxed) {
            lock(&self.pressure.working)[self.kind as usize] -= 1;
        }
    }

    /// Does not count while this goes on, which waits and does no work.
    pub async fn release_while<T>(&self, waiting: impl Future<Output = T>) -> T {
        self.pause();
        let result = waiting.await;
        self.resume();
        result
    }

    /// It is worked on again. It was admitted: there may be more than the limit for a moment.
    pub fn resume(&self) {
        if !self.counts.swap(true, Ordering::Relaxed) {
            lock(&self.pressure.working)[self.kind as usize] += 1;
        }
    }
}

impl Drop for RequestPermit {
    fn drop(&mut self) {
        self.pause();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Admits as many of a kind as there is room for, at most eight.
    fn admit(pressure: &Arc<LoadShedding>, kind: Kind) -> Vec<RequestPermit> {
        (0..8).map_while(|_| pressure.admit(kind)).collect()
    }

    #[test]
    fn background_work_rests_first_then_reads_are_refused_and_writes_last() {
        let pressure = Arc::new(LoadShedding::default());
        pressure.allow(8);
        let mut turns: Vec<RequestPermit> = (0..4).filter_map(|_| pressure.admit(Kind::Read)).collect();
        assert!(pressure.is_high());
        turns.extend(admit(&pressure, Kind::Read));
        assert_eq!(turns.len(), 6);
        turns.extend(admit(&pressure, Kind::Write));
        assert_eq!(turns.len(), 8);
        assert!(pressure.admit(Kind::Read).is_none());
        drop(turns);
        assert_eq!(pressure.working(), 0);
        assert!(!pressure.is_high());
    }

    #[test]
    fn a_flood_of_writes_leaves_a_quarter_to_reads_and_no_more() {
        let pressure = Arc::new(LoadShedding::default());
        pressure.allow(8);
        let writes = admit(&pressure, Kind::Write);
        let reads = admit(&pressure, Kind::Read);
        assert_eq!((writes.len(), reads.len()), (6, 2));
        // Whatever ends, its place goes to its own kind.
        drop(writes);
        let writes = admit(&pressure, Kind::Write);
        drop(reads);
        let reads = admit(&pressure, Kind::Read);
        assert_eq!((writes.len(), reads.len()), (6, 2));
    }

    #[test]
    fn the_smallest_limit_lets_either_kind_in() {
        let pressure = Arc::new(LoadShedding::default());
        pressure.allow(1);
        for kind in [Kind::Read, Kind::Write] {
            assert_eq!(admit(&pressure, kind).len(), 1);
        }
    }

    #[test]
    fn a_request_that_waits_for_its_client_does_not_count() {
        let pressure = Arc::new(LoadShedding::default());
        pressure.allow(1);
        let slow = pressure.admit(Kind::Write).unwrap();
        slow.pause();
        slow.pause();
        let quick = pressure.admit(Kind::Write).unwrap();
        slow.resume();
        assert_eq!(pressure.working(), 2);
        drop((slow, quick));
        assert_eq!(pressure.working(), 0);
    }
}
