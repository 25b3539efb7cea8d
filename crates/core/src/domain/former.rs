//! Former values: the poses and positions that a request's changes replaced. Nothing is derived from them; they are kept so
//! that a map can be exported as it was sent.

use serde::{Deserialize, Serialize};

use super::ids::{KeyframeSeq, PointId, SessionSeq};
use crate::geometry::{Point3, Sim3};

/// The values that the changes of one request replaced; by the same ones, where a correction repeats them. What a keyframe
/// brings for the first time replaces nothing.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct FormerValues {
    /// Keyframes and their `map_from_camera` before, in the session's frame, in metres, with the scale of their lengths.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub poses: Vec<(KeyframeSeq, Sim3)>,
    /// Map points and their positions before, in the session's frame, in metres; `None` for a point that a correction
    /// brought and no keyframe had sent.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub points: Vec<(SessionSeq, PointId, Option<Point3>)>,
    /// Map points that went with the last keyframe that observed them, and their positions before.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub forgotten: Vec<(SessionSeq, PointId, Point3)>,
}

impl FormerValues {
    /// Returns the number of values.
    pub fn len(&self) -> usize {
        self.poses.len() + self.points.len() + self.forgotten.len()
    }

    /// Whether nothing was replaced.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Adds others of the same version.
    pub fn extend(&mut self, others: Self) {
        self.poses.extend(others.poses);
        self.points.extend(others.points);
        self.forgotten.extend(others.forgotten);
    }
}
