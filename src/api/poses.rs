//! Poses: what the client's optimisation corrected, in one piece (`openapi/openapi.yaml`).

use revisit_shapes::answer;

use super::decoding::read::{self, Decode, Node};
use super::keyframe::{PointsShape, SentPoints, points};
use super::limits;
use super::space::Transform;
use crate::domain::ids::{KeyframeId, SessionId};
use crate::domain::request::PoseCorrection;
use crate::geometry::Pose;

/// Corrected poses and map points of one session; all of it is taken over, or nothing.
#[answer]
#[serde(deny_unknown_fields)]
pub struct PosesBody {
    /// The session.
    #[schema(
        default = "default",
        min_length = 1,
        max_length = 128,
        pattern = r"^(\.{0,2}[A-Za-z0-9_:-]|\.{3})[A-Za-z0-9._:-]*$"
    )]
    pub session: Option<String>,
    /// Its keyframes with their corrected poses.
    pub keyframes: Option<PoseList>,
    /// Its map points at their corrected positions.
    #[schema(value_type = Option<SentPoints>)]
    pub map_points: Option<PointsShape>,
}

/// Keyframes and their poses: two lists in parallel.
#[answer]
#[serde(deny_unknown_fields)]
pub struct PoseList {
    /// The keyframes, none twice.
    #[schema(max_items = 100_000, value_type = Vec<super::names::Id>, inline)]
    pub ids: Vec<String>,
    /// `map_from_camera` of each in the session's frame, in metres.
    #[schema(max_items = 100_000)]
    pub poses: Vec<Transform>,
}

/// Poses and points are corrected.
#[answer]
#[derive(Copy)]
pub struct PosesAnswer {
    /// The map's version after it.
    pub map_version: u64,
    /// Number of corrected keyframes.
    pub keyframes: usize,
    /// Number of corrected map points.
    pub map_points: usize,
}

impl Decode for PoseCorrection {
    fn decode(node: &Node<'_>) -> Option<Self> {
        let body = node.object(&["session", "keyframes", "map_points"])?;
        let session = body.optional("session", read::id::<SessionId>);
        let keyframes = body.optional("keyframes", keyframes);
        let map_points = body.optional("map_points", points);
        Some(Self {
            session: session?.unwrap_or_default(),
            keyframes: keyframes?.unwrap_or_default(),
            map_points: map_points?.unwrap_or_default(),
        })
    }
}

impl From<PoseCorrection> for PosesBody {
    fn from(correction: PoseCorrection) -> Self {
        let PoseCorrection { session, keyframes, map_points } = correction;
        let keyframes = keyframes.into_iter().map(|(id, pose)| (id.to_string(), Transform::from(pose)));
        let (ids, poses) = keyframes.unzip();
        let keyframes = PoseList { ids, poses };
        Self {
            session: Some(session.to_string()),
            keyframes: (!keyframes.ids.is_empty()).then_some(keyframes),
            map_points: (!map_points.is_empty()).then(|| map_points.into()),
        }
    }
}

fn keyframes(node: &Node<'_>) -> Option<Vec<(KeyframeId, Pose)>> {
    let body = node.object(&["ids", "poses"])?;
    let ids = body.required("ids", |node| super::keyframe::unique(node, limits::CORRECTIONS, read::id));
    let poses = body.required("poses", |node| node.list(limits::CORRECTIONS, Pose::decode));
    body.parallel("ids", "poses")?;
    Some(ids?.into_iter().zip(poses?).collect())
}
