//! Loop query: "is this keyframe a loop?" as a client asks it (`openapi/openapi.yaml`).

use revisit_shapes::answer;

use super::decoding::read::{self, Decode, Node};
use super::keyframe::{self, KeyframeBody};
use super::limits;
use super::names::VerifyName;
use crate::domain::request::{LoopQuery, Subject};
use crate::domain::verdict::Verify;

/// A loop query: about a stored keyframe, or about one sent along and not stored. Exactly one of `keyframe` and `inline`.
#[answer]
#[derive(Default)]
#[serde(deny_unknown_fields)]
pub struct LoopQueryBody {
    /// The id of a stored keyframe.
    #[schema(min_length = 1, max_length = 128, pattern = r"^(\.{0,2}[A-Za-z0-9_:-]|\.{3})[A-Za-z0-9._:-]*$")]
    pub keyframe: Option<String>,
    /// A keyframe that is not stored.
    pub inline: Option<KeyframeBody>,
    /// The release of the map that is asked; left out: the map as it stands. A stored keyframe must be one of the release.
    #[schema(min_length = 1, max_length = 128, pattern = r"^(\.{0,2}[A-Za-z0-9_:-]|\.{3})[A-Za-z0-9._:-]*$")]
    pub release: Option<String>,
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

impl Decode for LoopQuery {
    fn decode(node: &Node<'_>) -> Option<Self> {
        let body =
            node.object(&["keyframe", "inline", "release", "verify", "max_wait_ms", "seed", "again"])?;
        let stored = body.optional("keyframe", read::id);
        let inline = body.optional("inline", keyframe::unnamed);
        let release = body.optional("release", read::id);
        let verify = body.optional("verify", |node| node.choice(Verify::NAMES, Verify::from_name));
        let max_wait_ms = body.optional("max_wait_ms", |node| node.whole(limits::MAX_WAIT_MS));
        let seed = body.optional("seed", |node| node.whole(limits::SEED));
        let again = body.optional("again", read::switch);
        if body.has("keyframe") == body.has("inline") {
            return node.refuse("ask about one keyframe", "either \"keyframe\" or \"inline\"");
        }
        let subject = match (stored?, inline?) {
            (Some(id), _) => Subject::Stored(id),
            (None, sent) => sent.map(|sent| Subject::Inline(Box::new(sent.keyframe), sent.digest))?,
        };
        Some(Self {
            subject,
            release: release?,
            verify: verify?.unwrap_or_default(),
            max_wait_ms: max_wait_ms?.unwrap_or(0).unsigned_abs(),
            seed: seed?.unwrap_or(0).unsigned_abs(),
            again: again?.unwrap_or(false),
        })
    }
}
