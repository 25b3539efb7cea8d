//! Frames: the places of a map's sessions relative to each other, and the loops that contradict it (`openapi/openapi.yaml`).

use revisit_core::domain::fleet_frames::Suspect;
use revisit_core::domain::report::{FrameReport, FramesReport};
use revisit_shapes::answer;

use super::space::Transform;

/// One frame for all sessions of a map.
#[answer(of = FramesReport)]
#[schema(as = Frames)]
pub struct FramesView {
    /// The map's version that it was computed at. While what loops and plans say stays the same, so does it.
    pub version: u64,
    /// The session in whose frame the others are; left out in a map without sessions.
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
#[answer(of = FrameReport)]
#[schema(as = Frame)]
pub struct FrameView {
    /// The session.
    pub session: String,
    /// Maps points of its frame into that of the reference; left out if no loop and no plan joins the two.
    #[is(of.reference_from_session.as_ref().map(Transform::computed))]
    pub reference_from_session: Option<Transform>,
    /// Root mean square of what its loops are off from the frames, in metres; left out without any. Frames are rigid, so that drift
    /// within a session shows here.
    #[from(of.residual_m)]
    #[rounded]
    pub residual: Option<f64>,
    /// Number of its loops with other sessions that count.
    pub loops: usize,
}

/// A confirmed loop that contradicts the others. Nothing is revoked unasked: `DELETE /v1/maps/{map}/loops/{loop}` does it.
#[answer(of = Suspect)]
#[schema(as = Suspect)]
pub struct SuspectView {
    /// The loop.
    #[serde(rename = "loop")]
    pub loop_id: String,
    /// The loops that lead from the one of its sessions to the other, and do not agree with it; empty where it is within one session,
    /// whose tracking it contradicts. A plan that is passed has no id.
    pub cycle: Vec<String>,
    /// The gap of the cycle, in metres.
    #[from(of.off_m)]
    #[rounded]
    pub residual: f64,
    /// Its gap in rotation, in rad.
    #[from(of.off_rad)]
    #[rounded]
    pub residual_rad: f64,
}
