//! The server's clock, as rows keep it.

use std::time::{Duration, SystemTime, UNIX_EPOCH};

use revisit_core::domain::keyframe::Stamp;

fn since_1970() -> Duration {
    SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default()
}

/// Returns the second that it is now.
pub(crate) fn seconds_now() -> i64 {
    i64::try_from(since_1970().as_secs()).unwrap_or(i64::MAX)
}

/// Returns the microsecond that it is now.
pub(crate) fn micros_now() -> i64 {
    i64::try_from(since_1970().as_micros()).unwrap_or(i64::MAX)
}

/// Returns the moment of a microsecond since 1970.
pub(crate) fn stamp_of_micros(micros: i64) -> Stamp {
    Stamp { sec: micros.div_euclid(1_000_000), nanosec: micros.rem_euclid(1_000_000) as u32 * 1_000 }
}
