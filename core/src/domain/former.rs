//! Former values: the poses and positions that a request's changes replaced. Nothing is derived from them; they are kept so
//! that a map can be exported as it was sent.

use super::ids::{KeyframeSeq, PointId, SessionSeq};
use crate::geometry::{Point3, Pose};

/// The values that the changes of one request replaced; by the same ones, where a correction repeats them. What a keyframe
/// brings for the first time replaces nothing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FormerValues {
    /// Keyframes and their `map_from_camera` before, in the session's frame, in metres.
    pub poses: Vec<(KeyframeSeq, Pose)>,
    /// Map points and their positions before, in the session's frame, in metres; `None` for a point that a correction
    /// brought and no keyframe had sent.
    pub points: Vec<(SessionSeq, PointId, Option<Point3>)>,
    /// Map points that went with the last keyframe that observed them, and their positions before.
    pub forgotten: Vec<(SessionSeq, PointId, Point3)>,
    /// Detections (keyframe, number) and their positions before, in the session's frame, in metres.
    pub positions: Vec<(KeyframeSeq, u16, Point3)>,
}
