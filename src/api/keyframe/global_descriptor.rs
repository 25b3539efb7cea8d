//! The vector of a whole image, as clients send it and as it is answered.

use revisit_shapes::answer;

use crate::api::decoding::base64;
use crate::api::decoding::read::{self, Node};
use crate::api::names::GlobalEncodingName;
use crate::domain::counted::counted;
use crate::domain::global_descriptor::{GlobalDescriptor, GlobalEncoding};

/// One vector of a whole image, by a model that the client ran. The first one of a map decides: all of them have one model, one
/// encoding and one size.
#[answer]
#[serde(deny_unknown_fields)]
#[schema(as = GlobalDescriptor)]
pub struct GlobalDescriptorShape {
    /// The model that computed it, with all that changes its numbers, such as a version.
    #[schema(
        min_length = 1,
        max_length = 128,
        pattern = "^(\\.{0,2}[A-Za-z0-9_:-]|\\.{3})[A-Za-z0-9._:-]*$"
    )]
    pub model: String,
    /// The form of its numbers.
    pub encoding: GlobalEncodingName,
    /// The numbers one after the other, in base64: 1 to 1,056 bytes.
    #[schema(min_length = 2, max_length = 1_408)]
    pub data: String,
}

impl From<GlobalDescriptor> for GlobalDescriptorShape {
    fn from(descriptor: GlobalDescriptor) -> Self {
        let GlobalDescriptor { model, encoding, data } = descriptor;
        Self { model: model.to_string(), encoding: encoding.into(), data: base64::encode(&data) }
    }
}

/// Reads `global_descriptor`.
pub(super) fn decode(node: &Node<'_>) -> Option<GlobalDescriptor> {
    let body = node.object(&["model", "encoding", "data"])?;
    let model = body.required("model", read::id);
    let encoding =
        body.required("encoding", |node| node.choice(GlobalEncoding::NAMES, GlobalEncoding::from_name));
    let data = body.required("data", |node| {
        let bytes = node.bytes()?;
        if bytes.is_empty() || bytes.len() > GlobalDescriptor::MAX_BYTES {
            let limit = format!("1 to {} bytes", GlobalDescriptor::MAX_BYTES);
            return node.refuse_as("a descriptor of this size", counted(bytes.len(), "byte"), limit);
        }
        Some(bytes.into_boxed_slice())
    });
    Some(GlobalDescriptor { model: model?, encoding: encoding?, data: data? })
}
