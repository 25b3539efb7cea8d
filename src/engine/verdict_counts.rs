//! The number of loop queries answered, by verdict.

use crate::domain::verdict::Decision;

/// The number of loop queries answered since the start, by verdict.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct VerdictCounts([u64; 3]);

const DECISIONS: [Decision; 3] = [Decision::Loop, Decision::NoLoop, Decision::Undecided];

impl VerdictCounts {
    /// Counts one verdict.
    pub(super) fn add(&mut self, decision: Decision) {
        self.0[place(decision)] += 1;
    }

    /// Returns each verdict with its count.
    pub fn each(self) -> [(Decision, u64); 3] {
        DECISIONS.map(|decision| (decision, self.0[place(decision)]))
    }
}

impl FromIterator<Decision> for VerdictCounts {
    fn from_iter<T: IntoIterator<Item = Decision>>(decisions: T) -> Self {
        let mut counts = Self::default();
        decisions.into_iter().for_each(|decision| counts.add(decision));
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
