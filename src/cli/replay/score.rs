//! Score: precision and recall over the queries of a recording, of the service and of BoW alone.
//!
//! A query whose best is ignored is not scored: it counts neither as accepted nor as a loop to be found. Recall's
//! denominator is therefore the number of *scored* queries that have a true loop, reported as `with_truth`. It may
//! differ between methods that name a different best.

use serde::Serialize;

/// One scored method's answer to one query, with the ground truth.
#[derive(Clone, Debug)]
pub(in crate::cli) struct Marked {
    /// Whether the query has a true loop.
    pub has_truth: bool,
    /// The keyframe that the method names best, if any.
    pub best: Option<Best>,
}

/// The keyframe that a method names best.
#[derive(Clone, Copy, Debug)]
pub(in crate::cli) struct Best {
    pub correct: bool,
    /// The method's confidence.
    pub score: f64,
}

/// Precision and recall, with their counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub(in crate::cli) struct Accuracy {
    /// Loops reported.
    pub accepted: u64,
    /// Reported loops that are true.
    pub correct: u64,
    /// Queries scored that have a true loop.
    pub with_truth: u64,
    /// correct / accepted; none if nothing was accepted.
    pub precision: Option<f64>,
    /// correct / `with_truth`; none if no query has a true loop.
    pub recall: Option<f64>,
}

/// BoW alone, which has no threshold of its own: three ways to choose one by the ground truth.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub(in crate::cli) struct BowOnly {
    /// Accepting every best candidate.
    #[serde(flatten)]
    pub every_best: Accuracy,
    /// With the threshold of the best F1.
    pub best_f1: Option<AtThreshold>,
    /// The largest recall that a threshold reaches without a false loop.
    pub recall_at_precision_1: Option<f64>,
}

/// The result of accepting scores of at least `threshold`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(in crate::cli) struct AtThreshold {
    /// The lowest score accepted.
    pub threshold: f64,
    /// Harmonic mean of precision and recall.
    pub f1: f64,
    /// Precision and recall at it.
    #[serde(flatten)]
    pub accuracy: Accuracy,
}

/// Returns the accuracy of a method that accepts every best candidate.
pub(in crate::cli) fn accuracy(marked: &[Marked]) -> Accuracy {
    let best = || marked.iter().filter_map(|query| query.best);
    Accuracy::new(
        best().count() as u64,
        best().filter(|best| best.correct).count() as u64,
        marked.iter().filter(|query| query.has_truth).count() as u64,
    )
}

/// Returns the accuracy of BoW alone.
pub(in crate::cli) fn bow_only(marked: &[Marked]) -> BowOnly {
    let every_best = accuracy(marked);
    let thresholds = thresholds(marked, every_best.with_truth);
    let no_false_loop = thresholds
        .iter()
        .filter(|at| at.accuracy.precision == Some(1.0))
        .filter_map(|at| at.accuracy.recall)
        .fold(0.0, f64::max);
    BowOnly {
        every_best,
        // Of equal ones the highest threshold, which reports fewer false loops.
        best_f1: thresholds.iter().copied().reduce(|best, at| if at.f1 > best.f1 { at } else { best }),
        recall_at_precision_1: every_best.recall.map(|_| no_false_loop),
    }
}

/// Returns every distinct threshold, the scores themselves, in descending order.
pub(in crate::cli) fn thresholds(marked: &[Marked], with_truth: u64) -> Vec<AtThreshold> {
    let mut best: Vec<Best> = marked.iter().filter_map(|query| query.best).collect();
    best.sort_by(|a, b| b.score.total_cmp(&a.score));
    let mut correct = 0;
    let mut accepted = 0;
    best.chunk_by(|a, b| a.score == b.score)
        .map(|equal| {
            accepted += equal.len() as u64;
            correct += equal.iter().filter(|best| best.correct).count() as u64;
            let accuracy = Accuracy::new(accepted, correct, with_truth);
            AtThreshold { threshold: equal[0].score, f1: accuracy.f1(), accuracy }
        })
        .collect()
}

impl Accuracy {
    fn new(accepted: u64, correct: u64, with_truth: u64) -> Self {
        let share = |whole: u64| (whole > 0).then(|| correct as f64 / whole as f64);
        Self { accepted, correct, with_truth, precision: share(accepted), recall: share(with_truth) }
    }

    fn f1(&self) -> f64 {
        match self.accepted + self.with_truth {
            0 => 0.0,
            // 2PR / (P + R), in terms of the counts.
            sum => 2.0 * self.correct as f64 / sum as f64,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether there is a true loop; then the score of the best, and whether it is right.
    fn marked(queries: &[(bool, Option<(f64, bool)>)]) -> Vec<Marked> {
        let marked = |&(has_truth, best): &(bool, Option<(f64, bool)>)| Marked {
            has_truth,
            best: best.map(|(score, correct)| Best { correct, score }),
        };
        queries.iter().map(marked).collect()
    }

    #[test]
    fn precision_is_of_the_accepted_and_recall_of_the_queries_with_a_true_loop() {
        // Four with a true loop: found, found, confused, missed. Two without: accepted, left alone.
        let queries = marked(&[
            (true, Some((1.0, true))),
            (true, Some((1.0, true))),
            (true, Some((1.0, false))),
            (true, None),
            (false, Some((1.0, false))),
            (false, None),
        ]);
        let accuracy = accuracy(&queries);
        assert_eq!((accuracy.accepted, accuracy.correct), (4, 2));
        assert_eq!(accuracy.with_truth, 4);
        assert_eq!(accuracy.precision, Some(0.5));
        assert_eq!(accuracy.recall, Some(0.5));
    }

    #[test]
    fn a_share_of_nothing_is_not_a_number() {
        let silent = accuracy(&marked(&[(true, None)]));
        assert_eq!((silent.precision, silent.recall), (None, Some(0.0)));
        let no_truth = accuracy(&marked(&[(false, Some((1.0, false)))]));
        assert_eq!((no_truth.precision, no_truth.recall), (Some(0.0), None));
        assert_eq!(accuracy(&[]), Accuracy::default());
    }

    #[test]
    fn bow_alone_is_scored_at_three_thresholds() {
        // Sorted: 0.9 right, 0.8 right, 0.7 wrong, 0.6 right, 0.5 wrong, 0.4 wrong; 5 true loops.
        // F1 = 2 correct / (accepted + 5): 2/6, 4/7, 4/8, 6/9, 6/10, 6/11.
        let queries = marked(&[
            (true, Some((0.7, false))),
            (true, Some((0.9, true))),
            (false, Some((0.5, false))),
            (true, Some((0.6, true))),
            (true, Some((0.8, true))),
            (true, Some((0.4, false))),
            (false, None),
        ]);
        let bow = bow_only(&queries);
        assert_eq!(bow.every_best.precision, Some(3.0 / 6.0));
        assert_eq!(bow.every_best.recall, Some(3.0 / 5.0));
        let best = bow.best_f1.expect("a threshold");
        assert_eq!(best.threshold, 0.6);
        assert_eq!(best.f1, 6.0 / 9.0);
        assert_eq!(best.accuracy.precision, Some(3.0 / 4.0));
        assert_eq!(best.accuracy.recall, Some(3.0 / 5.0));
        assert_eq!(bow.recall_at_precision_1, Some(2.0 / 5.0));
    }

    #[test]
    fn equal_scores_are_accepted_together() {
        let queries = marked(&[(true, Some((0.5, true))), (true, Some((0.5, false)))]);
        let bow = bow_only(&queries);
        assert_eq!(bow.recall_at_precision_1, Some(0.0));
        assert_eq!(bow.best_f1.expect("a threshold").accuracy.precision, Some(0.5));
    }

    #[test]
    fn a_threshold_after_a_false_loop_may_not_be_called_precise() {
        let queries = marked(&[(true, Some((0.9, false))), (true, Some((0.8, true)))]);
        assert_eq!(bow_only(&queries).recall_at_precision_1, Some(0.0));
    }

    #[test]
    fn bow_alone_without_candidates_has_no_threshold() {
        let bow = bow_only(&marked(&[(true, None)]));
        assert_eq!(bow.best_f1, None);
        assert_eq!(bow.every_best.precision, None);
        assert_eq!(bow.recall_at_precision_1, Some(0.0));
        assert_eq!(bow_only(&[]), BowOnly::default());
    }
}
