//! Listed verdict: a line of the list of verdicts (`openapi/openapi.yaml`).

use revisit_core::domain::verdict_line::ListedVerdict;
use revisit_shapes::answer;

use super::names::{ReasonCodeName, VerdictName};
use super::space::Time;

/// A verdict in a line, as the list shows it.
#[answer(of = ListedVerdict)]
#[schema(as = ListedVerdict)]
pub struct ListedVerdictView {
    /// The query's id.
    pub query: String,
    /// When it was asked last, by the server's clock.
    #[from(of.asked)]
    pub time: Time,
    /// The keyframe that was asked about; null where it came with the query.
    #[schema(required)]
    #[null]
    #[from(of.line.keyframe)]
    pub keyframe: Option<String>,
    /// The session of that keyframe, while the map has it.
    #[schema(required)]
    #[null]
    pub session: Option<String>,
    /// The keyframe it came back to, or else the likeliest one.
    #[schema(required)]
    #[null]
    #[from(of.line.candidate)]
    pub candidate: Option<String>,
    /// The map's version that answered.
    #[from(of.line.map_version)]
    pub map_version: u64,
    /// The answer.
    #[from(of.line.decision)]
    pub verdict: VerdictName,
    /// The check that decided, of the answer or else of the likeliest candidate; left out for a loop.
    #[from(of.line.reason)]
    pub reason: Option<ReasonCodeName>,
    /// One sentence for a person: why.
    #[from(of.line.why)]
    pub why: String,
    /// Whether `GET .../loop-queries/{query}` still returns the whole answer.
    pub is_whole: bool,
}
