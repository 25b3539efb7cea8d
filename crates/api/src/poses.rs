//! Poses: what the client's optimisation corrected, in one piece (`openapi/openapi.yaml`).

use revisit_core::domain::ids::{KeyframeId, SessionId};
use revisit_core::domain::request::PoseCorrection;
use revisit_core::geometry::Pose;
use revisit_shapes::{answer, body};

use super::decoding::read::Node;
use super::keyframe::{PointsShape, SentMapPoints, filled};
use super::shown::Shown;
use super::space::Transform;

/// Corrected poses and map points of one session; all of it is taken over, or nothing.
#[body(checked PoseCorrection, of = PoseCorrection)]
pub struct PosesBody {
    /// The session.
    #[schema(default = "default")]
    #[id]
    #[from(Some(of.session))]
    pub session: Option<SessionId>,
    /// Its keyframes with their corrected poses.
    #[from(filled(of.keyframes))]
    pub keyframes: Option<PoseList>,
    /// Its map points at their corrected positions.
    #[schema(value_type = Option<SentMapPoints>)]
    #[from(filled(of.map_points))]
    pub map_points: Option<PointsShape>,
}

/// Keyframes and their poses: two lists in parallel.
#[body]
pub struct PoseList {
    /// The keyframes, none twice.
    #[schema(max_items = 100_000)]
    #[id]
    #[unique]
    pub ids: Vec<KeyframeId>,
    /// `map_from_camera` of each in the session's frame, in metres.
    #[schema(max_items = 100_000)]
    #[parallel(ids)]
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

impl PosesBody {
    fn checked(self, _: &Node<'_>) -> Option<PoseCorrection> {
        let keyframes = self.keyframes.map(|PoseList { ids, poses }| {
            ids.into_iter().zip(poses).map(|(id, pose)| Some((id, pose.pose()?))).collect::<Option<_>>()
        });
        Some(PoseCorrection {
            session: self.session.unwrap_or_default(),
            keyframes: keyframes.unwrap_or_else(|| Some(Vec::new()))?,
            map_points: self.map_points.map(PointsShape::ascending).unwrap_or_default(),
        })
    }
}

impl Shown<Vec<(KeyframeId, Pose)>> for PoseList {
    fn shown(keyframes: Vec<(KeyframeId, Pose)>) -> Self {
        let (ids, poses) = keyframes.into_iter().map(|(id, pose)| (id, Transform::from(pose))).unzip();
        Self { ids, poses }
    }
}
