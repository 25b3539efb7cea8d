//! Trajectory: where the cameras of a map's sessions stood, as last corrected, and the loops that join them.

use super::change::Loop;
use super::ids::{KeyframeId, SessionId};
use super::keyframe::Stamp;
use crate::geometry::Pose;

/// A map's trajectories at one version.
#[derive(Clone, Debug, PartialEq)]
pub struct TrajectoryReport {
    /// The map's version.
    pub map_version: u64,
    /// The sessions that have keyframes, in order of appearance; each has a frame of its own.
    pub sessions: Vec<SessionTrack>,
    /// The confirmed loops between these keyframes, by name.
    pub loops: Vec<Loop>,
    /// Whether all poses are in one frame.
    pub is_in_one_frame: bool,
    /// The sessions that nothing joins with that frame, in order of appearance; they are not among `sessions`.
    pub unjoined: Vec<SessionId>,
}

/// One session's keyframes, by stamp; of one stamp in order of arrival.
#[derive(Clone, Debug, PartialEq)]
pub struct SessionTrack {
    /// The session.
    pub session: SessionId,
    /// Its keyframes.
    pub keyframes: Vec<TrackedPose>,
}

/// A keyframe's pose and time.
#[derive(Clone, Debug, PartialEq)]
pub struct TrackedPose {
    /// The keyframe.
    pub keyframe: KeyframeId,
    /// When.
    pub stamp: Stamp,
    /// `map_from_camera` in the session's frame, as last corrected.
    pub map_from_camera: Pose,
}
