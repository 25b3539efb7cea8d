//! Loop: one that a client closed, what it merged, and what its revocation splits again (`openapi/openapi.yaml`).

use revisit_core::domain::change::Merge;
use revisit_core::domain::ids::{IdError, KeyframeId, LoopId};
use revisit_core::domain::loop_warning::LoopWarning;
use revisit_core::domain::report::LoopReport;
use revisit_core::domain::request::NewLoop;
use revisit_shapes::{answer, body};

use super::decoding::read::{self, Node};
use super::names::LoopWarningCodeName;
use super::shown::Shown;
use super::space::SimilarityShape;

/// A loop that the client closed.
#[body(checked NewLoop, of = NewLoop)]
pub struct LoopBody {
    /// Its id.
    #[id]
    pub id: LoopId,
    /// The keyframe that came back.
    #[id]
    pub keyframe: KeyframeId,
    /// The keyframe it came back to.
    #[id]
    #[read(|node| another(node, keyframe.as_ref()))]
    pub candidate: KeyframeId,
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
#[answer(of = Merge)]
#[schema(as = Merge)]
pub struct MergeView {
    /// The older anchor, by whose name both go.
    pub into: String,
    /// The newer anchor.
    pub from: String,
}

fn another(node: &Node<'_>, keyframe: Option<&KeyframeId>) -> Option<KeyframeId> {
    let id = read::id(node)?;
    if Some(&id) == keyframe {
        return node.refuse("a keyframe makes no loop with itself", "another keyframe");
    }
    Some(id)
}

impl LoopBody {
    /// Returns the loop of these ids that a query of this id has found.
    pub fn found(id: &str, keyframe: &str, candidate: &str, query: String) -> Result<Self, IdError> {
        let (id, keyframe, candidate) = (id.parse()?, keyframe.parse()?, candidate.parse()?);
        Ok(Self { id, keyframe, candidate, query: Some(query), candidate_from_query: None })
    }

    fn checked(self, _: &Node<'_>) -> Option<NewLoop> {
        let Self { id, keyframe, candidate, query, candidate_from_query } = self;
        let candidate_from_query = candidate_from_query.map(SimilarityShape::sim3);
        let candidate_from_query = candidate_from_query.map_or(Some(None), |sim3| sim3.map(Some))?;
        Some(NewLoop { id, keyframe, candidate, query, candidate_from_query })
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
