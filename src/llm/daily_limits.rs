//! Limits per day on calls and their cost, by the server and by key, and prices.

use crate::domain::key::KeySeq;

/// Prices. US dollars per million tokens equal millionths of a dollar per token.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prices {
    /// Per million input tokens.
    pub input_usd: f64,
    /// Per million output tokens.
    pub output_usd: f64,
}

impl Prices {
    /// Returns the cost of tokens, in millionths of a dollar, rounded up.
    pub fn microusd(self, input_tokens: u64, output_tokens: u64) -> i64 {
        (input_tokens as f64 * self.input_usd + output_tokens as f64 * self.output_usd).ceil() as i64
    }
}

/// Limits per day (UTC).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Limits {
    /// Millionths of a US dollar.
    pub microusd: Option<i64>,
    /// Calls.
    pub calls: Option<i64>,
}

/// A paying key, with its own limits beside the server's.
#[derive(Clone, Debug, PartialEq)]
pub struct Payer {
    /// The key.
    pub key: KeySeq,
    /// Its daily limits.
    pub limits: Limits,
}

impl Limits {
    /// Whether a day's usage exceeds these limits.
    pub(super) fn broken_by(self, day: Day) -> bool {
        let over = |limit: Option<i64>, sum: i64| limit.is_some_and(|limit| sum > limit);
        over(self.calls, day.calls) || over(self.microusd, day.microusd)
    }

    /// Whether a day's usage reaches these limits.
    pub(super) fn used_up_by(self, day: Day) -> bool {
        let over = |limit: Option<i64>, sum: i64| limit.is_some_and(|limit| sum >= limit);
        over(self.calls, day.calls) || over(self.microusd, day.microusd)
    }
}

/// The usage of a day so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Day {
    pub(super) calls: i64,
    /// Millionths of a US dollar.
    pub(super) microusd: i64,
}

impl Day {
    /// Returns the day with one more call.
    pub(super) fn and(self, microusd: i64) -> Self {
        Self { calls: self.calls + 1, microusd: self.microusd + microusd }
    }
}
