//! The shape in which a client sends a keyframe (`openapi/openapi.yaml`).

use revisit_shapes::answer;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::global_descriptor::GlobalDescriptorShape;
use super::number_shape::{
    Direction, KeypointNumbers, Pixels, PointNumber, PointNumberOrNone, Position, WordNumber, WordWeight,
};
use super::sent_shape::{SentBow, SentFeatures, SentPoints};
use crate::api::space::{Time, Transform};

/// A keyframe to be stored, or asked about without being stored. Only `stamp` and `pose` are required.
#[answer]
#[serde(deny_unknown_fields)]
#[schema(as = Keyframe)]
pub struct KeyframeBody {
    /// One robot's run: its own frame and its own numbering of map points.
    #[schema(
        default = "default",
        min_length = 1,
        max_length = 128,
        pattern = "^(\\.{0,2}[A-Za-z0-9_:-]|\\.{3})[A-Za-z0-9._:-]*$"
    )]
    pub session: Option<String>,
    /// When it was taken.
    pub stamp: Time,
    /// `map_from_camera` in the session's frame, in metres; the camera looks along z, x is right and y down.
    pub pose: Transform,
    /// The undistorted pinhole camera.
    pub camera: Option<CameraShape>,
    /// The unit vector of gravity in the camera frame, where the client knows it: `[0,1,0]` for a camera held upright.
    #[schema(value_type = Option<Direction>, inline)]
    pub gravity: Option<[f64; 3]>,
    /// The bag of words; left out or empty for a blank wall.
    #[schema(value_type = Option<SentBow>)]
    pub bow: Option<BowShape>,
    /// The vector of the whole image, by a model that the client ran.
    pub global_descriptor: Option<GlobalDescriptorShape>,
    /// Binary features.
    #[schema(value_type = Option<SentFeatures>)]
    pub features: Option<FeaturesShape>,
    /// Map points new or moved; the order does not matter, and answers list them by number.
    #[schema(value_type = Option<SentPoints>)]
    pub map_points: Option<PointsShape>,
    /// Map points observed, besides those of `features.map_points`; the order does not matter.
    #[schema(max_items = 100_000, value_type = Option<Vec<PointNumber>>, inline)]
    pub observes: Option<Vec<i64>>,
    /// The same, packed: base64 of little-endian 64-bit signed numbers.
    #[schema(max_length = 1_066_668)]
    pub observes_i64: Option<String>,
    /// Covisible keyframes known to the client, also across sessions; each must exist. An empty list says that there are none.
    /// Left out, and without map points: the keyframes near along the drive count as covisible (`covisibility_max_way_m`).
    #[schema(max_items = 10000)]
    pub covisible: Option<Vec<CovisibleShape>>,
    /// The objects detected in it.
    #[schema(max_items = 500)]
    pub detections: Option<Vec<DetectionShape>>,
}

/// A pinhole camera; keypoints and boxes are undistorted too.
#[answer]
#[derive(Copy)]
#[serde(deny_unknown_fields)]
#[schema(as = Camera)]
pub struct CameraShape {
    /// Focal length along x, in pixels.
    #[schema(minimum = 0.001, maximum = 1e6)]
    pub fx: f64,
    /// Focal length along y, in pixels.
    #[schema(minimum = 0.001, maximum = 1e6)]
    pub fy: f64,
    /// Principal point, x, in pixels.
    #[schema(minimum = -1e6, maximum = 1e6)]
    pub cx: f64,
    /// Principal point, y, in pixels.
    #[schema(minimum = -1e6, maximum = 1e6)]
    pub cy: f64,
    /// Image width, in pixels.
    #[schema(minimum = 1, maximum = 1_000_000)]
    pub width: u32,
    /// Image height, in pixels.
    #[schema(minimum = 1, maximum = 1_000_000)]
    pub height: u32,
}

/// A bag of words: two lists in parallel, in any order.
#[answer]
#[serde(deny_unknown_fields)]
#[schema(as = BagOfWords)]
pub struct BowShape {
    /// The words, none twice.
    #[schema(max_items = 65535, value_type = Vec<WordNumber>, inline)]
    pub words: Vec<u32>,
    /// Their weights, without unit; normalised to sum to one on arrival.
    #[schema(max_items = 65535, value_type = Vec<WordWeight>, inline)]
    pub weights: Vec<f64>,
    /// Whose words these are, such as a vocabulary's fingerprint. Words of two vocabularies do not go into one map.
    #[schema(max_length = 128)]
    pub vocabulary: Option<String>,
}

/// Binary features: three lists in parallel.
#[answer]
#[serde(deny_unknown_fields)]
#[schema(as = Features)]
pub struct FeaturesShape {
    /// Bytes of one descriptor: 32 for ORB, 64 for BRISK.
    #[schema(minimum = 8, maximum = 512, multiple_of = 8)]
    pub descriptor_bytes: u32,
    /// The descriptors one after the other, in base64.
    #[schema(max_length = 13_653_336)]
    pub descriptors: String,
    /// One for each descriptor: `[u,v]`, `[u,v,octave]` or `[u,v,octave,angle_deg]`, in pixels, pyramid level and degrees.
    #[schema(max_items = 20000, value_type = Vec<KeypointNumbers>, inline)]
    pub keypoints: Vec<Vec<f64>>,
    /// The map point that each feature observes, -1 for none; left out if none does.
    #[schema(max_items = 20000, value_type = Option<Vec<PointNumberOrNone>>, inline)]
    pub map_points: Option<Vec<i64>>,
}

/// Positions of map points: two lists in parallel.
#[answer]
#[derive(Default)]
#[serde(deny_unknown_fields)]
#[schema(as = MapPoints)]
pub struct PointsShape {
    /// The points' numbers in their session, none twice.
    #[schema(max_items = 100_000, value_type = Vec<PointNumber>, inline)]
    pub ids: Vec<i64>,
    /// `[x,y,z]` of each in the session's frame, in metres.
    #[schema(max_items = 100_000, value_type = Vec<Position>, inline)]
    pub positions: Vec<[f64; 3]>,
}

/// A covisible keyframe as a client declares it.
#[answer]
#[serde(deny_unknown_fields)]
#[schema(as = CovisibleKeyframe)]
pub struct CovisibleShape {
    /// The other keyframe; it must exist.
    #[schema(
        min_length = 1,
        max_length = 128,
        pattern = "^(\\.{0,2}[A-Za-z0-9_:-]|\\.{3})[A-Za-z0-9._:-]*$"
    )]
    pub keyframe: String,
    /// How many map points the two share; it counts whatever it is.
    #[schema(value_type = i64, minimum = 0, maximum = 4_294_967_295_i64)]
    pub shared: u32,
}

/// The origin of a position's distance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum RangeName {
    /// By depth, stereo, a laser or map points.
    Measured,
    /// By a guess.
    Assumed,
}

/// An object detected in a keyframe.
#[answer]
#[serde(deny_unknown_fields)]
#[schema(as = Detection)]
pub struct DetectionShape {
    /// The object's class, such as `door_number`; printable.
    #[schema(min_length = 1, max_length = 64)]
    pub class: String,
    /// The detector's confidence.
    #[schema(minimum = 0, maximum = 1)]
    pub confidence: f64,
    /// `[x0,y0,x1,y1]` in pixels, x0 <= x1 and y0 <= y1; it may reach out of the image.
    #[serde(rename = "box")]
    #[schema(value_type = Vec<Pixels>, inline, min_items = 4, max_items = 4)]
    pub box_px: [f64; 4],
    /// The map points that the box covers: the object's place.
    #[schema(max_items = 100_000, value_type = Option<Vec<PointNumber>>, inline)]
    pub map_points: Option<Vec<i64>>,
    /// Where the object stands in the session's frame, in metres; serves where it has no map points.
    #[schema(value_type = Option<Position>, inline)]
    pub position: Option<[f64; 3]>,
    /// `assumed` if nothing measured the distance of `position`, say where it rests on the height that letters have as a rule:
    /// then only its bearing counts. Left out, it was measured.
    #[schema(inline)]
    pub range: Option<RangeName>,
    /// What a reader made of it.
    #[schema(max_length = 4096)]
    pub text: Option<String>,
    /// What a model or a person made of it; wins over `text`.
    #[schema(max_length = 4096)]
    pub description: Option<String>,
    /// The image inside the box, PNG or JPEG of at most 4 MiB, in base64.
    #[schema(max_length = 5_592_408)]
    pub crop: Option<String>,
}
