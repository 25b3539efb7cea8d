//! The trajectory to export, and its format.

use revisit_shapes::params;

use crate::api::decoding::read::Node;
use crate::api::trajectory::TrajectoryFormat;
use crate::domain::ids::SessionId;

/// The trajectory to export, and its format.
#[params]
pub struct TrajectoryQuery {
    /// `tum`, `kitti` or `g2o`.
    #[param(value_type = String, pattern = "^(tum|kitti|g2o)$", example = "tum")]
    #[read(format)]
    pub format: TrajectoryFormat,
    /// Only this session; required for `tum` and `kitti` if the map has several.
    #[id]
    #[param(example = "robot-7")]
    pub session: Option<SessionId>,
    /// `session`: each session in its own frame, which is the default. `fleet`: all sessions that loops and plans join, in the frame of
    /// one of them (`GET .../frames`); `tum` and `kitti` then take several sessions, each after a comment with its name; comments name those that nothing joins.
    #[param(value_type = Option<String>, pattern = "^(session|fleet)$")]
    #[read(is_fleet)]
    pub frame: Option<bool>,
    /// With `frame=fleet`, the session in whose frame all are.
    #[id]
    pub reference: Option<SessionId>,
}

fn format(node: &Node<'_>) -> Option<TrajectoryFormat> {
    node.choice(&TrajectoryFormat::NAMES, TrajectoryFormat::from_name)
}

/// Reads whether the poses are to be in one frame.
fn is_fleet(node: &Node<'_>) -> Option<bool> {
    node.choice(&["session", "fleet"], |name| match name {
        "session" => Some(false),
        "fleet" => Some(true),
        _ => None,
    })
}
