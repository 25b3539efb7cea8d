//! A circuit breaker: a model that fails again and again is left alone for a while, then tried with one question.

use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use tokio::time::Instant;

use super::port::Fault;

/// Watches one model.
#[derive(Debug)]
pub struct Breaker {
    failures_max: u32,
    pause: Duration,
    state: Mutex<State>,
}

#[derive(Debug, Default)]
struct State {
    failures: u32,
    open_until: Option<Instant>,
    /// One question is under way to see whether the model is back.
    probing: bool,
}

/// A question that may be asked; tell how it went. Dropped without a word, it counts as neither.
#[derive(Debug)]
pub struct Admission<'a> {
    breaker: &'a Breaker,
    probes: bool,
}

impl Breaker {
    /// Creates a breaker that opens after a number of consecutive failures, for a time.
    pub fn new(failures_max: u32, pause: Duration) -> Self {
        Self { failures_max, pause, state: Mutex::default() }
    }

    /// Whether a question may be asked now.
    pub fn admit(&self) -> Result<Admission<'_>, Fault> {
        let mut state = self.lock();
        let Some(open_until) = state.open_until else {
            return Ok(Admission { breaker: self, probes: false });
        };
        if state.probing || Instant::now() < open_until {
            return Err(Fault::Away);
        }
        state.probing = true;
        Ok(Admission { breaker: self, probes: true })
    }

    /// Whether the model is away, as far as is known. Until a question was answered, it is.
    pub fn is_open(&self) -> bool {
        self.lock().open_until.is_some()
    }

    /// Returns how long until the model is tried again.
    pub fn closed_for(&self) -> Option<Duration> {
        let until = self.lock().open_until?;
        Some(until.saturating_duration_since(Instant::now()))
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        // Three plain values: whole after each assignment.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Admission<'_> {
    /// It was answered: the model is there.
    pub fn succeeded(self) {
        *self.breaker.lock() = State::default();
    }

    /// It was not.
    pub fn failed(self) {
        let mut state = self.breaker.lock();
        state.failures = state.failures.saturating_add(1);
        if self.probes || state.failures >= self.breaker.failures_max {
            state.open_until = Some(Instant::now() + self.breaker.pause);
        }
    }
}

impl Drop for Admission<'_> {
    fn drop(&mut self) {
        if self.probes {
            self.breaker.lock().probing = false;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ends the pause of a model that is away.
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
