//! A crop as JSON has it: an image file in base64.

use revisit_core::domain::counted::counted;
use revisit_core::domain::keyframe::Crop;
use serde::{Deserialize, Deserializer, Serialize, Serializer, de};

use crate::decoding::base64::{self, Base64};
use crate::decoding::read::{Decode, Node};
use crate::limits;

/// The image inside a detection's box, PNG or JPEG.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CropShape(pub Crop);

fn image(bytes: Vec<u8>) -> Option<Crop> {
    Some(Crop { media_type: Crop::media_type_of(&bytes)?, bytes })
}

impl Decode for CropShape {
    fn decode(node: &Node<'_>) -> Option<Self> {
        let bytes = node.bytes()?;
        if bytes.len() > limits::CROP_BYTES {
            let detail = format!("the crop is {}", counted(bytes.len(), "byte"));
            return node.refuse(detail, format!("{} bytes", limits::CROP_BYTES));
        }
        match image(bytes) {
            Some(crop) => Some(Self(crop)),
            None => node.refuse("the crop is neither a PNG nor a JPEG file", "PNG or JPEG"),
        }
    }
}

impl Serialize for CropShape {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&base64::encode(&self.0.bytes))
    }
}

impl<'de> Deserialize<'de> for CropShape {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let Base64(bytes) = Base64::deserialize(deserializer)?;
        image(bytes).map(Self).ok_or_else(|| de::Error::custom("neither a PNG nor a JPEG file"))
    }
}
