//! The shape in which a client sends a keyframe (`openapi/openapi.yaml`).

use std::collections::HashSet;

use revisit_core::domain::counted::counted;
use revisit_core::domain::ids::{KeyframeId, SessionId};
use revisit_core::domain::keyframe::{Camera, Detection, Features};
use revisit_core::geometry::Gravity;
use revisit_shapes::body;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::crop::CropShape;
use super::global_descriptor::GlobalDescriptorShape;
use super::keypoint::KeypointShape;
use crate::decoding::base64::Base64;
use crate::decoding::document::Json;
use crate::decoding::read::{Decode as _, Node};
use crate::limits;
use crate::space::{Position, Time, Transform};

/// A keyframe to be stored, or asked about without being stored. Only `stamp` and `pose` are required.
#[body(sent Keyframe)]
#[derive(Default)]
#[schema(as = KeyframeLists)]
pub struct KeyframeBody {
    /// One robot's run: its own frame and its own numbering of map points.
    #[schema(default = "default")]
    #[id]
    pub session: Option<SessionId>,
    /// When it was taken.
    pub stamp: Time,
    /// `map_from_camera` in the session's frame, in metres; the camera looks along z, x is right and y down.
    pub pose: Transform,
    /// The undistorted pinhole camera.
    pub camera: Option<CameraShape>,
    /// The unit vector of gravity in the camera frame, where the client knows it: `[0,1,0]` for a camera held upright.
    #[schema(value_type = Option<[f64; 3]>, min_items = 3, max_items = 3, minimum = -1.001, maximum = 1.001)]
    pub gravity: Option<Gravity>,
    /// The height that a barometer tells, in metres above a level of the session's own: it sees a lift that odometry does not.
    /// Stored and answered; no verdict rests on it yet.
    #[schema(minimum = -1e5, maximum = 1e5)]
    pub height_m: Option<f64>,
    /// The bag of words; left out or empty for a blank wall.
    #[schema(value_type = Option<SentBagOfWords>)]
    pub bow: Option<BowShape>,
    /// The vector of the whole image, by a model that the client ran.
    pub global_descriptor: Option<GlobalDescriptorShape>,
    /// Binary features.
    #[schema(value_type = Option<SentFeatures>)]
    #[read(features)]
    pub features: Option<FeaturesShape>,
    /// Map points new or moved; the order does not matter, and answers list them by number.
    #[schema(value_type = Option<SentMapPoints>)]
    pub map_points: Option<PointsShape>,
    /// Map points observed, besides those of `features.map_points`; the order does not matter.
    #[schema(max_items = 100_000, minimum = 0)]
    #[column(observes_i64, I64)]
    pub observes: Option<Vec<i64>>,
    /// Covisible keyframes known to the client, also across sessions; each must exist. An empty list says that there are none.
    /// Left out, and without map points: the keyframes near along the drive count as covisible (`covisibility_max_way_m`).
    #[schema(max_items = 10000)]
    #[read(covisible)]
    pub covisible: Option<Vec<CovisibleShape>>,
    /// The objects detected in it.
    #[schema(max_items = 500)]
    pub detections: Option<Vec<DetectionShape>>,
}

impl KeyframeBody {
    /// Returns a keyframe of which nothing is known but when and where it was taken.
    pub fn at(stamp: Time, pose: Transform) -> Self {
        Self { stamp, pose, ..Self::default() }
    }
}

/// A pinhole camera; keypoints and boxes are undistorted too.
#[body(same Camera, of = Camera)]
#[derive(Copy)]
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
#[body(sent SentBagOfWords)]
#[schema(as = BagOfWords)]
pub struct BowShape {
    /// The words, none twice.
    #[schema(value_type = Vec<i64>, max_items = 65535, minimum = 0, maximum = 4_294_967_295_i64)]
    #[column(words_u32, U32)]
    #[unique]
    pub words: Vec<u32>,
    /// Their weights, without unit; normalised to sum to one on arrival.
    #[schema(max_items = 65535, minimum = 0, maximum = 1e30)]
    #[column(weights_f64, F64)]
    #[parallel(words)]
    pub weights: Vec<f64>,
    /// Whose words these are, such as a vocabulary's fingerprint. Words of two vocabularies do not go into one map.
    #[schema(max_length = 128)]
    pub vocabulary: Option<String>,
}

/// Binary features: three lists in parallel.
#[body(sent SentFeatures, of = Features)]
#[schema(as = Features)]
pub struct FeaturesShape {
    /// Bytes of one descriptor: 32 for ORB, 64 for BRISK.
    #[schema(minimum = 8, maximum = 512, multiple_of = 8)]
    #[read(descriptor_bytes)]
    #[is(of.descriptor_bytes as u32)]
    pub descriptor_bytes: u32,
    /// The descriptors one after the other, in base64.
    #[schema(value_type = String, max_length = 13_653_336)]
    #[is(Base64(of.descriptors))]
    pub descriptors: Base64,
    /// One for each descriptor: `[u,v]`, `[u,v,octave]` or `[u,v,octave,angle_deg]`, in pixels, pyramid level and degrees. Packed,
    /// an angle that is not a number is none.
    #[schema(max_items = 20000, inline)]
    #[column(keypoints_f32, F32, 4)]
    #[is(of.keypoints.into_iter().map(KeypointShape).collect())]
    pub keypoints: Vec<KeypointShape>,
    /// The map point that each feature observes, -1 for none; left out if none does.
    #[schema(max_items = 20000, minimum = -1)]
    #[column(map_points_i64, I64)]
    #[parallel(keypoints)]
    #[is(Some(of.map_points.iter().map(|point| point.unwrap_or(-1)).collect()))]
    pub map_points: Option<Vec<i64>>,
}

/// Positions of map points: two lists in parallel.
#[body(sent SentMapPoints)]
#[derive(Default)]
#[schema(as = MapPoints)]
pub struct PointsShape {
    /// The points' numbers in their session, none twice.
    #[schema(max_items = 100_000, minimum = 0)]
    #[column(ids_i64, I64)]
    #[unique]
    pub ids: Vec<i64>,
    /// `[x,y,z]` of each in the session's frame, in metres.
    #[schema(max_items = 100_000, inline)]
    #[column(positions_f64, F64, 3)]
    #[parallel(ids)]
    pub positions: Vec<Position>,
}

/// A covisible keyframe as a client declares it.
#[body(of = (KeyframeId, u32))]
#[schema(as = CovisibleKeyframe)]
pub struct CovisibleShape {
    /// The other keyframe; it must exist.
    #[id]
    #[from(of.0)]
    pub keyframe: KeyframeId,
    /// How many map points the two share; it counts whatever it is.
    #[schema(value_type = i64, minimum = 0, maximum = 4_294_967_295_i64)]
    #[from(of.1)]
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
#[body(of = Detection)]
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
    #[schema(min_items = 4, max_items = 4, minimum = -1e6, maximum = 1e6)]
    #[read(box_px)]
    pub box_px: [f64; 4],
    /// The map points that the box covers: the object's place.
    #[schema(max_items = 100_000, minimum = 0)]
    #[from(filled(of.map_points))]
    pub map_points: Option<Vec<i64>>,
    /// Where the object stands in the session's frame, in metres; serves where it has no map points.
    #[schema(min_items = 3, max_items = 3, minimum = -1e9, maximum = 1e9)]
    #[from(of.position_in_session)]
    pub position: Option<[f64; 3]>,
    /// `assumed` if nothing measured the distance of `position`, say where it rests on the height that letters have as a rule:
    /// then only its bearing counts. Left out, it was measured.
    #[schema(inline)]
    #[read(range)]
    #[is(of.range_assumed.then_some(RangeName::Assumed))]
    pub range: Option<RangeName>,
    /// What a reader made of it.
    #[schema(max_length = 4096)]
    pub text: Option<String>,
    /// What a model or a person made of it; wins over `text`.
    #[schema(max_length = 4096)]
    pub description: Option<String>,
    /// The image inside the box, PNG or JPEG of at most 4 MiB, in base64.
    #[schema(value_type = Option<String>, max_length = 5_592_408)]
    #[is(of.crop.map(CropShape))]
    pub crop: Option<CropShape>,
}

/// Returns a list that is left out where nothing is in it.
pub(crate) fn filled<T>(list: Vec<T>) -> Option<Vec<T>> {
    (!list.is_empty()).then_some(list)
}

/// Reads the covisible keyframes, none of them twice.
pub(crate) fn covisible(node: &Node<'_>) -> Option<Vec<CovisibleShape>> {
    let mut names = HashSet::new();
    node.list(limits::COVISIBLE, |entry| named_once(entry, &mut names, CovisibleShape::decode))
}

/// Reads an entry of a list in which no keyframe is named twice, whatever else is wrong with it.
pub(crate) fn named_once<T>(
    entry: &Node<'_>,
    names: &mut HashSet<String>,
    read: impl FnOnce(&Node<'_>) -> Option<T>,
) -> Option<T> {
    let name = entry.value().get("keyframe").and_then(Json::as_str);
    let once = if name.is_some_and(|name| !names.insert(name.to_owned())) {
        entry.refuse_member("keyframe", "the keyframe is listed twice", "each keyframe once")
    } else {
        Some(())
    };
    read(entry).zip(once).map(|(read, ())| read)
}

/// Reads binary features with a descriptor for each keypoint.
pub(crate) fn features(node: &Node<'_>) -> Option<FeaturesShape> {
    let features = FeaturesShape::decode(node)?;
    let (each, keypoints, got) =
        (features.descriptor_bytes as usize, features.keypoints.len(), features.descriptors.0.len());
    if got != each * keypoints {
        let limit = format!("{} bytes: {each} for each of {keypoints} keypoints", each * keypoints);
        let detail = format!("the descriptors are {}", counted(got, "byte"));
        return node.refuse_member("descriptors", detail, limit);
    }
    Some(features)
}

fn descriptor_bytes(node: &Node<'_>) -> Option<u32> {
    let bytes = node.count(limits::DESCRIPTOR_BYTES)?;
    if bytes % 8 != 0 {
        return node.refuse("descriptors are compared 8 bytes at a time", "a multiple of 8");
    }
    Some(bytes)
}

fn box_px(node: &Node<'_>) -> Option<[f64; 4]> {
    let corners @ [x0, y0, x1, y1] = node.numbers(limits::PIXEL)?;
    if x0 > x1 || y0 > y1 {
        let got = format!("the box's corners are swapped: [{x0}, {y0}, {x1}, {y1}]");
        return node.refuse(got, "[x0, y0, x1, y1] with x0 <= x1 and y0 <= y1");
    }
    Some(corners)
}

fn range(node: &Node<'_>) -> Option<RangeName> {
    node.one_of([("measured", RangeName::Measured), ("assumed", RangeName::Assumed)])
}
