//! Odds: the terms of the sum of evidence for a place (M64).

use revisit_core::domain::verdict::EvidenceTerm;
use revisit_shapes::answer;

use super::names::EvidenceKindName;

/// One term of the sum of evidence for a place.
#[answer(of = &EvidenceTerm)]
#[schema(as = Evidence)]
pub struct EvidenceView {
    /// Its kind.
    pub kind: EvidenceKindName,
    /// The signs, cells or metres that it rests on, for a person.
    pub about: String,
    /// The query's anchors that it rests on; left out where there are none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[from(of.pairs.iter().map(|(query, _)| query).collect::<Vec<_>>())]
    pub query_anchors: Vec<String>,
    /// The candidate's, in the same order.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[from(of.pairs.iter().map(|(_, candidate)| candidate).collect::<Vec<_>>())]
    pub candidate_anchors: Vec<String>,
    /// Its natural log-odds, positive for the place.
    #[rounded]
    pub log_odds: f64,
}
