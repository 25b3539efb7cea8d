//! Merge of sessions: the client's two maps became one (`openapi/openapi.yaml`).

use std::collections::HashSet;

use revisit_core::domain::ids::SessionId;
use revisit_core::domain::session_merge::{Renumbering, SessionMergeRequest};
use revisit_core::geometry::Sim3;
use revisit_shapes::{answer, body};

use super::decoding::read::{Decode as _, Node};
use super::limits;
use super::observations::FusedPoints;
use super::space::SimilarityShape;

/// The session that another one merges into, and how; all of it is taken over, or nothing.
#[body(checked MergeFields)]
pub struct MergeBody {
    /// The session that the keyframes are of from now on. One that is not there yet is begun.
    #[id]
    pub into: SessionId,
    /// Maps points of the session's frame into the frame of `into`.
    pub into_from_session: SimilarityShape,
    /// The numbers that its map points get; left out, they keep theirs.
    #[read(RenumberingShape::one_way)]
    pub map_points: Option<RenumberingShape>,
}

/// The numbers that the map points of a session get: by `offset` or by `ids`. A point whose new number is taken is that point,
/// which keeps its position.
#[body]
#[schema(as = Renumbering)]
pub struct RenumberingShape {
    /// This is added to the number of each.
    #[read(|node: &Node<'_>| node.whole(-i64::MAX..=i64::MAX))]
    pub offset: Option<i64>,
    /// `[old, new]` for each that gets another number, no old one twice; the others keep theirs.
    #[schema(max_items = 100_000, value_type = Option<Vec<FusedPoints>>, inline)]
    #[read(renumbered)]
    pub ids: Option<Vec<FusedPoints>>,
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

impl MergeBody {
    fn checked(self, _: &Node<'_>) -> Option<MergeFields> {
        let map_points = match self.map_points {
            Some(RenumberingShape { offset: Some(offset), .. }) => Renumbering::Offset(offset),
            Some(RenumberingShape { ids: Some(ids), .. }) => {
                Renumbering::Listed(ids.into_iter().map(|FusedPoints([old, new])| (old, new)).collect())
            }
            _ => Renumbering::Same,
        };
        let into_from_session = self.into_from_session.sim3()?;
        Some(MergeFields { into: self.into, into_from_session, map_points })
    }
}

impl RenumberingShape {
    fn one_way(node: &Node<'_>) -> Option<Self> {
        let shape = Self::decode(node)?;
        if shape.offset.is_some() && shape.ids.is_some() {
            return node.refuse("an offset and single numbers", "one of the two");
        }
        Some(shape)
    }
}

fn renumbered(node: &Node<'_>) -> Option<Vec<FusedPoints>> {
    let mut listed = HashSet::new();
    node.list(limits::CORRECTIONS, |pair| {
        let points = FusedPoints::decode(pair)?;
        if !listed.insert(points.0[0]) {
            return pair.refuse("this map point is listed twice", "each one once");
        }
        Some(points)
    })
}

impl From<SessionMergeRequest> for MergeBody {
    fn from(merge: SessionMergeRequest) -> Self {
        let map_points = match merge.map_points {
            Renumbering::Same => None,
            Renumbering::Offset(offset) => Some(RenumberingShape { offset: Some(offset), ids: None }),
            Renumbering::Listed(pairs) => {
                let ids = pairs.into_iter().map(|(old, new)| FusedPoints([old, new])).collect();
                Some(RenumberingShape { offset: None, ids: Some(ids) })
            }
        };
        Self { into: merge.into, into_from_session: merge.into_from_session.into(), map_points }
    }
}
