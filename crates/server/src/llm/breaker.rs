//! Circuit breaker: a repeatedly failing model is not called for a while, then probed with one question.

use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use tokio::sync::{Semaphore, SemaphorePermit};
use tokio::time::Instant;

use super::port::Fault;

/// The state of one model.
#[derive(Debug)]
pub struct Breaker {
    failures_max: u32,
    pause: Duration,
    state: Mutex<State>,
    /// One permit, for the one probe that may be in flight.
    probe: Semaphore,
}

#[derive(Debug, Default)]
struct State {
    failures: u32,
    open_until: Option<Instant>,
}

/// An admitted question, whose outcome must be reported. Dropped without a report, it counts as neither.
#[derive(Debug)]
pub struct Admission<'a> {
    breaker: &'a Breaker,
    probe: Option<SemaphorePermit<'a>>,
}

impl Breaker {
    /// Creates a breaker that opens after a number of consecutive failures, for a time.
    pub fn new(failures_max: u32, pause: Duration) -> Self {
        Self { failures_max, pause, state: Mutex::default(), probe: Semaphore::new(1) }
    }

    /// Admits a question, unless the breaker is open.
    pub fn admit(&self) -> Result<Admission<'_>, Fault> {
        let state = self.lock();
        let probe = match state.open_until {
            None => None,
            Some(open_until) if Instant::now() < open_until => return Err(Fault::Away),
            Some(_) => Some(self.probe.try_acquire().map_err(|_| Fault::Away)?),
        };
        Ok(Admission { breaker: self, probe })
    }

    /// Whether the model counts as unavailable, which holds until a question is answered.
    pub fn is_open(&self) -> bool {
        self.lock().open_until.is_some()
    }

    /// Returns the time until the model is probed.
    pub fn closed_for(&self) -> Option<Duration> {
        let until = self.lock().open_until?;
        Some(until.saturating_duration_since(Instant::now()))
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        // Two plain values, consistent after each assignment, so a poisoned lock is usable.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Admission<'_> {
    /// Reports an answer: the model is available.
    pub fn succeeded(self) {
        *self.breaker.lock() = State::default();
    }

    /// Reports a failure.
    pub fn failed(self) {
        let mut state = self.breaker.lock();
        state.failures = state.failures.saturating_add(1);
        if self.probe.is_some() || state.failures >= self.breaker.failures_max {
            state.open_until = Some(Instant::now() + self.breaker.pause);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ends the pause of an unavailable model.
    fn end_pause(breaker: &Breaker) {
        breaker.lock().open_until = Some(Instant::now());
    }

    #[test]
    fn it_opens_after_failures_in_a_row_and_lets_one_question_try() {
        let breaker = Breaker::new(3, Duration::from_secs(30));
        for _ in 0..2 {
            breaker.admit().expect("closed").failed();
        }
        breaker.admit().expect("closed").succeeded();
        for _ in 0..3 {
            assert!(!breaker.is_open());
            breaker.admit().expect("closed").failed();
        }
        assert!(breaker.is_open());
        assert_eq!(breaker.admit().err(), Some(Fault::Away));

        end_pause(&breaker);
        let probe = breaker.admit().expect("one may try");
        assert_eq!(breaker.admit().err(), Some(Fault::Away), "and only one");
        probe.failed();
        assert_eq!(breaker.admit().err(), Some(Fault::Away), "it failed: another pause");

        end_pause(&breaker);
        drop(breaker.admit().expect("one may try"));
        breaker.admit().expect("a probe that was given up leaves room for the next").succeeded();
        assert!(!breaker.is_open());
    }
}
