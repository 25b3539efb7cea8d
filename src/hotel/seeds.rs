//! Seeds: the random worlds for tuning, and those held out for reporting.

use std::ops::Range;

/// The worlds of `eval hotel --worlds`, for tuning and inspection.
pub const DEVELOPMENT: Range<u64> = 0..1_000;

/// The worlds of `eval hotel --worlds --held-out`, for reporting only. They are never used for tuning
/// (CONTRIBUTING.md), and `eval hotel --world` does not explain them.
pub const HELD_OUT: Range<u64> = 1_000_000..1_001_000;
