//! One line for each verdict: what a list shows, long after the whole answer was dropped.

use super::ids::{KeyframeId, SessionId};
use super::keyframe::Stamp;
use super::reason::ReasonCode;
use super::verdict::{Decision, Verdict};

/// A verdict in a line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct VerdictLine {
    /// The keyframe that was asked about; none where it came with the query.
    pub keyframe: Option<KeyframeId>,
    /// The keyframe it came back to, or else the likeliest one.
    pub candidate: Option<KeyframeId>,
    /// The map's version that answered.
    pub map_version: u64,
    /// The answer.
    pub decision: Decision,
    /// The check that decided.
    pub reason: Option<ReasonCode>,
    /// One sentence for a person.
    pub why: String,
}

impl VerdictLine {
    /// Returns the line of an answer about a keyframe of the map, or about one that came with the query.
    pub fn of(keyframe: Option<&KeyframeId>, verdict: &Verdict) -> Self {
        // Candidates come the best first. One that is a loop has no reason.
        let likeliest = verdict.candidates.first();
        let stopped_by = likeliest.and_then(|candidate| candidate.reason.as_ref());
        Self {
            keyframe: keyframe.cloned(),
            candidate: verdict.best.as_ref().or(likeliest.map(|candidate| &candidate.keyframe)).cloned(),
            map_version: verdict.map_version,
            decision: verdict.decision,
            reason: verdict.reason.as_ref().or(stopped_by).map(|reason| reason.code),
            why: verdict.why.clone(),
        }
    }
}

/// A line of the list.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ListedVerdict {
    /// The query's id.
    pub query: String,
    /// When it was asked last, by the server's clock.
    pub asked: Stamp,
    /// The session of the keyframe that was asked about, while the map has it.
    pub session: Option<SessionId>,
    /// Whether the whole answer is still kept.
    pub is_whole: bool,
    /// The verdict itself.
    pub line: VerdictLine,
}

/// Which verdicts are listed: those that agree with each part that is given.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct VerdictFilter {
    /// The answer.
    pub decision: Option<Decision>,
    /// The check that decided.
    pub reason: Option<ReasonCode>,
    /// The session of the keyframe that was asked about.
    pub session: Option<SessionId>,
    /// The earliest time, in seconds since 1970.
    pub since_s: Option<i64>,
    /// The time before which they were asked, in seconds since 1970.
    pub until_s: Option<i64>,
}
