//! A global descriptor: one vector of a whole image, by a model that the client ran.

use serde::{Deserialize, Serialize};

use super::ids::GlobalModelId;
use crate::named::named;

named! {
    /// The form of a global descriptor's numbers, and so the measure of their likeness.
    GlobalEncoding {
        /// Signed bytes, compared by the cosine of their angle.
        Int8 = "int8",
        /// Bits, compared by how many are equal.
        Bits = "bits",
    }
}

/// One vector of a whole image.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct GlobalDescriptor {
    /// The model that computed it, named by the client.
    pub model: GlobalModelId,
    /// The form of its numbers.
    pub encoding: GlobalEncoding,
    /// The numbers, one after the other; not empty.
    pub data: Box<[u8]>,
}

/// What global descriptors have in common where they can be compared.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GlobalForm {
    /// The model.
    pub model: GlobalModelId,
    /// The form of its numbers.
    pub encoding: GlobalEncoding,
    /// The size of each, in bytes.
    pub bytes: usize,
}

impl GlobalDescriptor {
    /// The most bytes of one: 8,448 bits, which is what MegaLoc computes, or as many signed bytes.
    pub const MAX_BYTES: usize = 1_056;

    /// Returns what it has in common with those that it can be compared with.
    pub fn form(&self) -> GlobalForm {
        GlobalForm { model: self.model.clone(), encoding: self.encoding, bytes: self.data.len() }
    }

    /// Whether it has this form.
    pub fn is_of(&self, form: &GlobalForm) -> bool {
        (&self.model, self.encoding, self.data.len()) == (&form.model, form.encoding, form.bytes)
    }

    /// Returns what it takes on disk, in bytes.
    pub fn bytes(&self) -> usize {
        self.model.as_str().len() + self.encoding.as_str().len() + self.data.len()
    }
}
