//! A keypoint as JSON has it: a list of two to four numbers.

use revisit_core::domain::keyframe::Keypoint;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::decoding::document::Kind;
use crate::decoding::read::{Decode, Node};
use crate::limits;

/// `[u,v]`, `[u,v,octave]` or `[u,v,octave,angle_deg]`: pixels, pyramid level (a whole number of 0 to 63), degrees.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(into = "Vec<f64>", try_from = "Vec<f64>")]
#[schema(value_type = Vec<f64>, min_items = 2, max_items = 4)]
pub struct KeypointShape(pub Keypoint);

impl Decode for KeypointShape {
    fn decode(node: &Node<'_>) -> Option<Self> {
        let numbers = node.value();
        if numbers.kind() == Kind::List && !(2..=4).contains(&numbers.len()) {
            return node
                .refuse("a keypoint is [u,v], [u,v,octave] or [u,v,octave,angle_deg]", "2 to 4 numbers");
        }
        let mut keypoint = Keypoint { u: 0.0, v: 0.0, octave: 0, angle_deg: None };
        node.each(4, |at, number| {
            match at {
                0 => keypoint.u = number.number(limits::PIXEL)?,
                1 => keypoint.v = number.number(limits::PIXEL)?,
                2 => keypoint.octave = number.whole(limits::OCTAVE)? as u8,
                _ => keypoint.angle_deg = Some(number.number(limits::ANGLE_DEG)?),
            }
            Some(())
        })?;
        Some(Self(keypoint))
    }
}

impl From<KeypointShape> for Vec<f64> {
    fn from(KeypointShape(keypoint): KeypointShape) -> Self {
        let numbers = [keypoint.u, keypoint.v, f64::from(keypoint.octave)];
        numbers.into_iter().chain(keypoint.angle_deg).collect()
    }
}

impl TryFrom<Vec<f64>> for KeypointShape {
    type Error = &'static str;

    fn try_from(numbers: Vec<f64>) -> Result<Self, Self::Error> {
        let [u, v, ref more @ ..] = numbers[..] else { return Err("a keypoint has two to four numbers") };
        let octave = more.first().map_or(0, |octave| *octave as u8);
        Ok(Self(Keypoint { u, v, octave, angle_deg: more.get(1).copied() }))
    }
}
