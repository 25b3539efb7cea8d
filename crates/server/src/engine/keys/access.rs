//! Access: who is asking, and how much of it.

use std::num::NonZeroU32;
use std::sync::Arc;
use std::sync::atomic::{AtomicI64, AtomicU32, AtomicU64, Ordering};
use std::time::Duration;

use governor::clock::{Clock as _, DefaultClock};
use governor::{DefaultDirectRateLimiter, Quota, RateLimiter};

use crate::domain::key::{Action, Key, KeySeq};
use crate::store::Elsewhere;

/// Parts of a request, as rates are counted: a server that shares a rate with others counts a request for a little more than one.
const PARTS: u32 = 16;

/// How a key was used since a server started.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct KeyUse {
    /// Requests.
    pub requests: u64,
    /// When the last one came, in seconds since 1970; 0 without any.
    pub last_s: i64,
}

/// A key as the server holds it.
#[derive(Debug)]
pub struct HeldKey {
    /// The key.
    pub key: Key,
    rate: Option<DefaultDirectRateLimiter>,
    /// Requests that were admitted since the other servers were last told.
    admitted: AtomicU32,
    /// Requests since this server started, refused ones too.
    requests: AtomicU64,
    /// When the last one came, in seconds since 1970.
    used_s: AtomicI64,
    /// Parts of the rate that each request counts for: more while the key asks other servers, too.
    pub(super) counts_for: AtomicU32,
}

impl HeldKey {
    /// Holds a key, with its uses so far.
    pub(in crate::engine) fn new(key: Key, uses: KeyUse) -> Self {
        let parts = key.properties.rate_per_s.map(|rate| rate.saturating_mul(PARTS));
        Self {
            rate: parts.and_then(NonZeroU32::new).map(|parts| RateLimiter::direct(Quota::per_second(parts))),
            key,
            admitted: AtomicU32::new(0),
            requests: AtomicU64::new(uses.requests),
            used_s: AtomicI64::new(uses.last_s),
            counts_for: AtomicU32::new(PARTS),
        }
    }

    /// Returns how the key was used since this server started.
    pub(super) fn uses(&self) -> KeyUse {
        KeyUse {
            requests: self.requests.load(Ordering::Relaxed),
            last_s: self.used_s.load(Ordering::Relaxed),
        }
    }

    /// Takes the number of requests that were admitted of a key whose rate is limited, since this was last asked.
    pub(super) fn take_admitted(&self) -> Option<u32> {
        let admitted = self.admitted.swap(0, Ordering::Relaxed);
        self.rate.is_some().then_some(admitted)
    }

    /// Leaves the other servers what they admit, and this one its part of the rate at least.
    pub(super) fn share(&self, elsewhere: Elsewhere) {
        let rate = self.key.properties.rate_per_s.unwrap_or(1).max(1);
        self.counts_for.store(counts_for(rate, elsewhere), Ordering::Relaxed);
    }

    /// Counts one request, made in this second since 1970; if the key has had its share, when to come back.
    pub fn count(&self, now_s: i64) -> Result<(), Duration> {
        self.requests.fetch_add(1, Ordering::Relaxed);
        self.used_s.store(now_s, Ordering::Relaxed);
        let Some(rate) = &self.rate else { return Ok(()) };
        match rate.check_n(self.counts_for()) {
            Ok(Ok(())) => {
                self.admitted.fetch_add(1, Ordering::Relaxed);
                Ok(())
            }
            Ok(Err(wait)) => Err(wait.wait_time_from(DefaultClock::default().now())),
            // Never more than the rate.
            Err(_) => Err(Duration::from_secs(1)),
        }
    }

    /// Counts one request, and waits until the key may make it.
    pub async fn wait(&self) {
        if let Some(rate) = &self.rate {
            // One that never fits is not waited for.
            let _ = rate.until_n_ready(self.counts_for()).await;
            self.admitted.fetch_add(1, Ordering::Relaxed);
        }
    }

    fn counts_for(&self) -> NonZeroU32 {
        NonZeroU32::new(self.counts_for.load(Ordering::Relaxed)).unwrap_or(NonZeroU32::MIN)
    }
}

/// Returns how many parts of a rate a request counts for at a server, given what others admit: all together admit about the rate.
fn counts_for(rate: u32, elsewhere: Elsewhere) -> u32 {
    // Where all of them are asked for more than that, each has the same part.
    let part = rate / elsewhere.servers.saturating_add(1);
    let left = rate.saturating_sub(elsewhere.requests).max(part).max(1);
    let rate = rate.saturating_mul(PARTS);
    rate.div_ceil(left).clamp(PARTS.min(rate), rate)
}

/// Who is asking.
#[derive(Clone, Debug)]
pub enum Access {
    /// Anybody: this database never had a key, and only this machine reaches the server.
    Open,
    /// The holder of a key.
    Key(Arc<HeldKey>),
}

impl Access {
    /// Whether this may be done.
    pub fn may(&self, action: Action) -> bool {
        match self {
            Self::Open => true,
            Self::Key(held) => held.key.properties.actions.has(action),
        }
    }

    /// Returns the key's number, if there is one.
    pub fn key(&self) -> Option<KeySeq> {
        match self {
            Self::Open => None,
            Self::Key(held) => Some(held.key.seq),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns what each of some servers admits a second, of which each is asked for so many; all begin as if alone.
    fn settled(rate: u32, asked: &[u32]) -> Vec<u32> {
        let mut admitted: Vec<u32> = asked.iter().map(|asked| rate.min(*asked)).collect();
        for _ in 0..5 {
            let next = |(place, asked): (usize, &u32)| -> u32 {
                let others =
                    || (0..admitted.len()).filter(|other| *other != place).map(|other| admitted[other]);
                let elsewhere = Elsewhere {
                    requests: others().sum(),
                    servers: others().filter(|requests| *requests > 0).count() as u32,
                };
                (rate * PARTS / counts_for(rate, elsewhere)).min(*asked)
            };
            admitted = asked.iter().enumerate().map(next).collect();
        }
        admitted
    }

    #[test]
    fn servers_together_admit_about_the_rate_of_a_key() {
        assert_eq!(settled(100, &[1_000]), [100]);
        assert_eq!(settled(100, &[1_000, 0]), [100, 0]);
        assert_eq!(settled(100, &[1_000, 1_000]), [50, 50]);
        assert_eq!(settled(90, &[1_000, 1_000, 1_000]), [30, 30, 30]);
        // One that is asked for little leaves the rest to the other, as far as whole requests go.
        assert_eq!(settled(100, &[1_000, 10]), [88, 10]);
        assert_eq!(settled(1, &[10, 10]), [1, 1], "a request a second each is the least");
    }
}
