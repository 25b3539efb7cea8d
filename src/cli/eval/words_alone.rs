//! Words alone: the candidate with the most similar words, without geometry, at the best threshold given the ground
//! truth.
//!
//! A strong baseline: in a hotel whose rooms are furnished alike its best threshold is high, and the loops above it
//! are mostly correct. The candidates are those of our arm's run. As in `revisit replay`, a query whose best keyframe
//! is neither correct nor wrong is not scored at any threshold. The number of returns is therefore smaller than that
//! of the arms, and is printed.

use std::fmt::Write as _;

use super::files::Driven12;
use crate::cli::replay::score::{Accuracy, Best, Marked, bow_only};
use crate::hotel::method::Method;
use crate::hotel::run::{AnsweredQuery, WordsAlone};
use crate::hotel::scoring::paper::ORB_SLAM3_PRECISION;

/// Returns a line for each data set and each threshold rule.
pub(super) fn words_alone(drives: &[Driven12]) -> String {
    let mut text = String::from(
        "words alone, by query, with thresholds chosen by the ground truth; queries whose best keyframe is neither correct\n\
         nor wrong are not scored (as in `revisit replay`)\n",
    );
    for (dataset, _) in ORB_SLAM3_PRECISION {
        let of_dataset = drives.iter().filter(|driven| driven.result.printed.dataset == dataset);
        let ours = of_dataset.flat_map(|driven| &driven.arms).filter(|driven| driven.arm == Method::Ours);
        let marked: Vec<Marked> = ours.flat_map(|driven| &driven.asked).filter_map(marked).collect();
        if marked.is_empty() {
            continue;
        }
        let words = bow_only(&marked);
        let _ =
            writeln!(text, "{dataset}  every best candidate                {}", figures(&words.every_best));
        if let Some(best) = &words.best_f1 {
            let name = format!("best F1 (score >= {:.3})", best.threshold);
            let _ = writeln!(text, "{dataset}  {name:34}  {}", figures(&best.accuracy));
        }
        let (recall, returns) = (percent(words.recall_at_precision_1), words.every_best.with_truth);
        let name = "no false loop";
        let _ =
            writeln!(text, "{dataset}  {name:34}  precision 100.0 %, recall {recall} of {returns} returns");
    }
    text
}

/// Returns a query as it is scored; none if its best is neither correct nor wrong.
fn marked(asked: &AnsweredQuery) -> Option<Marked> {
    let best = match asked.words {
        WordsAlone::Unscored => return None,
        WordsAlone::Nothing => None,
        WordsAlone::Names(ranked) => Some(Best { correct: ranked.is_right, score: ranked.score }),
    };
    Some(Marked { has_truth: asked.scored.has_truth, best })
}

fn figures(accuracy: &Accuracy) -> String {
    let (precision, recall) = (percent(accuracy.precision), percent(accuracy.recall));
    format!("precision {precision}, recall {recall} of {} returns", accuracy.with_truth)
}

fn percent(share: Option<f64>) -> String {
    share.map_or_else(|| String::from("-"), |share| format!("{:.1} %", 100.0 * share))
}
