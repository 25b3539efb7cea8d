//! Table: the report for a person to read.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::{self, Display, Formatter};

use super::answered::{Answered, Figures};
use super::latency::Latency;
use super::report::{Reasons, Report};
use super::score::{Accuracy, BowOnly};
use crate::api::verdict::ReasonView;

impl Display for Report {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write_recording(f, self)?;
        write_accuracies(f, &self.accuracy, &self.bow_only)?;
        write_verdicts(f, self)?;
        write_reasons(f, &self.reasons)?;
        write_false_loops(f, self)?;
        write_missed(f, self)
    }
}

fn write_recording(f: &mut Formatter<'_>, report: &Report) -> fmt::Result {
    let performed = &report.performed;
    let contents = [
        (report.maps as u64, "map", "maps"),
        (performed.keyframes, "keyframe", "keyframes"),
        (performed.closed_loops, "closed loop", "closed loops"),
        (performed.pose_corrections, "pose correction", "pose corrections"),
        (performed.observation_changes, "change of observations", "changes of observations"),
        (performed.session_merges, "merge of sessions", "merges of sessions"),
        (performed.priors, "prior anchor", "prior anchors"),
        (performed.descriptions, "description by hand", "descriptions by hand"),
        (performed.judgements, "model verdict", "model verdicts"),
        (performed.deletions, "deletion", "deletions"),
        (report.queries as u64, "query", "queries"),
    ];
    let contents: Vec<String> = contents
        .into_iter()
        .filter(|(count, ..)| *count > 0)
        .map(|(count, one, many)| format!("{count} {}", if count == 1 { one } else { many }))
        .collect();
    write!(f, "{}: {}", report.recording, contents.join(", "))?;
    writeln!(f, " ({} with a true loop)", report.accuracy.with_truth)?;
    if !report.settings.is_empty() {
        let change = |(name, value)| format!("{name}={value}");
        let changes: Vec<String> = report.settings.iter().map(change).collect();
        writeln!(f, "with {}", changes.join(", "))?;
    }
    let notes = [
        (report.ignored as u64, "not scored: best is neither correct nor wrong"),
        (report.unlabelled as u64, "not scored: the ground truth is unknown"),
        (report.replayed_keyframes, "keyframes existed before: queries may have found later ones"),
        (report.failed, "lines refused"),
    ];
    for (count, note) in notes.into_iter().filter(|(count, _)| *count > 0) {
        writeln!(f, "{count} {note}")?;
    }
    writeln!(f)
}

fn write_accuracies(f: &mut Formatter<'_>, service: &Accuracy, bow: &BowOnly) -> fmt::Result {
    writeln!(f, "{:38}accepted  correct  precision   recall", "")?;
    write_accuracy(f, "Revisit", service)?;
    write_accuracy(f, "BoW alone, every best candidate", &bow.every_best)?;
    if let Some(best) = &bow.best_f1 {
        let name = format!("BoW alone, best F1 (score >= {:.3})", best.threshold);
        write_accuracy(f, &name, &best.accuracy)?;
    }
    let recall = share(bow.recall_at_precision_1);
    writeln!(f, "{:36}{:>30}{recall:>9}", "BoW alone, without false loops", "1.000")
}

fn write_accuracy(f: &mut Formatter<'_>, name: &str, accuracy: &Accuracy) -> fmt::Result {
    let (accepted, correct) = (accuracy.accepted, accuracy.correct);
    let (precision, recall) = (share(accuracy.precision), share(accuracy.recall));
    writeln!(f, "{name:36}{accepted:>10}{correct:>9}{precision:>11}{recall:>9}")
}

fn write_verdicts(f: &mut Formatter<'_>, report: &Report) -> fmt::Result {
    let (no_loop, undecided) = (report.no_loop, report.undecided);
    let loops = report.queries - no_loop - undecided;
    writeln!(f, "\nverdicts  {loops} loop, {no_loop} no_loop, {undecided} undecided")?;
    writeln!(f, "          {} of all queries, scored or not, include a wrong loop", report.loops_wrong)?;
    if let Some(errors) = &report.transform_errors {
        let (t, r) = (errors.translation_m, errors.rotation_deg);
        writeln!(
            f,
            "transform of {} true loops off by {:.3} m, {:.2} deg at the median ({:.3} m, {:.2} deg at p90)",
            errors.compared, t.median, r.median, t.p90, r.p90
        )?;
    }
    let (queries, keyframes) = (latency(report.latency_ms), latency(report.keyframe_latency_ms));
    writeln!(f, "latency   query {queries}; keyframe write {keyframes}")
}

fn write_reasons(f: &mut Formatter<'_>, reasons: &Reasons) -> fmt::Result {
    let codes = reasons.queries.keys().chain(reasons.candidates.keys());
    let codes: BTreeSet<&String> = codes.collect();
    if codes.is_empty() {
        return Ok(());
    }
    let of = |counts: &BTreeMap<String, u64>, code| counts.get(code).copied().unwrap_or_default();
    writeln!(f, "\n{:36}{:>10}{:>12}", "why not a loop", "queries", "candidates")?;
    for code in codes {
        let queries = of(&reasons.queries, code);
        let candidates = of(&reasons.candidates, code);
        writeln!(f, "{code:36}{queries:>10}{candidates:>12}")?;
    }
    Ok(())
}

fn write_false_loops(f: &mut Formatter<'_>, report: &Report) -> fmt::Result {
    if report.false_loops.is_empty() {
        return Ok(());
    }
    writeln!(f, "\nfalse loops: {}", report.false_loops.len())?;
    for line in &report.false_loops {
        let best = line.leading.as_ref().map_or("nothing".to_owned(), figures);
        writeln!(f, "  {} -> {best}", name(report, line))?;
    }
    Ok(())
}

fn write_missed(f: &mut Formatter<'_>, report: &Report) -> fmt::Result {
    let Some(missed) = &report.missed else {
        return Ok(());
    };
    writeln!(f, "\nwith a true loop, not accepted: {}", missed.len())?;
    for line in missed {
        let why = line.reason.as_ref().map_or("no reason given".to_owned(), sentence);
        let nearest = line.leading.as_ref().map_or("no candidate".to_owned(), figures);
        write!(f, "  {}  {}  {why}; {nearest}", name(report, line), line.verdict.as_str())?;
        writeln!(f, "{}", true_candidate(line))?;
    }
    Ok(())
}

/// Returns the reason that stopped the true candidate, if that is not the one just shown.
fn true_candidate(line: &Answered) -> String {
    match (&line.leading, &line.nearest_true) {
        (None, None) => String::new(),
        (_, None) => "; no true candidate".to_owned(),
        (Some(best), Some(right)) if best.keyframe == right.keyframe => " (true)".to_owned(),
        (_, Some(right)) => {
            let why = right.reason.as_ref().map_or(String::new(), sentence);
            format!("; true {} {why}", figures(right)).trim_end().to_owned()
        }
    }
}

/// Returns a keyframe's id, with its map where there are several.
fn name(report: &Report, line: &Answered) -> String {
    if report.maps > 1 { format!("{}/{}", line.map, line.keyframe) } else { line.keyframe.clone() }
}

fn figures(candidate: &Figures) -> String {
    let similarity = share(candidate.similarity);
    let (keyframe, bow_score) = (&candidate.keyframe, candidate.bow_score);
    let inliers = candidate.inliers.map_or_else(String::new, |inliers| format!(" inliers {inliers}"));
    format!("{keyframe} S {similarity} BoW {bow_score:.3}{inliers}")
}

fn sentence(reason: &ReasonView) -> String {
    let code = reason.code.0.as_str();
    match (reason.measured, reason.limit) {
        (Some(measured), Some(limit)) => format!("{code} {}/{}", number(measured), number(limit)),
        (Some(measured), None) => format!("{code} {}", number(measured)),
        (None, Some(limit)) => format!("{code} limit {}", number(limit)),
        (None, None) => code.to_owned(),
    }
}

/// Formats counts as integers, other figures with three decimals.
fn number(value: f64) -> String {
    if value.fract() == 0.0 { format!("{value}") } else { format!("{value:.3}") }
}

fn share(share: Option<f64>) -> String {
    share.map_or("n/a".to_owned(), |share| format!("{share:.3}"))
}

fn latency(latency: Latency) -> String {
    let time = |time: Option<f64>| time.map_or("n/a".to_owned(), |time| format!("{time:.1} ms"));
    format!("p50 {}, p99 {}", time(latency.p50), time(latency.p99))
}
