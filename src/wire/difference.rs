//! Difference: an identifier that differs and did not count as a contradiction, with the reason (M7).

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::space::rounded;
use crate::model::difference::{DifferenceEvidence, DifferenceReason};

/// A pair of anchors of one class whose identifiers differ without stopping the candidate, and why.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = Difference)]
pub struct DifferenceView {
    /// The anchor of the query's local map.
    pub query_anchor: String,
    /// The anchor of the candidate's local map.
    pub candidate_anchor: String,
    /// The identifier on the query's anchor.
    pub query_identifier: String,
    /// The identifier on the candidate's anchor.
    pub candidate_identifier: String,
    /// Why it did not count as a contradiction, or not enough.
    pub reason: DifferenceReasonName,
    /// What was measured: characters for `not_sure`, metres or radians for `another_place`, weights in 1/m for `outweighed`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub measured: Option<f64>,
    /// What it was compared with, in the same unit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limit: Option<f64>,
    /// One sentence for a person.
    pub detail: String,
}

/// `not_sure`: an identifier was not read alike twice, and only one character differs. `another_place`: the two do not stand
/// at the same relative place. `known_elsewhere`: one of the two also hangs elsewhere in the other map. `no_conflict`: the
/// judge sees none, as between look-alike characters. `paired_otherwise`: one of the two contradicts another anchor already.
/// `outweighed`: it counts, and what agrees weighs no less. `veto_off`: the map's settings leave contradictions out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = DifferenceReason)]
#[expect(missing_docs, reason = "said above")]
pub enum DifferenceReasonName {
    NotSure,
    AnotherPlace,
    KnownElsewhere,
    NoConflict,
    PairedOtherwise,
    Outweighed,
    VetoOff,
}

impl From<DifferenceReason> for DifferenceReasonName {
    fn from(reason: DifferenceReason) -> Self {
        match reason {
            DifferenceReason::NotSure => Self::NotSure,
            DifferenceReason::AnotherPlace => Self::AnotherPlace,
            DifferenceReason::KnownElsewhere => Self::KnownElsewhere,
            DifferenceReason::NoConflict => Self::NoConflict,
            DifferenceReason::PairedOtherwise => Self::PairedOtherwise,
            DifferenceReason::Outweighed => Self::Outweighed,
            DifferenceReason::VetoOff => Self::VetoOff,
        }
    }
}

impl From<&DifferenceEvidence> for DifferenceView {
    fn from(pair: &DifferenceEvidence) -> Self {
        Self {
            query_anchor: pair.query_anchor.to_text(),
            candidate_anchor: pair.candidate_anchor.to_text(),
            query_identifier: pair.query_identifier.clone(),
            candidate_identifier: pair.candidate_identifier.clone(),
            reason: pair.reason.into(),
            measured: pair.measured.map(rounded),
            limit: pair.limit.map(rounded),
            detail: pair.detail.clone(),
        }
    }
}
