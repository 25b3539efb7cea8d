//! Seeds: which random worlds a method may be tuned on, and which are kept for reporting alone.

use std::ops::Range;

/// The worlds of `eval hotel --worlds`, for tuning and for looking at.
pub const DEVELOPMENT: Range<u64> = 0..1_000;

/// The worlds of `eval hotel --worlds --held-out`, for reporting. Nothing is tuned on them (CONTRIBUTING.md), and none is
/// explained by `eval hotel --world`.
pub const HELD_OUT: Range<u64> = 1_000_000..1_001_000;
