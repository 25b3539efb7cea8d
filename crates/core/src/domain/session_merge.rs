//! Merge of sessions: a client's two maps became one (M59).

use std::collections::HashMap;

use serde::{Deserialize, Serialize};

use super::ids::{AnchorSeq, KeyframeSeq, PointId, SessionId, SessionSeq};
use super::observation_update::PointsOfKeyframe;
use crate::geometry::Sim3;

/// The numbers that the map points of a session get in the session that it merges into.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Renumbering {
    /// They keep their numbers.
    #[default]
    Same,
    /// This is added to each.
    Offset(i64),
    /// Those that get another number, none twice, each with it; the others keep theirs.
    Listed(Vec<(PointId, PointId)>),
}

impl Renumbering {
    /// Returns what tells the number that a map point gets.
    pub fn number(&self) -> impl Fn(PointId) -> PointId {
        let (offset, listed) = match self {
            Self::Same => (0, HashMap::new()),
            Self::Offset(offset) => (*offset, HashMap::new()),
            Self::Listed(pairs) => (0, pairs.iter().copied().collect::<HashMap<PointId, PointId>>()),
        };
        move |id| listed.get(&id).copied().unwrap_or_else(|| id.saturating_add(offset))
    }
}

/// A merge of sessions, as its client sent it.
#[derive(Clone, Debug, PartialEq)]
pub struct SessionMergeRequest {
    /// The session that goes.
    pub session: SessionId,
    /// The session that its keyframes are of from now on.
    pub into: SessionId,
    /// Maps the frame of the session that goes into the other's.
    pub into_from_session: Sim3,
    /// The numbers that its map points get.
    pub map_points: Renumbering,
}

/// A merge of sessions, by dense number.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SessionMerge {
    /// The session that goes.
    pub session: SessionSeq,
    /// The session that its keyframes are of from now on.
    pub into: SessionSeq,
    /// The number that the next keyframe had: it, and those after it, are not concerned.
    pub next_keyframe: KeyframeSeq,
    /// Maps the frame of the session that goes into the other's.
    pub into_from_session: Sim3,
    /// The numbers that its map points get.
    pub map_points: Renumbering,
}

/// The values that revoke a merge of sessions, beside the former poses and positions.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MergeUndo {
    /// The session that went.
    pub session: SessionSeq,
    /// The session that it merged into.
    pub into: SessionSeq,
    /// As [`SessionMerge::next_keyframe`]; together with the session it names the merge.
    pub next_keyframe: KeyframeSeq,
    /// The keyframes that were moved.
    pub keyframes: Vec<KeyframeSeq>,
    /// The former points of those of them whose points got other numbers.
    pub points: Vec<PointsOfKeyframe>,
    /// The map points of their detections, likewise.
    pub detections: Vec<(KeyframeSeq, u16, Box<[PointId]>)>,
    /// The anchors that turned out to be one, the older first.
    pub merges: Vec<(AnchorSeq, AnchorSeq)>,
}

impl MergeUndo {
    /// Returns what names a merge, without the values that revoke it.
    pub fn naming(session: SessionSeq, into: SessionSeq, next_keyframe: KeyframeSeq) -> Self {
        Self {
            session,
            into,
            next_keyframe,
            keyframes: Vec::new(),
            points: Vec::new(),
            detections: Vec::new(),
            merges: Vec::new(),
        }
    }
}
