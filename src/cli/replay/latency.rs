//! Latency: percentiles of response times.

use std::time::Duration;

use serde::Serialize;

/// Times of one kind of request, milliseconds.
#[derive(Clone, Debug, Default)]
pub(super) struct Times(Vec<f64>);

/// The percentiles; none without requests.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub(super) struct Latency {
    /// The median.
    pub p50: Option<f64>,
    /// The 99th percentile.
    pub p99: Option<f64>,
}

impl Times {
    pub fn add(&mut self, time: Duration) {
        self.0.push(time.as_secs_f64() * 1e3);
    }

    pub fn latency(mut self) -> Latency {
        self.0.sort_by(f64::total_cmp);
        Latency { p50: percentile(&self.0, 50), p99: percentile(&self.0, 99) }
    }
}

/// Returns a percentile of sorted figures, by nearest rank: always a measured figure.
pub(super) fn percentile(sorted: &[f64], percent: usize) -> Option<f64> {
    let rank = (sorted.len() * percent).div_ceil(100);
    sorted.get(rank.checked_sub(1)?).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn latency(milliseconds: impl IntoIterator<Item = u64>) -> Latency {
        let mut times = Times::default();
        for time in milliseconds {
            times.add(Duration::from_millis(time));
        }
        times.latency()
    }

    #[test]
    fn percentiles_are_nearest_ranks() {
        let check = |times: &[u64], p50, p99| {
            let p50 = Some(p50);
            let p99 = Some(p99);
            assert_eq!(latency(times.iter().copied()), Latency { p50, p99 });
        };
        check(&[7], 7.0, 7.0);
        check(&[2, 1], 1.0, 2.0);
        check(&[3, 1, 2], 2.0, 3.0);
        let hundred: Vec<u64> = (1..=100).rev().collect();
        check(&hundred, 50.0, 99.0);
    }

    #[test]
    fn without_requests_there_is_no_latency() {
        assert_eq!(latency([]), Latency::default());
    }
}
