//! The session in whose frame the others are.

use utoipa::IntoParams;

use crate::api::decoding::read::{self, Decode, Node};
use crate::domain::ids::SessionId;

/// The parameters of frames.
#[derive(IntoParams)]
#[into_params(parameter_in = Query)]
#[expect(dead_code, reason = "documents what the reader reads")]
pub struct FramesSearch {
    /// The session in whose frame the others are; left out: the oldest of those that most sessions are joined with.
    #[param(min_length = 1, max_length = 128, pattern = "^(\\.{0,2}[A-Za-z0-9_:-]|\\.{3})[A-Za-z0-9._:-]*$")]
    reference: Option<String>,
}

/// The session in whose frame the others are, if one was chosen.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FramesQuery {
    /// The session.
    pub reference: Option<SessionId>,
}

impl Decode for FramesQuery {
    fn decode(node: &Node<'_>) -> Option<Self> {
        let query = node.object(&["reference"])?;
        Some(Self { reference: query.optional("reference", read::id)? })
    }
}
