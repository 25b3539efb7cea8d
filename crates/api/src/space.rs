//! Space and time: vectors, quaternions, transforms and stamps, written as ROS messages write them.

use revisit_core::domain::keyframe::Stamp;
use revisit_core::geometry::{Gravity, Pose, Sim3};
use revisit_shapes::body;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::decoding::read::{Decode, Node};
use super::limits;
use super::shown::Shown;

/// A vector, in metres.
#[body]
#[derive(Copy, Default)]
pub struct Vector3 {
    /// Along x, in metres.
    #[schema(minimum = -1e9, maximum = 1e9)]
    pub x: f64,
    /// Along y, in metres.
    #[schema(minimum = -1e9, maximum = 1e9)]
    pub y: f64,
    /// Along z, in metres.
    #[schema(minimum = -1e9, maximum = 1e9)]
    pub z: f64,
}

/// `[x,y,z]`, in metres.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(transparent)]
#[schema(value_type = Vec<f64>, min_items = 3, max_items = 3, minimum = -1e9, maximum = 1e9)]
pub struct Position(pub [f64; 3]);

impl Decode for Position {
    fn decode(node: &Node<'_>) -> Option<Self> {
        node.numbers(limits::COORDINATE_M).map(Self)
    }
}

/// A rotation as a unit quaternion, without unit; a norm more than 1 % off one is refused.
#[body]
#[derive(Copy, Default)]
pub struct Quaternion {
    /// Imaginary part, i.
    #[schema(minimum = -1.01, maximum = 1.01)]
    pub x: f64,
    /// Imaginary part, j.
    #[schema(minimum = -1.01, maximum = 1.01)]
    pub y: f64,
    /// Imaginary part, k.
    #[schema(minimum = -1.01, maximum = 1.01)]
    pub z: f64,
    /// Real part.
    #[schema(minimum = -1.01, maximum = 1.01)]
    pub w: f64,
}

/// A rigid transformation, as ROS `geometry_msgs/Transform`.
#[body(of = Pose)]
#[derive(Copy, Default)]
pub struct Transform {
    /// In metres.
    #[from(of.translation_m())]
    pub translation: Vector3,
    /// A unit quaternion.
    #[read(rotation)]
    #[from(of.rotation_xyzw())]
    pub rotation: Quaternion,
}

/// A moment on the robot's clock, as ROS `builtin_interfaces/Time`.
#[body(same Stamp, of = Stamp)]
#[derive(Copy, Default)]
pub struct Time {
    /// Whole seconds.
    #[schema(minimum = -62_135_596_800_i64, maximum = 253_402_300_799_i64)]
    pub sec: i64,
    /// Nanoseconds within the second.
    #[schema(minimum = 0, maximum = 999_999_999)]
    pub nanosec: u32,
}

impl Transform {
    /// Returns the pose; `None` if the quaternion is none of length one.
    pub fn pose(self) -> Option<Pose> {
        let Self { translation: at, rotation: by } = self;
        Pose::new([at.x, at.y, at.z], [by.x, by.y, by.z, by.w])
    }

    /// Returns a computed pose as answers show it.
    pub fn computed(pose: &Pose) -> Self {
        Pose::from_stored(pose.translation_m().map(rounded), pose.rotation_xyzw().map(rounded)).into()
    }
}

impl Shown<[f64; 3]> for Vector3 {
    fn shown([x, y, z]: [f64; 3]) -> Self {
        Self { x, y, z }
    }
}

impl Shown<[f64; 4]> for Quaternion {
    fn shown([x, y, z, w]: [f64; 4]) -> Self {
        Self { x, y, z, w }
    }
}

/// Reads a quaternion of length one.
fn rotation(node: &Node<'_>) -> Option<Quaternion> {
    let read = Quaternion::decode(node);
    // The norm of a quaternion with a part that is too large tells what is wrong with it: it was not normalised.
    if let [Some(x), Some(y), Some(z), Some(w)] =
        ["x", "y", "z", "w"].map(|part| node.value().get(part)?.as_f64())
        && Pose::new([0.0; 3], [x, y, z, w]).is_none()
    {
        let norm = rounded((x * x + y * y + z * z + w * w).sqrt());
        let detail = format!("not a unit quaternion: its norm is {norm}");
        return node.refuse_as(detail, format!("a norm of {norm}"), "a norm of 1, within 1 %");
    }
    read
}

impl Decode for Gravity {
    fn decode(node: &Node<'_>) -> Option<Self> {
        let vector = node.numbers::<3>(limits::DIRECTION)?;
        let limit = || format!("a norm of 1, within {}", Self::MAX_NORM_ERROR);
        let norm = || rounded(vector.iter().map(|part| part * part).sum::<f64>().sqrt());
        Self::new(vector)
            .or_else(|| node.refuse_as("not a unit vector", format!("a norm of {}", norm()), limit()))
    }
}

/// Returns a number as answers show what was computed: to nine decimals, which is finer than any sensor and hides the
/// noise of the last bits. What a client sent is given back as it was.
pub fn rounded(number: f64) -> f64 {
    const DECIMALS: f64 = 1e9;
    let scaled = (number * DECIMALS).round();
    // Beyond 2^53 there are no such decimals; and -0 is written "-0.0", which puzzles readers.
    if scaled.abs() < 9e15 { scaled / DECIMALS + 0.0 } else { number }
}

/// A similarity transformation: scaled, rotated, then moved.
#[body(of = Sim3)]
#[derive(Copy)]
#[schema(as = SentSimilarity)]
pub struct SimilarityShape {
    /// In metres.
    #[from(of.translation_m())]
    pub translation: Vector3,
    /// A unit quaternion.
    #[read(rotation)]
    #[from(of.rotation_xyzw())]
    pub rotation: Quaternion,
    /// Ratio of a length in the outer frame to the same in the inner one; 1 if left out.
    #[schema(minimum = 1e-6, maximum = 1e6, default = 1.0)]
    #[is(Some(of.scale()))]
    pub scale: Option<f64>,
}

impl SimilarityShape {
    /// Returns the transformation; `None` if the quaternion is none of length one.
    pub fn sim3(self) -> Option<Sim3> {
        let Self { translation, rotation, scale } = self;
        Some(Sim3::scaled(Transform { translation, rotation }.pose()?, scale.unwrap_or(1.0)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn computed_numbers_have_nine_decimals() {
        assert_eq!(rounded(0.1 + 0.2), 0.3);
        assert_eq!(rounded(1e20 + 0.5), 1e20);
        assert!(rounded(-1e-12).is_sign_positive());
    }
}
