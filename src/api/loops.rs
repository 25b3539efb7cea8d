//! Loop: one that a client closed, what it merged, and what its revocation splits again (`openapi/openapi.yaml`).

use revisit_shapes::answer;

use super::decoding::read::{self, Decode, Node};
use super::limits;
use super::names::LoopWarningCodeName;
use super::shown::Shown;
use super::space::{SimilarityShape, similarity};
use crate::domain::loop_warning::LoopWarning;
use crate::domain::report::{LoopReport, MergeReport};
use crate::domain::request::NewLoop;

/// A loop that the client closed.
#[answer]
#[serde(deny_unknown_fields)]
pub struct LoopBody {
    /// Its id.
    #[schema(min_length = 1, max_length = 128, pattern = r"^(\.{0,2}[A-Za-z0-9_:-]|\.{3})[A-Za-z0-9._:-]*$")]
    pub id: String,
    /// The keyframe that came back.
    #[schema(min_length = 1, max_length = 128, pattern = r"^(\.{0,2}[A-Za-z0-9_:-]|\.{3})[A-Za-z0-9._:-]*$")]
    pub keyframe: String,
    /// The keyframe it came back to.
    #[schema(min_length = 1, max_length = 128, pattern = r"^(\.{0,2}[A-Za-z0-9_:-]|\.{3})[A-Za-z0-9._:-]*$")]
    pub candidate: String,
    /// The id of the loop query that found it.
    #[schema(min_length = 1, max_length = 128)]
    pub query: Option<String>,
    /// The pose of the keyframe in the candidate's camera frame, as the client closed it; left out: what the query verified, if its
    /// answer is still stored. It joins the frames of two robots.
    pub candidate_from_query: Option<SimilarityShape>,
}

/// A loop is closed.
#[answer]
pub struct LoopClosed {
    /// Its id.
    pub id: String,
    /// The map's version after it.
    pub map_version: u64,
    /// The pairs of anchors that became one.
    pub merged: Vec<MergeView>,
    /// Evidence against it, as the map stood before it. The client decides: it is closed all the same, and can be revoked.
    /// A retry (200) is answered without them.
    #[schema(max_items = 1)]
    pub warnings: Vec<LoopWarningView>,
}

/// Evidence against a loop that was confirmed.
#[answer(of = LoopWarning)]
#[schema(as = LoopWarning)]
pub struct LoopWarningView {
    /// The kind of evidence.
    pub code: LoopWarningCodeName,
    /// One sentence for a person.
    pub detail: String,
}

/// A loop is revoked.
#[answer]
pub struct LoopRevoked {
    /// Its id.
    pub id: String,
    /// The map's version after it.
    pub map_version: u64,
    /// The pairs of anchors that are two again.
    pub split: Vec<MergeView>,
}

/// A confirmed loop.
#[answer(of = LoopReport)]
pub struct LoopView {
    /// Its id.
    pub id: String,
    /// The keyframe that came back.
    pub keyframe: String,
    /// The keyframe it came back to.
    pub candidate: String,
    /// The loop query that found it.
    pub query: Option<String>,
    /// The pairs of anchors that it made one.
    pub merged: Vec<MergeView>,
}

/// A pair of anchors.
#[answer(of = MergeReport)]
#[schema(as = Merge)]
pub struct MergeView {
    /// The older anchor, by whose name both go.
    pub into: String,
    /// The newer anchor.
    pub from: String,
}

impl From<NewLoop> for LoopBody {
    fn from(new: NewLoop) -> Self {
        let NewLoop { id, keyframe, candidate, query, candidate_from_query } = new;
        let (keyframe, candidate) = (keyframe.to_string(), candidate.to_string());
        let candidate_from_query = candidate_from_query.as_ref().map(SimilarityShape::from);
        Self { id: id.to_string(), keyframe, candidate, query, candidate_from_query }
    }
}

impl Decode for NewLoop {
    fn decode(node: &Node<'_>) -> Option<Self> {
        let body = node.object(&["id", "keyframe", "candidate", "query", "candidate_from_query"])?;
        let id = body.required("id", read::id);
        let keyframe = body.required("keyframe", read::id);
        let candidate = body.required("candidate", |candidate| {
            let id = read::id(candidate)?;
            if Some(&id) == keyframe.as_ref() {
                return candidate.refuse("a keyframe makes no loop with itself", "another keyframe");
            }
            Some(id)
        });
        let query = body.optional("query", |node| node.name(limits::ID_CHARS));
        let candidate_from_query = body.optional("candidate_from_query", similarity);
        Some(Self {
            id: id?,
            candidate: candidate?,
            keyframe: keyframe?,
            query: query?,
            candidate_from_query: candidate_from_query?,
        })
    }
}

impl LoopClosed {
    /// Returns the answer to a loop that was closed.
    pub fn of(map_version: u64, report: LoopReport, warnings: Vec<LoopWarning>) -> Self {
        Self {
            id: report.id.to_string(),
            map_version,
            merged: Shown::shown(report.merged),
            warnings: Shown::shown(warnings),
        }
    }
}

impl LoopRevoked {
    /// Returns the answer to a loop that was revoked.
    pub fn of(map_version: u64, report: LoopReport) -> Self {
        Self { id: report.id.to_string(), map_version, split: Shown::shown(report.merged) }
    }
}
