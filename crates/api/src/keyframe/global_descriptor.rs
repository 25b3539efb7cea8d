//! The vector of a whole image, as clients send it and as it is answered.

use revisit_core::domain::counted::counted;
use revisit_core::domain::global_descriptor::GlobalDescriptor;
use revisit_core::domain::ids::GlobalModelId;
use revisit_shapes::body;

use crate::decoding::base64::Base64;
use crate::decoding::read::Node;
use crate::names::GlobalEncodingName;

/// One vector of a whole image, by a model that the client ran. The first one of a map decides: all of them have one model, one
/// encoding and one size.
#[body(of = GlobalDescriptor)]
#[schema(as = GlobalDescriptor)]
pub struct GlobalDescriptorShape {
    /// The model that computed it, with all that changes its numbers, such as a version.
    #[id]
    pub model: GlobalModelId,
    /// The form of its numbers.
    pub encoding: GlobalEncodingName,
    /// The numbers one after the other, in base64: 1 to 1,056 bytes.
    #[schema(value_type = String, min_length = 2, max_length = 1_408)]
    #[read(data)]
    #[is(Base64(of.data.into()))]
    pub data: Base64,
}

impl From<GlobalDescriptorShape> for GlobalDescriptor {
    fn from(shape: GlobalDescriptorShape) -> Self {
        Self { model: shape.model, encoding: shape.encoding.0, data: shape.data.0.into() }
    }
}

fn data(node: &Node<'_>) -> Option<Base64> {
    let bytes = node.bytes()?;
    if bytes.is_empty() || bytes.len() > GlobalDescriptor::MAX_BYTES {
        let limit = format!("1 to {} bytes", GlobalDescriptor::MAX_BYTES);
        return node.refuse_as("a descriptor of this size", counted(bytes.len(), "byte"), limit);
    }
    Some(Base64(bytes))
}
