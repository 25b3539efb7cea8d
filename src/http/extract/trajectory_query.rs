//! The trajectory to export, and its format.

use utoipa::IntoParams;

use crate::api::decoding::read::{self, Decode, Node};
use crate::api::trajectory::TrajectoryFormat;
use crate::domain::ids::SessionId;

/// The parameters of a trajectory.
#[derive(IntoParams)]
#[into_params(parameter_in = Query)]
#[expect(dead_code, reason = "documents what the reader reads")]
pub struct TrajectorySearch {
    /// `tum`, `kitti` or `g2o`.
    #[param(pattern = "^(tum|kitti|g2o)$", example = "tum")]
    format: String,
    /// Only this session; required for `tum` and `kitti` if the map has several.
    #[param(
        min_length = 1,
        max_length = 128,
        pattern = "^(\\.{0,2}[A-Za-z0-9_:-]|\\.{3})[A-Za-z0-9._:-]*$",
        example = "robot-7"
    )]
    session: Option<String>,
    /// `session`: each session in its own frame, which is the default. `fleet`: all sessions that loops and plans join, in the frame of
    /// one of them (`GET .../frames`); `tum` and `kitti` then take several sessions, each after a comment with its name; comments name those that nothing joins.
    #[param(pattern = "^(session|fleet)$")]
    frame: Option<String>,
    /// With `frame=fleet`, the session in whose frame all are.
    #[param(min_length = 1, max_length = 128, pattern = "^(\\.{0,2}[A-Za-z0-9_:-]|\\.{3})[A-Za-z0-9._:-]*$")]
    reference: Option<String>,
}

/// The trajectory to export, and its format.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TrajectoryQuery {
    /// The format.
    pub format: TrajectoryFormat,
    /// The session, if given.
    pub session: Option<SessionId>,
    /// Whether the poses are to be in one frame.
    pub in_fleet_frame: bool,
    /// The session in whose frame they are to be, if given.
    pub reference: Option<SessionId>,
}

impl Decode for TrajectoryQuery {
    fn decode(node: &Node<'_>) -> Option<Self> {
        let query = node.object(&["format", "session", "frame", "reference"])?;
        let format = query
            .required("format", |node| node.choice(&TrajectoryFormat::NAMES, TrajectoryFormat::from_name));
        let session = query.optional("session", read::id);
        let frame = query.optional("frame", |node| {
            node.choice(&["session", "fleet"], |name| match name {
                "session" => Some(false),
                "fleet" => Some(true),
                _ => None,
            })
        });
        let reference = query.optional("reference", read::id);
        let in_fleet_frame = frame?.unwrap_or(false);
        Some(Self { format: format?, session: session?, in_fleet_frame, reference: reference? })
    }
}
