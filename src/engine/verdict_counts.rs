//! The number of loop queries answered, by verdict.

use crate::domain::verdict::Decision;

/// The number of loop queries answered since the start, by verdict.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct VerdictCounts([u64; Decision::ALL.len()]);

impl VerdictCounts {
    /// Counts one verdict.
    pub fn add(&mut self, decision: Decision) {
        self.0[decision as usize] += 1;
    }

    /// Returns each verdict with its count.
    pub fn each(self) -> [(Decision, u64); Decision::ALL.len()] {
        Decision::ALL.map(|decision| (decision, self.0[decision as usize]))
    }
}
