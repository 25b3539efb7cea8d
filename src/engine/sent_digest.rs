//! The digest of a keyframe as sent, by every rule that a stored one may have.

use std::fmt;
use std::sync::Arc;

use crate::domain::request::{Digest, KeyframeDigest};

/// The digest of a keyframe as sent: tells a retry from another keyframe under the same id.
#[derive(Clone)]
pub struct SentDigest {
    of_facts: Digest,
    // Only a retry of what a server of before the new rule stored needs it.
    of_text: Arc<dyn Fn() -> Option<Digest> + Send + Sync>,
}

impl SentDigest {
    /// Takes the digest of the facts, and a function that makes the one of the body's text where it is needed.
    pub fn new(of_facts: Digest, of_text: impl Fn() -> Option<Digest> + Send + Sync + 'static) -> Self {
        Self { of_facts, of_text: Arc::new(of_text) }
    }

    /// Returns the digest to be stored.
    pub fn stored(&self) -> KeyframeDigest {
        KeyframeDigest::OfFacts(self.of_facts)
    }

    /// Whether a stored keyframe was sent as this one.
    pub fn is(&self, stored: KeyframeDigest) -> bool {
        match stored {
            KeyframeDigest::OfFacts(digest) => digest == self.of_facts,
            KeyframeDigest::OfText(digest) => Some(digest) == (self.of_text)(),
        }
    }
}

/// The digest of a keyframe that never was a text.
impl From<Digest> for SentDigest {
    fn from(of_facts: Digest) -> Self {
        Self::new(of_facts, || None)
    }
}

impl fmt::Debug for SentDigest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("SentDigest").field(&self.of_facts).finish()
    }
}
