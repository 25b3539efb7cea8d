//! Difference: identifiers of two local anchor maps that differ, and why that did not count as a contradiction.

use super::anchor_name::AnchorName;
use crate::named::named;

/// A pair of anchors of one class whose identifiers differ, and which did not stop the candidate.
#[derive(Clone, Debug, PartialEq)]
pub struct DifferenceEvidence {
    /// The anchor of the query's local map.
    pub query_anchor: AnchorName,
    /// The anchor of the candidate's local map.
    pub candidate_anchor: AnchorName,
    /// The identifier read on the query's anchor.
    pub query_identifier: String,
    /// The identifier read on the candidate's anchor.
    pub candidate_identifier: String,
    /// The reason why the difference did not count.
    pub reason: DifferenceReason,
    /// The measured value, in the reason's own unit.
    pub measured: Option<f64>,
    /// The value that it was compared with.
    pub limit: Option<f64>,
    /// One sentence for a person.
    pub detail: String,
}

/// A reason's words for people, beside its meaning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DifferenceWords {
    /// A few words that follow the two identifiers and a colon.
    pub title: &'static str,
}

/// Makes a row of the table.
const fn row(title: &'static str) -> DifferenceWords {
    DifferenceWords { title }
}

named! {
    /// The reason why a differing identifier did not count as a contradiction, or not enough.
    DifferenceReason: DifferenceWords {
        /// The two do not stand at the same relative place.
        AnotherPlace = "another_place", row("they stand at different places");
        /// One of the two also hangs elsewhere in the other map.
        KnownElsewhere = "known_elsewhere", row("the other map knows it, elsewhere");
        /// The judge sees no conflict: look-alike characters, or numbers of different kinds of things.
        NoConflict = "no_conflict", row("the two do not exclude each other");
        /// One of the two contradicts another anchor already; each counts once.
        PairedOtherwise = "paired_otherwise", row("one of them contradicts another sign already");
        /// It counts, and the signs that agree weigh as much or more.
        Outweighed = "outweighed", row("the signs that agree weigh no less");
        /// The map's settings leave contradictions out.
        VetoOff = "veto_off", row("this map leaves contradictions out");
    }
}
