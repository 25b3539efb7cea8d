//! Access: who is asking, and how much of it.

use std::num::NonZeroU32;
use std::sync::Arc;
use std::time::Duration;

use governor::clock::{Clock as _, DefaultClock};
use governor::{DefaultDirectRateLimiter, Quota, RateLimiter};

use crate::domain::key::{Action, Key, KeySeq};

/// A key as the server holds it.
#[derive(Debug)]
pub struct HeldKey {
    /// The key.
    pub key: Key,
    rate: Option<DefaultDirectRateLimiter>,
}

impl HeldKey {
    pub(in crate::engine) fn new(key: Key) -> Self {
        let per_second = key.properties.rate_per_s.and_then(NonZeroU32::new);
        Self { rate: per_second.map(|rate| RateLimiter::direct(Quota::per_second(rate))), key }
    }

    /// Counts one request; if the key has had its share, when to come back.
    pub fn count(&self) -> Result<(), Duration> {
        let Some(rate) = &self.rate else { return Ok(()) };
        rate.check().map_err(|wait| wait.wait_time_from(DefaultClock::default().now()))
    }

    /// Counts one request, and waits until the key may make it.
    pub async fn wait(&self) {
        if let Some(rate) = &self.rate {
            rate.until_ready().await;
        }
    }
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
