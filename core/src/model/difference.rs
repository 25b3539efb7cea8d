//! Difference: identifiers of two local anchor maps that differ, and why that did not count as a contradiction.

use super::verdict::AnchorName;

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
    /// Why the difference did not count.
    pub reason: DifferenceReason,
    /// What was measured, in the reason's own unit.
    pub measured: Option<f64>,
    /// What it was compared with.
    pub limit: Option<f64>,
    /// One sentence for a person.
    pub detail: String,
}

/// Why a differing identifier did not count as a contradiction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DifferenceReason {
    /// Geometry found the place, and an identifier may be misread: only one passage read it.
    NotSure,
    /// The two do not stand at the same relative place.
    AnotherPlace,
    /// One of the two also hangs elsewhere in the other map.
    KnownElsewhere,
    /// The judge sees no conflict: look-alike characters, or numbers of different kinds of things.
    NoConflict,
    /// One of the two contradicts another anchor already; each counts once.
    PairedOtherwise,
    /// It counts, and what agrees weighs as much or more.
    Outweighed,
    /// The map's settings leave contradictions out.
    VetoOff,
}
