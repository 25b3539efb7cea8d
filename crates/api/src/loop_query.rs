//! Loop query: "is this keyframe a loop?" as a client asks it (`openapi/openapi.yaml`).

use revisit_core::domain::ids::{KeyframeId, ReleaseName};
use revisit_core::domain::request::{LoopQuery, Subject};
use revisit_shapes::body;

use super::decoding::read::Node;
use super::keyframe::{self, Keyframe, KeyframeBody};
use super::names::VerifyName;

/// A loop query: about a stored keyframe, or about one sent along and not stored. Exactly one of `keyframe` and `inline`.
#[body(checked LoopQuery)]
#[derive(Default)]
pub struct LoopQueryBody {
    /// The id of a stored keyframe.
    #[id]
    pub keyframe: Option<KeyframeId>,
    /// A keyframe that is not stored.
    #[schema(value_type = Option<Keyframe>)]
    pub inline: Option<KeyframeBody>,
    /// The release of the map that is asked; left out: the map as it stands. A stored keyframe must be one of the release.
    #[id]
    pub release: Option<ReleaseName>,
    /// The checks that must run.
    pub verify: Option<VerifyName>,
    /// Maximum wait for models that are still judging, in milliseconds.
    #[schema(default = 0, minimum = 0, maximum = 60000)]
    pub max_wait_ms: Option<u64>,
    /// The seed of what is drawn at random.
    #[schema(default = 0, minimum = 0)]
    pub seed: Option<i64>,
    /// Whether a loop that repeats a confirmed one is a `loop`, too, and not `already_closed`.
    #[schema(default = false)]
    pub again: Option<bool>,
}

impl LoopQueryBody {
    fn checked(self, node: &Node<'_>) -> Option<LoopQuery> {
        let subject = match (self.keyframe, self.inline) {
            (Some(id), None) => Subject::Stored(id),
            (None, Some(body)) => {
                let sent = keyframe::unnamed(body)?;
                Subject::Inline(Box::new(sent.keyframe), sent.digest)
            }
            _ => return node.refuse("ask about one keyframe", "either \"keyframe\" or \"inline\""),
        };
        Some(LoopQuery {
            subject,
            release: self.release,
            verify: self.verify.map(|verify| verify.0).unwrap_or_default(),
            max_wait_ms: self.max_wait_ms.unwrap_or(0),
            seed: self.seed.unwrap_or(0).unsigned_abs(),
            again: self.again.unwrap_or(false),
        })
    }
}
