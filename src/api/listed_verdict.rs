//! Listed verdict: a line of the list of verdicts (`openapi/openapi.yaml`).

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::names::{ReasonCodeName, VerdictName};
use super::space::Time;
use crate::domain::verdict_line::ListedVerdict;

/// A verdict in a line, as the list shows it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[schema(as = ListedVerdict)]
pub struct ListedVerdictView {
    /// The query's id.
    pub query: String,
    /// When it was asked last, by the server's clock.
    pub time: Time,
    /// The keyframe that was asked about; null where it came with the query.
    #[schema(required)]
    pub keyframe: Option<String>,
    /// The session of that keyframe, while the map has it.
    #[schema(required)]
    pub session: Option<String>,
    /// The keyframe it came back to, or else the likeliest one.
    #[schema(required)]
    pub candidate: Option<String>,
    /// The map's version that answered.
    pub map_version: u64,
    /// The answer.
    pub verdict: VerdictName,
    /// The check that decided, of the answer or else of the likeliest candidate; left out for a loop.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<ReasonCodeName>,
    /// One sentence for a person: why.
    pub why: String,
    /// Whether `GET .../loop-queries/{query}` still returns the whole answer.
    pub is_whole: bool,
}

impl From<ListedVerdict> for ListedVerdictView {
    fn from(listed: ListedVerdict) -> Self {
        let ListedVerdict { query, asked, session, is_whole, line } = listed;
        Self {
            query,
            time: asked.into(),
            keyframe: line.keyframe.map(|id| id.to_string()),
            session: session.map(|id| id.to_string()),
            candidate: line.candidate.map(|id| id.to_string()),
            map_version: line.map_version,
            verdict: line.decision.into(),
            reason: line.reason.map(ReasonCodeName::from),
            why: line.why,
            is_whole,
        }
    }
}
