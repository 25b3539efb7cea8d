//! The session in whose frame the others are.

use revisit_shapes::params;

use crate::domain::ids::SessionId;

/// The session in whose frame the others are, if one was chosen.
#[params]
pub struct FramesQuery {
    /// The session in whose frame the others are; left out: the oldest of those that most sessions are joined with.
    #[id]
    pub reference: Option<SessionId>,
}
