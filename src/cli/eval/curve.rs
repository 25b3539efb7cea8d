//! Curve: precision over recall by query, as the threshold of an arm's ranking score varies from strict to lenient.

use crate::cli::replay::score::{Best, Marked, accuracy, thresholds};
use crate::hotel::figures::Curve;
use crate::hotel::run::RunResult;
use crate::hotel::scoring::score::by_query;

/// Returns the curve of an arm over several runs, from the server's answers. A robot that waits for more keyframes to
/// agree works at another point, the operating point. Queries whose first candidate is neither correct nor wrong are
/// omitted.
pub(super) fn curve(drives: &[&RunResult]) -> Option<Curve> {
    let arm = drives.first()?.arm;
    let asked = || drives.iter().flat_map(|driven| &driven.asked);
    let marked = asked().map(|asked| {
        let best = asked.ranked.map(|ranked| Best { correct: ranked.is_right, score: ranked.score });
        Marked { has_truth: asked.scored.has_truth, best }
    });
    let marked: Vec<Marked> = marked.collect();
    // A score of zero accepts nothing.
    let accepting =
        thresholds(&marked, accuracy(&marked).with_truth).into_iter().filter(|at| at.threshold > 0.0);
    let points = accepting.filter_map(|at| Some((at.accuracy.recall?, at.accuracy.precision?)));
    let counts = by_query(&asked().map(|asked| asked.scored).collect::<Vec<_>>());
    Some(Curve {
        name: if arm.confirms() {
            format!("{}, before confirmation", arm.words())
        } else {
            (*arm.words()).to_owned()
        },
        points: points.collect(),
        operating_point: Some((counts.recall(), counts.precision())),
    })
}
