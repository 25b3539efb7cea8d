//! Sizes: the amounts that are read, or wait for their rows, at a time.

use std::sync::atomic::{AtomicBool, Ordering};

/// Sizes of parts and pages.
#[derive(Debug)]
pub(crate) struct Sizes {
    /// Changes, or former values, of one part of the log.
    pub part: usize,
    /// The most that a batch's changes of poses and points may cost if written at once, in microseconds; above it they are deferred.
    pub direct_us: u64,
    /// Keyframes, and blocks of points, read at a time: few, because a row of 700 words takes as much as its keyframe does in the
    /// index.
    pub keyframes: i64,
    /// Detections read at a time. A map has many times more of them than keyframes, and each is small.
    pub detections: i64,
}

const USUAL: Sizes = Sizes { part: 128, direct_us: 20_000, keyframes: 256, detections: 4096 };

const SMALL: Sizes = Sizes { part: 4, direct_us: 100, keyframes: 4, detections: 5 };

static IS_SMALL: AtomicBool = AtomicBool::new(cfg!(test));

/// Returns how much is read, or waits, at a time.
pub(crate) fn sizes() -> &'static Sizes {
    if IS_SMALL.load(Ordering::Relaxed) { &SMALL } else { &USUAL }
}

/// Makes the sizes of this process so small that the small maps of tests take several steps, too.
#[doc(hidden)]
pub fn use_small_sizes() {
    IS_SMALL.store(true, Ordering::Relaxed);
}
