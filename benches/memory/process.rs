//! What the kernel knows of this process.

use std::fs;
use std::time::Duration;

/// Bytes of memory that are resident.
pub fn resident_bytes() -> u64 {
    let status = fs::read_to_string("/proc/self/status").expect("the kernel tells of this process");
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).expect("resident memory");
    let kib: u64 = line.trim().trim_end_matches(" kB").parse().expect("a number");
    kib * 1024
}

/// The time that this thread has run, which other processes do not stretch.
pub fn cpu_time() -> Duration {
    let times = fs::read_to_string("/proc/thread-self/schedstat").expect("the kernel tells of this thread");
    let nanoseconds = times.split(' ').next().and_then(|time| time.parse().ok()).expect("a number");
    Duration::from_nanos(nanoseconds)
}
