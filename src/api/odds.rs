//! Odds: the terms of the sum of evidence for a place (M64).

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::names::EvidenceKindName;
use super::space::rounded;
use crate::domain::verdict::EvidenceTerm;

/// One term of the sum of evidence for a place.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = Evidence)]
pub struct EvidenceView {
    /// Its kind.
    pub kind: EvidenceKindName,
    /// The signs, cells or metres that it rests on, for a person.
    pub about: String,
    /// The query's anchors that it rests on; left out where there are none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub query_anchors: Vec<String>,
    /// The candidate's, in the same order.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub candidate_anchors: Vec<String>,
    /// Its natural log-odds, positive for the place.
    pub log_odds: f64,
}

impl From<&EvidenceTerm> for EvidenceView {
    fn from(term: &EvidenceTerm) -> Self {
        Self {
            kind: term.kind.into(),
            about: term.about.clone(),
            query_anchors: term.pairs.iter().map(|(query, _)| query.to_text()).collect(),
            candidate_anchors: term.pairs.iter().map(|(_, candidate)| candidate.to_text()).collect(),
            log_odds: rounded(term.log_odds),
        }
    }
}
