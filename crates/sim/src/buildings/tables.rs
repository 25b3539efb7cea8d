//! Tables of the scores of many worlds.

use std::fmt::Write as _;

use super::kind::Kind;
use super::play::Played;
use super::reliability::{BINS, Bin, bins};
use super::score::Score;
use crate::hotel::scoring::score::confidence_interval;

/// Returns the table of loops: a row for each kind, and all of them together.
pub fn loops(kinds: &[Kind], played: &[Played]) -> String {
    let mut table = String::from(
        "                            by query                                           by visit          false in  sessions joined\n\
         kind           worlds queries   right near wrong  precision (old)  recall     right wrong  of      1,000  that never met\n",
    );
    let of_kind = |kind: &Kind| Score::of(played.iter().filter(|played| played.kind == *kind));
    let rows = kinds.iter().map(|kind| (kind.as_str(), of_kind(kind))).chain([("all", Score::of(played))]);
    for (name, score) in rows {
        let precision = percent(score.right, score.right + score.wrong);
        // By the old score what is near is wrong.
        let old = format!("({})", percent(score.right, score.right + score.near + score.wrong));
        let recall = percent(score.right, score.with_truth);
        let in_thousand = score.false_in_thousand();
        let Score { worlds, queries, right, near, wrong, joined, .. } = score;
        let Score { visits_right, visits_wrong, visits_with_truth, .. } = score;
        let _ = write!(
            table,
            "{name:<15}{worlds:>6}{queries:>8}{right:>8}{near:>5}{wrong:>6}{precision:>10}{old:>8}{recall:>8}"
        );
        let _ = writeln!(
            table,
            "{visits_right:>9}{visits_wrong:>6}{visits_with_truth:>5}{in_thousand:>10.1}{joined:>14}"
        );
    }
    let all = Score::of(played);
    let (low, high) = confidence_interval(all.right, all.right + all.wrong);
    let _ = writeln!(
        table,
        "\nprecision of all: Wilson's interval at 95 % is {:.1} to {:.1} %",
        100.0 * low,
        100.0 * high
    );
    table
}

/// Returns what the wrong loops rest on, most first.
pub fn causes(played: &[Played]) -> String {
    let mut causes: Vec<(String, u64)> = Score::of(played).causes.into_iter().collect();
    causes.sort_by(|a, b| b.1.cmp(&a.1).then_with(|| a.0.cmp(&b.0)));
    let mut table = String::from("wrong loops by what they rest on:\n");
    for (cause, count) in causes {
        let _ = writeln!(table, "{count:>6}  {cause}");
    }
    table
}

/// Returns how often the answers of `POST /v1/locate` are right, by the confidence that they say.
pub fn reliability(played: &[Played]) -> String {
    let mut table = String::from(
        "where am I?          all places                                  places that were mapped\n\
         confidence from   answers  said   right              answers  said   right\n",
    );
    let all = bins(played.iter().flat_map(|played| &played.located));
    let mapped = bins(played.iter().flat_map(|played| &played.located).filter(|located| located.is_mapped));
    for ((low, all), mapped) in BINS.iter().zip(all).zip(mapped) {
        let _ = writeln!(table, "{low:<15}{}    {}", cells(&all), cells(&mapped));
    }
    table
}

fn cells(bin: &Bin) -> String {
    let said = bin.mean_said().map_or_else(|| "-".to_owned(), |said| format!("{:.1}", 100.0 * said));
    let (low, high) = confidence_interval(bin.right, bin.answers);
    let interval = format!("[{:.1} {:.1}]", 100.0 * low, 100.0 * high);
    format!("{:>10}{said:>6}{:>8}{interval:>14}", bin.answers, percent(bin.right, bin.answers))
}

fn percent(part: u64, whole: u64) -> String {
    if whole == 0 { "-".to_owned() } else { format!("{:.1}", 100.0 * part as f64 / whole as f64) }
}
