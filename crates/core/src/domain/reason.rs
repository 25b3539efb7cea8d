//! Reason: the check that decided a verdict, and the one table of reason codes.
//!
//! The table below makes the enum, the names in the API document, the meanings there and in
//! `docs/reasons.md`, and the sentences of the viewer. A meaning is a sentence for people, in which
//! `{measured}`, `{limit}` and `{detail}` stand for the reason's own fields.

use self::ReasonCheck::{Anchors, Geometry, Query, Words};
use self::ReasonClass::{Depends, Rejects, Undecided, Waits};
use crate::named::{Named, named};

/// The check that decided, with what it measured and what it asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct Reason {
    /// The check.
    pub code: ReasonCode,
    /// The measured value, in the check's own unit.
    pub measured: Option<f64>,
    /// The limit that it was compared with.
    pub limit: Option<f64>,
    /// One sentence for a person.
    pub detail: String,
}

/// A reason code's words for people, beside its meaning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReasonWords {
    /// A few words, for a list.
    pub title: &'static str,
    /// The effect on the verdict.
    pub class: ReasonClass,
    /// The check that it belongs to.
    pub check: ReasonCheck,
}

named! {
    /// The effect of a reason on the verdict that gives it.
    ReasonClass {
        /// The candidate, or the whole query, is not a loop.
        Rejects = "rejects",
        /// The answer stays open.
        Undecided = "undecided",
        /// The answer stays open, and a later query may settle it.
        Waits = "waits",
        /// Rejected or left open, by the odds, by a setting or by the geometric model.
        Depends = "depends",
    }
}

named! {
    /// The part of a verdict that a reason belongs to.
    ReasonCheck {
        /// The query as a whole.
        Query = "query",
        /// The bags of words (§V, check 2).
        Words = "words",
        /// The local anchor maps (§V-B), before or under the transformation.
        Anchors = "anchors",
        /// The geometric verification, and what it is compared with.
        Geometry = "geometry",
    }
}

/// Makes a row of the table.
const fn row(title: &'static str, class: ReasonClass, check: ReasonCheck) -> ReasonWords {
    ReasonWords { title, class, check }
}

named! {
    /// The check that decided; in parentheses its effect on the verdict.
    ReasonCode: ReasonWords {
        /// No keyframe shares a word with the query, and none sees an anchor that it sees.
        NoCandidates = "no_candidates", row("nothing alike", Rejects, Query);
        /// Keyframes taken less than {limit} s before or after the query are no candidates in this map, {measured} of them here,
        /// and no other one shares a word or an anchor with it.
        TooRecent = "too_recent", row("all too recent", Rejects, Query);
        /// The loop was confirmed before, or one of the same return was that joined all that matches; no other keyframe is one.
        AlreadyClosed = "already_closed", row("loop closed already", Rejects, Query);
        /// No word of the query could be compared (a blank wall, or words of another vocabulary), and no anchor proposes a candidate.
        EmptyBow = "empty_bow", row("no words", Undecided, Query);
        /// The words score {measured}, below {limit}, the share of the reference score that this map asks for.
        BowBelowReference = "bow_below_reference", row("looks differ", Rejects, Words);
        /// There are no described anchors to compare. {detail}
        NoAnchors = "no_anchors", row("nothing to compare", Depends, Anchors);
        /// Anchors are not described yet, and their descriptions could turn the answer. Ask again in a while. {detail}
        LlmPending = "llm_pending", row("descriptions pending", Waits, Anchors);
        /// The language model is away, and its descriptions could turn the answer. Ask again in a while. {detail}
        LlmUnavailable = "llm_unavailable", row("model away", Waits, Anchors);
        /// Nothing has described some of the anchors, no model is going to, and a description could turn the answer.
        /// {detail}
        NotDescribed = "not_described", row("signs not described", Undecided, Anchors);
        /// The anchors around the two do not agree enough: S of Eq. (2) is {measured} and must exceed {limit}.
        ScoreBelowThreshold = "score_below_threshold", row("signs differ", Rejects, Anchors);
        /// Names around the two exclude each other. The confidence is {measured}, and {limit} is needed. {detail}
        Contradiction = "contradiction", row("signs contradict", Depends, Anchors);
        /// Every sign that agrees hangs in several places: it could be any of them. {detail}
        NotDistinctive = "not_distinctive", row("signs hang everywhere", Depends, Anchors);
        /// Every sign that agrees was seen in this same passage: it was tracked, and shows no return.
        TrackedOnly = "tracked_only", row("the same passage", Undecided, Anchors);
        /// Geometry had to verify, and it could not run. {detail}
        NoFeatures = "no_features", row("no features", Undecided, Geometry);
        /// Too few features fit one transformation: {measured}, and {limit} are needed.
        TooFewInliers = "too_few_inliers", row("geometry differs", Depends, Geometry);
        /// A sign that hangs once would hang in two places if this were a loop. {detail}
        AnchorsDisplaced = "anchors_displaced", row("signs in two places", Depends, Anchors);
        /// The robot knows from its own tracking that it is somewhere else. {detail}
        OdometryDisagreesWithTransform = "odometry_disagrees_with_transform", row("odometry differs", Depends, Geometry);
        /// Another place of the map is about as likely. {detail}
        AmbiguousPlaces = "ambiguous_places", row("looks like two places", Depends, Query);
        /// Where am I: several places fit, and the confidence in the best one is {measured}; {limit} is needed. The signs in
        /// `look_for` would tell them apart.
        PlacesAlike = "places_alike", row("several places fit", Undecided, Query);
        /// The evidence gives a confidence of {measured}, and {limit} is needed. {detail}
        TooLittleEvidence = "too_little_evidence", row("too little evidence", Depends, Query);
    }
}

impl ReasonCode {
    /// Returns the meaning for a reader who sees no verdict: the fields by their names.
    pub fn explanation(self) -> String {
        let meaning = self.meaning().trim_end_matches("{detail}").trim_end();
        meaning.replace("{measured}", "`measured`").replace("{limit}", "`limit`")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_code_has_a_name_a_title_and_sentences_with_known_fields() {
        let mut names = std::collections::BTreeSet::new();
        for code in ReasonCode::VALUES {
            let name = code.as_str();
            assert!(names.insert(name), "{name} is there twice");
            assert!(name.chars().all(|c| c.is_ascii_lowercase() || c == '_'), "{name}");
            let title = code.words().title;
            assert!(!title.is_empty() && title.len() <= 30 && !title.ends_with('.'), "{name}: {title:?}");
            let explanation = code.explanation();
            assert!(explanation.ends_with('.') && !explanation.contains(['{', '}']), "{name}: {explanation}");
            assert_eq!(ReasonCode::from_name(name), Some(*code));
        }
    }
}
