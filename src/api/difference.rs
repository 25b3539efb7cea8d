//! Difference: an identifier that differs and did not count as a contradiction, with the reason (M7).

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::names::DifferenceReasonName;
use super::space::rounded;
use crate::domain::difference::DifferenceEvidence;

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
    /// The reason why it did not count as a contradiction, or not enough.
    pub reason: DifferenceReasonName,
    /// The measured value: metres or radians for `another_place`, weights in 1/m for `outweighed`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub measured: Option<f64>,
    /// The value that it was compared with, in the same unit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limit: Option<f64>,
    /// One sentence for a person.
    pub detail: String,
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
