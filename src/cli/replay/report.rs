//! Report: all results of a recording, as the JSON object of `--json`.

use std::collections::BTreeMap;

use serde::Serialize;
use serde_json::{Map, Value};

use super::answered::Answered;
use super::arguments::ReplayArgs;
use super::frames::TransformErrors;
use super::latency::Latency;
use super::play::{Performed, Played};
use super::score::{Accuracy, BowOnly, accuracy, bow_only};
use crate::domain::verdict::Decision;

/// The score of a recording.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Report {
    pub recording: String,
    /// Settings changed for this replay.
    pub settings: Map<String, Value>,
    pub maps: usize,
    #[serde(flatten)]
    pub performed: Performed,
    /// Queries answered.
    pub queries: usize,
    /// Of the queries scored.
    #[serde(flatten)]
    pub accuracy: Accuracy,
    pub no_loop: usize,
    pub undecided: usize,
    /// Queries not scored: their best is neither correct nor wrong.
    pub ignored: usize,
    /// Queries not scored: the ground truth is unknown.
    pub unlabelled: usize,
    /// Queries, scored or not, whose `loops` include a keyframe that is neither true nor ignored.
    pub loops_wrong: usize,
    pub bow_only: BowOnly,
    /// Errors of the transformations of true loops, with `--frames`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub transform_errors: Option<TransformErrors>,
    /// Of the queries.
    pub latency_ms: Latency,
    /// Of writing keyframes.
    pub keyframe_latency_ms: Latency,
    pub reasons: Reasons,
    pub false_loops: Vec<Answered>,
    /// Queries with a true loop that were not accepted, with `--explain`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub missed: Option<Vec<Answered>>,
    /// Keyframes that the server already had: queries may have found keyframes of their future.
    pub replayed_keyframes: u64,
    /// Lines rejected, with `--keep-going`.
    pub failed: u64,
}

/// Number of rejections by each check.
#[derive(Clone, Debug, Default, Serialize)]
pub(super) struct Reasons {
    /// By the reason of each query that was not accepted.
    pub queries: BTreeMap<String, u64>,
    /// By the reason of each candidate that was not accepted.
    pub candidates: BTreeMap<String, u64>,
}

impl Report {
    pub fn new(args: &ReplayArgs, played: Played) -> Self {
        let queries = &played.queries;
        let count = |of: fn(&Answered) -> bool| queries.iter().filter(|query| of(query)).count();
        let service: Vec<_> = queries.iter().filter_map(Answered::service).collect();
        let bow_alone: Vec<_> = queries.iter().filter_map(Answered::bow_alone).collect();
        Self {
            recording: args.file.display().to_string(),
            settings: args.overrides.changes(),
            maps: played.maps.len(),
            performed: played.performed,
            queries: queries.len(),
            accuracy: accuracy(&service),
            no_loop: count(|query| query.verdict == Decision::NoLoop),
            undecided: count(|query| query.verdict == Decision::Undecided),
            ignored: count(Answered::is_ignored),
            unlabelled: count(|query| query.labels.is_none()),
            loops_wrong: count(Answered::has_wrong_loop),
            bow_only: bow_only(&bow_alone),
            transform_errors: played.frames.errors(),
            reasons: Reasons::of(queries),
            false_loops: those(queries, Answered::is_false_loop),
            missed: args.explain.then(|| those(queries, Answered::is_missed)),
            latency_ms: played.query_times.latency(),
            keyframe_latency_ms: played.keyframe_times.latency(),
            replayed_keyframes: played.replayed_keyframes,
            failed: played.failed,
        }
    }

    /// Returns the object on one line.
    pub fn to_json(&self) -> String {
        serde_json::to_string(self).expect("a report has string keys and finite numbers")
    }
}

impl Reasons {
    fn of(queries: &[Answered]) -> Self {
        let mut reasons = Self::default();
        for query in queries {
            if query.verdict != Decision::Loop {
                let code = query.reason.as_ref().map_or("none given", |reason| reason.code.0.as_str());
                *reasons.queries.entry(code.to_owned()).or_default() += 1;
            }
            for code in &query.candidate_reasons {
                *reasons.candidates.entry(code.as_str().to_owned()).or_default() += 1;
            }
        }
        reasons
    }
}

fn those(queries: &[Answered], of: fn(&Answered) -> bool) -> Vec<Answered> {
    queries.iter().filter(|query| of(query)).cloned().collect()
}
