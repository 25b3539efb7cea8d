//! Score: precision and recall, by query and by visit.
//!
//! By query as in `replay`. By visit as in the paper ("when the robot visited the rooms", §VI-A): a visit is a stay in
//! a room. Its answer is the loop with the most inliers that its robot accepted at any of its keyframes. Precision is
//! correct answers of all answers. Recall is visits with at least one correctly answered keyframe, of those to a room
//! visited before.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// The outcome of one query.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// No loop, correctly.
    RightlyNone,
    /// No loop, although there was one.
    Missed,
    /// A correct loop.
    Right,
    /// A wrong loop.
    Wrong,
    /// A loop with a keyframe that is neither correct nor wrong.
    Unscored,
}

/// One query of an experiment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Scored {
    /// The robot and the number of its visit to a room; none between rooms.
    pub visit: Option<(usize, usize)>,
    /// Whether that room was visited before.
    pub is_revisit: bool,
    /// Whether there was a true loop.
    pub has_truth: bool,
    /// The outcome.
    pub outcome: Outcome,
    /// The number of points that agree with the accepted loop: the server's inliers, or those of the robot's
    /// confirmation.
    pub inliers: u64,
}

/// Counts for precision and recall.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counts {
    /// Accepted loops.
    pub accepted: u64,
    /// Correct ones of these.
    pub right: u64,
    /// Queries or visits with a true loop.
    pub with_truth: u64,
    /// Those of these that were found.
    pub found: u64,
}

impl Counts {
    /// Returns the share of accepted loops that are correct; 1 if nothing was accepted.
    pub fn precision(&self) -> f64 {
        share(self.right, self.accepted)
    }

    /// Returns the share of true loops that were found; 1 if there were none.
    pub fn recall(&self) -> f64 {
        share(self.found, self.with_truth)
    }

    /// Adds two counts.
    pub fn plus(self, other: Self) -> Self {
        Self {
            accepted: self.accepted + other.accepted,
            right: self.right + other.right,
            with_truth: self.with_truth + other.with_truth,
            found: self.found + other.found,
        }
    }
}

/// Counts some queries, by query.
pub fn by_query(queries: &[Scored]) -> Counts {
    let mut counts = Counts::default();
    for query in queries.iter().filter(|query| query.outcome != Outcome::Unscored) {
        let right = u64::from(query.outcome == Outcome::Right);
        counts.accepted += right + u64::from(query.outcome == Outcome::Wrong);
        counts.right += right;
        counts.with_truth += u64::from(query.has_truth);
        counts.found += right;
    }
    counts
}

/// Counts the same queries, by visit.
pub fn by_visit(queries: &[Scored]) -> Counts {
    let mut visits: BTreeMap<(usize, usize), Vec<&Scored>> = BTreeMap::new();
    for query in queries {
        if let Some(visit) = query.visit {
            visits.entry(visit).or_default().push(query);
        }
    }
    let mut counts = Counts::default();
    for visit in visits.values() {
        let answers = visit.iter().filter(|query| matches!(query.outcome, Outcome::Right | Outcome::Wrong));
        // Of equals the first, so that the order of keyframes decides and not the order of a map.
        let answer = answers.rev().max_by_key(|query| query.inliers).map(|query| query.outcome);
        let right = answer == Some(Outcome::Right);
        counts.accepted += u64::from(answer.is_some());
        counts.right += u64::from(right);
        let is_revisit = visit.iter().any(|query| query.is_revisit);
        counts.with_truth += u64::from(is_revisit);
        counts.found += u64::from(is_revisit && visit.iter().any(|query| query.outcome == Outcome::Right));
    }
    counts
}

/// Computes Wilson's interval of a share at 95 % (E. B. Wilson, JASA 22, 1927).
pub fn confidence_interval(part: u64, whole: u64) -> (f64, f64) {
    const Z: f64 = 1.959_964;
    if whole == 0 {
        return (0.0, 1.0);
    }
    let (n, p) = (whole as f64, part as f64 / whole as f64);
    let middle = p + Z * Z / (2.0 * n);
    let spread = Z * (p * (1.0 - p) / n + Z * Z / (4.0 * n * n)).sqrt();
    let scale = 1.0 + Z * Z / n;
    (((middle - spread) / scale).max(0.0), ((middle + spread) / scale).min(1.0))
}

/// Returns the median of some figures, of an even number the upper one.
pub fn median(mut figures: Vec<f64>) -> Option<f64> {
    figures.sort_by(f64::total_cmp);
    figures.get(figures.len() / 2).copied()
}

/// Returns a share; 1 of nothing.
pub(super) fn share(part: u64, whole: u64) -> f64 {
    if whole == 0 { 1.0 } else { part as f64 / whole as f64 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn query(visit: usize, has_truth: bool, outcome: Outcome, inliers: u64) -> Scored {
        let visit = (visit > 0).then_some((0, visit));
        Scored { visit, is_revisit: has_truth, has_truth, outcome, inliers }
    }

    #[test]
    fn queries_and_visits_are_counted_apart() {
        use Outcome::{Missed, Right, RightlyNone, Unscored, Wrong};
        let queries = [
            query(0, false, RightlyNone, 0),
            query(0, false, Wrong, 30),
            query(1, false, Wrong, 20),
            query(1, false, RightlyNone, 0),
            query(2, true, Missed, 0),
            query(2, true, Right, 20),
            query(3, true, Right, 90),
            query(3, true, Wrong, 80),
            query(4, true, Right, 80),
            query(4, true, Wrong, 90),
            query(5, true, Unscored, 99),
            query(6, true, Missed, 0),
        ];
        let counts = by_query(&queries);
        assert_eq!(counts, Counts { accepted: 7, right: 3, with_truth: 7, found: 3 });
        let counts = by_visit(&queries);
        assert_eq!(counts, Counts { accepted: 4, right: 2, with_truth: 5, found: 3 });
    }

    #[test]
    fn an_interval_holds_its_share_and_narrows_with_more() {
        let (low, high) = confidence_interval(95, 100);
        assert!((low - 0.8882).abs() < 1e-3 && (high - 0.9785).abs() < 1e-3, "{low} {high}");
        let (low_of_more, high_of_more) = confidence_interval(950, 1000);
        assert!(low < low_of_more && high_of_more < high);
        assert_eq!(confidence_interval(0, 0), (0.0, 1.0));
    }
}
