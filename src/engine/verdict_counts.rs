//! The number of loop queries answered, by verdict.

use std::sync::atomic::{AtomicU64, Ordering};

use crate::domain::verdict::Decision;

/// The counters behind [`VerdictCounts`].
#[derive(Debug, Default)]
pub(super) struct VerdictCounters([AtomicU64; 3]);

/// The number of loop queries answered since the start, by verdict.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct VerdictCounts([u64; 3]);

const DECISIONS: [Decision; 3] = [Decision::Loop, Decision::NoLoop, Decision::Undecided];

impl VerdictCounters {
    /// Counts one verdict.
    pub fn add(&self, decision: Decision) {
        self.0[place(decision)].fetch_add(1, Ordering::Relaxed);
    }

    /// Returns the counts as they are now.
    pub fn counts(&self) -> VerdictCounts {
        VerdictCounts(self.0.each_ref().map(|count| count.load(Ordering::Relaxed)))
    }
}

impl VerdictCounts {
    /// Returns each verdict with its count.
    pub fn each(self) -> [(Decision, u64); 3] {
        DECISIONS.map(|decision| (decision, self.0[place(decision)]))
    }
}

impl FromIterator<Decision> for VerdictCounts {
    fn from_iter<T: IntoIterator<Item = Decision>>(decisions: T) -> Self {
        let mut counts = Self::default();
        decisions.into_iter().for_each(|decision| counts.0[place(decision)] += 1);
        counts
    }
}

fn place(decision: Decision) -> usize {
    match decision {
        Decision::Loop => 0,
        Decision::NoLoop => 1,
        Decision::Undecided => 2,
    }
}
