//! Merge of sessions: the client's two maps became one (`openapi/openapi.yaml`).

use revisit_shapes::answer;

use super::decoding::read::{self, Decode, Node};
use super::limits;
use super::observations::FusedPoints;
use super::space::{SimilarityShape, similarity};
use crate::domain::ids::{PointId, SessionId};
use crate::domain::session_merge::{Renumbering, SessionMergeRequest};
use crate::geometry::Sim3;

/// The session that another one merges into, and how; all of it is taken over, or nothing.
#[answer]
#[serde(deny_unknown_fields)]
pub struct MergeBody {
    /// The session that the keyframes are of from now on. One that is not there yet is begun.
    #[schema(min_length = 1, max_length = 128, pattern = r"^(\.{0,2}[A-Za-z0-9_:-]|\.{3})[A-Za-z0-9._:-]*$")]
    pub into: String,
    /// Maps points of the session's frame into the frame of `into`.
    pub into_from_session: SimilarityShape,
    /// The numbers that its map points get; left out, they keep theirs.
    pub map_points: Option<RenumberingShape>,
}

/// The numbers that the map points of a session get: by `offset` or by `ids`. A point whose new number is taken is that point,
/// which keeps its position.
#[answer]
#[serde(deny_unknown_fields)]
#[schema(as = Renumbering)]
pub struct RenumberingShape {
    /// This is added to the number of each.
    pub offset: Option<i64>,
    /// `[old, new]` for each that gets another number, no old one twice; the others keep theirs.
    #[schema(max_items = 100_000, value_type = Option<Vec<FusedPoints>>, inline)]
    pub ids: Option<Vec<Vec<i64>>>,
}

/// Two sessions are one.
#[answer]
#[derive(Copy)]
pub struct SessionsMergedAnswer {
    /// The map's version after it.
    pub map_version: u64,
    /// Number of keyframes that moved; 0 where the session has none, as after the same request.
    pub keyframes: usize,
    /// Number of map points with a position that moved.
    pub map_points: usize,
    /// Number of anchors that turned out to be one with another.
    pub anchors_merged: usize,
}

/// The sessions are two again.
#[answer]
#[derive(Copy)]
pub struct MergeRevokedAnswer {
    /// The map's version after it.
    pub map_version: u64,
    /// Number of keyframes that moved back.
    pub keyframes: usize,
}

/// A merge without the session that goes, which is in the path.
#[derive(Clone, Debug, PartialEq)]
pub struct MergeFields {
    into: SessionId,
    into_from_session: Sim3,
    map_points: Renumbering,
}

impl MergeFields {
    /// Returns the merge of this session.
    pub fn of(self, session: SessionId) -> SessionMergeRequest {
        let Self { into, into_from_session, map_points } = self;
        SessionMergeRequest { session, into, into_from_session, map_points }
    }
}

impl Decode for MergeFields {
    fn decode(node: &Node<'_>) -> Option<Self> {
        let body = node.object(&["into", "into_from_session", "map_points"])?;
        let into = body.required("into", read::id::<SessionId>);
        let into_from_session = body.required("into_from_session", similarity);
        let map_points = body.optional("map_points", renumbering);
        Some(Self {
            into: into?,
            into_from_session: into_from_session?,
            map_points: map_points?.unwrap_or_default(),
        })
    }
}

fn renumbering(node: &Node<'_>) -> Option<Renumbering> {
    let body = node.object(&["offset", "ids"])?;
    let offset = body.optional("offset", |node| node.whole(limits::POINT_OFFSET));
    let ids = body.optional("ids", pairs);
    match (offset?, ids?) {
        (Some(_), Some(_)) => node.refuse("an offset and single numbers", "one of the two"),
        (Some(offset), None) => Some(Renumbering::Offset(offset)),
        (None, Some(ids)) => Some(Renumbering::Listed(ids)),
        (None, None) => Some(Renumbering::Same),
    }
}

fn pairs(node: &Node<'_>) -> Option<Vec<(PointId, PointId)>> {
    let mut listed = std::collections::HashSet::new();
    node.list(limits::CORRECTIONS, |pair| {
        let numbers = pair.list(2, |point| point.whole(limits::POINT))?;
        let [old, new] = numbers[..] else {
            return pair.refuse("not two map points", "[old, new]");
        };
        if !listed.insert(old) {
            return pair.refuse("this map point is listed twice", "each one once");
        }
        Some((old, new))
    })
}

impl From<SessionMergeRequest> for MergeBody {
    fn from(merge: SessionMergeRequest) -> Self {
        let map_points = match merge.map_points {
            Renumbering::Same => None,
            Renumbering::Offset(offset) => Some(RenumberingShape { offset: Some(offset), ids: None }),
            Renumbering::Listed(pairs) => {
                let ids = pairs.into_iter().map(|(old, new)| vec![old, new]).collect();
                Some(RenumberingShape { offset: None, ids: Some(ids) })
            }
        };
        Self {
            into: merge.into.to_string(),
            into_from_session: (&merge.into_from_session).into(),
            map_points,
        }
    }
}
