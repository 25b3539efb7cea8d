//! Frames: the places of a map's sessions relative to each other, and the loops that contradict it (`openapi/openapi.yaml`).

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::space::{Transform, rounded};
use crate::domain::fleet_frames::Suspect;
use crate::domain::report::{FrameReport, FramesReport};
use crate::geometry::Pose;

/// One frame for all sessions of a map.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = Frames)]
pub struct FramesView {
    /// The map's version that it was computed at. While what loops and plans say stays the same, so does it.
    pub version: u64,
    /// The session in whose frame the others are; left out in a map without sessions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reference: Option<String>,
    /// The sessions, in order of appearance.
    pub frames: Vec<FrameView>,
    /// The confirmed loops that contradict the others, by id.
    pub suspects: Vec<SuspectView>,
    /// Number of confirmed loops between sessions that count.
    pub loops: usize,
    /// Number of confirmed loops between sessions without a transformation.
    pub left_out: usize,
}

/// A session in the frame of the reference.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = Frame)]
pub struct FrameView {
    /// The session.
    pub session: String,
    /// Maps points of its frame into that of the reference; left out if no loop and no plan joins the two.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reference_from_session: Option<Transform>,
    /// Root mean square of what its loops are off from the frames, in metres; left out without any. Frames are rigid, so that drift
    /// within a session shows here.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub residual: Option<f64>,
    /// Number of its loops with other sessions that count.
    pub loops: usize,
}

/// A confirmed loop that contradicts the others. Nothing is revoked unasked: `DELETE /v1/maps/{map}/loops/{loop}` does it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = Suspect)]
pub struct SuspectView {
    /// The loop.
    #[serde(rename = "loop")]
    pub loop_id: String,
    /// The loops that lead from the one of its sessions to the other, and do not agree with it; empty where it is within one session,
    /// whose tracking it contradicts. A plan that is passed has no id.
    pub cycle: Vec<String>,
    /// The gap of the cycle, in metres.
    pub residual: f64,
    /// Its gap in rotation, in rad.
    pub residual_rad: f64,
}

impl From<FramesReport> for FramesView {
    fn from(report: FramesReport) -> Self {
        let FramesReport { version, reference, frames, suspects, loops, left_out } = report;
        Self {
            version,
            reference: reference.map(|id| id.to_string()),
            frames: frames.into_iter().map(FrameView::from).collect(),
            suspects: suspects.into_iter().map(SuspectView::from).collect(),
            loops,
            left_out,
        }
    }
}

impl From<FrameReport> for FrameView {
    fn from(frame: FrameReport) -> Self {
        let shown = |pose: Pose| {
            Pose::from_stored(pose.translation_m().map(rounded), pose.rotation_xyzw().map(rounded)).into()
        };
        Self {
            session: frame.session.to_string(),
            reference_from_session: frame.reference_from_session.map(shown),
            residual: frame.residual_m.map(rounded),
            loops: frame.loops,
        }
    }
}

impl From<Suspect> for SuspectView {
    fn from(suspect: Suspect) -> Self {
        Self {
            loop_id: suspect.loop_id.to_string(),
            cycle: suspect.cycle.iter().map(ToString::to_string).collect(),
            residual: rounded(suspect.off_m),
            residual_rad: rounded(suspect.off_rad),
        }
    }
}
