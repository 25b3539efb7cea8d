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
}

/// The trajectory to export, and its format.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TrajectoryQuery {
    /// The format.
    pub format: TrajectoryFormat,
    /// The session, if given.
    pub session: Option<SessionId>,
}

impl Decode for TrajectoryQuery {
    fn decode(node: &Node<'_>) -> Option<Self> {
        let query = node.object(&["format", "session"])?;
        let format = query
            .required("format", |node| node.choice(&TrajectoryFormat::NAMES, TrajectoryFormat::from_name));
        let session = query.optional("session", read::id);
        Some(Self { format: format?, session: session? })
    }
}
