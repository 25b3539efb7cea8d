//! Pressure: how much is being worked on, and what is left out when it is too much.
//!
//! | requests worked on, of `--max-requests` | what is left out |
//! |---|---|
//! | half | background work rests: triggered loop checks are passed over, the models' worker takes no new jobs, and a loop query's `max_wait_ms` is not waited for |
//! | three quarters | reads and questions are refused with 503; a map goes on being recorded |
//! | all | writes are refused with 503, too |
//!
//! Nothing queues in front of this: who is refused hears it at once, and comes back. What is admitted waits for its turn
//! at a [`super::gate`], which is bounded in number and time. Answers do not change under pressure: a verdict is the same
//! bytes or a 503, never a cheaper verdict.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// How much is being worked on.
#[derive(Debug)]
pub struct Pressure {
    working: AtomicUsize,
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
pub struct Turn {
    pressure: Arc<Pressure>,
    counts: AtomicBool,
}

impl Default for Pressure {
    fn default() -> Self {
        Self { working: AtomicUsize::new(0), most: AtomicUsize::new(usize::MAX) }
    }
}

impl Pressure {
    /// At most so many from now on.
    pub fn allow(&self, most: usize) {
        self.most.store(most, Ordering::Relaxed);
    }

    /// Begins to work on a request, unless there is too much.
    pub fn admit(self: &Arc<Self>, kind: Kind) -> Option<Turn> {
        let most = self.most.load(Ordering::Relaxed);
        let room = match kind {
            Kind::Read => most - most / 4,
            Kind::Write => most,
        };
        let more = |working: usize| (working < room).then_some(working + 1);
        self.working.fetch_update(Ordering::Relaxed, Ordering::Relaxed, more).ok()?;
        Some(Turn { pressure: self.clone(), counts: AtomicBool::new(true) })
    }

    /// Requests worked on.
    pub fn working(&self) -> usize {
        self.working.load(Ordering::Relaxed)
    }

    /// Is it time for background work to rest?
    pub fn is_high(&self) -> bool {
        let most = self.most.load(Ordering::Relaxed);
        // One request alone is no pressure, however small the limit.
        self.working() > 1 && self.working() >= most / 2
    }
}

impl Turn {
    /// It waits for its client, who may take long: it does not count meanwhile.
    pub fn pause(&self) {
        if self.counts.swap(false, Ordering::Relaxed) {
            self.pressure.working.fetch_sub(1, Ordering::Relaxed);
        }
    }

    /// Does not count while this goes on, which waits and does no work.
    pub async fn aside<T>(&self, waiting: impl Future<Output = T>) -> T {
        self.pause();
        let result = waiting.await;
        self.resume();
        result
    }

    /// It is worked on again. It was admitted: there may be more than the limit for a moment.
    pub fn resume(&self) {
        if !self.counts.swap(true, Ordering::Relaxed) {
            self.pressure.working.fetch_add(1, Ordering::Relaxed);
        }
    }
}

impl Drop for Turn {
    fn drop(&mut self) {
        self.pause();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn background_work_rests_first_then_reads_are_refused_and_writes_last() {
        let pressure = Arc::new(Pressure::default());
        pressure.allow(8);
        let mut turns: Vec<Turn> = (0..4).filter_map(|_| pressure.admit(Kind::Read)).collect();
        assert!(pressure.is_high());
        turns.extend((0..2).filter_map(|_| pressure.admit(Kind::Read)));
        assert!(pressure.admit(Kind::Read).is_none());
        turns.extend((0..2).filter_map(|_| pressure.admit(Kind::Write)));
        assert_eq!(turns.len(), 8);
        assert!(pressure.admit(Kind::Write).is_none());
        drop(turns);
        assert_eq!(pressure.working(), 0);
        assert!(!pressure.is_high());
    }

    #[test]
    fn who_waits_for_a_client_does_not_count() {
        let pressure = Arc::new(Pressure::default());
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
