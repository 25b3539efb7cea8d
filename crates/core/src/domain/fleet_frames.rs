//! Frames of a fleet: the places of a map's sessions relative to each other (M60).

use serde::{Deserialize, Serialize};

use super::ids::{LoopId, SessionSeq};
use crate::geometry::Pose;

/// The places of a map's sessions relative to each other, at one version of the map.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FleetFrames {
    /// The sessions that have keyframes or are a plan's frame, in order of appearance.
    pub sessions: Vec<FramedSession>,
    /// The confirmed loops that contradict the others, by name.
    pub suspects: Vec<Suspect>,
    /// The number of confirmed loops that count.
    pub loops: usize,
    /// The number of confirmed loops between sessions without a transformation.
    pub left_out: usize,
}

/// A session in the frame of those that loops and plans join it with.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FramedSession {
    /// The session.
    pub session: SessionSeq,
    /// The oldest of the sessions that it is joined with, whose frame is theirs; itself where it is joined with none.
    pub root: SessionSeq,
    /// Maps points of its frame into the frame of the root.
    pub root_from_session: Pose,
    /// The root mean square of what its loops are off from the frames, in metres; none without loops.
    pub residual_m: Option<f64>,
    /// The number of loops between it and other sessions that count.
    pub loops: usize,
}

/// A confirmed loop that contradicts the others.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Suspect {
    /// The loop.
    pub loop_id: LoopId,
    /// The loops that lead back from its candidate's session to its keyframe's and do not agree with it, in this order; a plan
    /// that is passed has no name. Empty where the loop is within one session, whose tracking it contradicts.
    pub cycle: Vec<LoopId>,
    /// The gap of the cycle where the loop was, in metres.
    pub off_m: f64,
    /// Its gap in rotation, in radians.
    pub off_rad: f64,
}
