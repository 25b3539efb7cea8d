//! What a client sends: a keyframe with its bag of words, its map points and its detections.

use serde::{Deserialize, Serialize};

use super::bow::BowVector;
use super::global_descriptor::GlobalDescriptor;
use super::ids::{KeyframeId, PointId, SessionId};
use crate::geometry::{Gravity, Point3, Pose};

/// A moment on the robot's clock.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Stamp {
    /// Whole seconds.
    pub sec: i64,
    /// Nanoseconds within the second, below 10^9.
    pub nanosec: u32,
}

impl Stamp {
    /// Returns the time between two moments, in seconds.
    pub fn gap_s(self, other: Self) -> f64 {
        // Seconds of two epochs may be far apart; as floats they cannot overflow.
        let whole_s = self.sec as f64 - other.sec as f64;
        (whole_s + (f64::from(self.nanosec) - f64::from(other.nanosec)) * 1e-9).abs()
    }
}

/// The name of whatever vocabulary a client uses, if it does not say.
pub const CLIENTS_VOCABULARY: &str = "client";

/// An undistorted pinhole camera, in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Camera {
    /// Focal length along x, in pixels.
    pub fx: f64,
    /// Focal length along y, in pixels.
    pub fy: f64,
    /// Principal point, x.
    pub cx: f64,
    /// Principal point, y.
    pub cy: f64,
    /// Image width, in pixels.
    pub width: u32,
    /// Image height, in pixels.
    pub height: u32,
}

/// A keypoint of an undistorted image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Keypoint {
    /// Column, in pixels.
    pub u: f64,
    /// Row, in pixels.
    pub v: f64,
    /// Level of the image pyramid; 0 is the full image.
    pub octave: u8,
    /// Orientation in degrees, if the detector measures one.
    pub angle_deg: Option<f64>,
}

/// Binary features of a keyframe; the three lists run in parallel.
#[derive(Clone, Debug, PartialEq)]
pub struct Features {
    /// Bytes of one descriptor, a multiple of 8.
    pub descriptor_bytes: usize,
    /// The descriptors, one after the other.
    pub descriptors: Vec<u8>,
    /// The place of each descriptor.
    pub keypoints: Vec<Keypoint>,
    /// The map point each feature observes, if any.
    pub map_points: Vec<Option<PointId>>,
}

/// The image of a detection's box, as the client encoded it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Crop {
    /// `image/png` or `image/jpeg`, told by the first bytes.
    pub media_type: &'static str,
    /// The file.
    pub bytes: Vec<u8>,
}

impl Crop {
    /// Returns the type of an image that begins so, if it is one of the two.
    pub fn media_type_of(head: &[u8]) -> Option<&'static str> {
        const SIGNATURES: [(&[u8], &str); 2] =
            [(b"\x89PNG\r\n\x1a\n", "image/png"), (b"\xff\xd8\xff", "image/jpeg")];
        SIGNATURES
            .iter()
            .find(|(signature, _)| head.starts_with(signature))
            .map(|(_, media_type)| *media_type)
    }
}

/// An object detected in a keyframe (§III: box, class, confidence and the map points it covers).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Detection {
    /// The object's class, such as `door_number`.
    pub class: String,
    /// The detector's confidence, in `[0, 1]`.
    pub confidence: f64,
    /// The box `[x0, y0, x1, y1]` in pixels; it may reach out of the image.
    pub box_px: [f64; 4],
    /// The map points the box covers, ascending (P_i of §IV-C.1).
    pub map_points: Vec<PointId>,
    /// The object's position in the session's frame, in metres: serves where it has no map points.
    pub position_in_session: Option<Point3>,
    /// Whether nothing measured the distance of that position: only its bearing holds then.
    pub range_assumed: bool,
    /// The text that a reader found.
    pub text: Option<String>,
    /// The description by a model or a person; wins over `text`.
    pub description: Option<String>,
    /// The image inside the box.
    pub crop: Option<Crop>,
}

impl Detection {
    /// Returns a detection of which nothing is known but its class, its confidence and its box `[x0, y0, x1, y1]` in
    /// pixels.
    pub fn of(class: &str, confidence: f64, box_px: [f64; 4]) -> Self {
        Self { class: class.to_owned(), confidence, box_px, ..Self::default() }
    }

    /// Returns what this detection says of the object, if it says anything.
    pub fn reading(&self) -> Option<&str> {
        self.description.as_deref().or(self.text.as_deref())
    }
}

/// A keyframe as its client sent it, checked.
#[derive(Clone, Debug, PartialEq)]
pub struct NewKeyframe {
    /// The keyframe's name.
    pub id: KeyframeId,
    /// The run it belongs to.
    pub session: SessionId,
    /// The time when it was taken.
    pub stamp: Stamp,
    /// `map_from_camera`, in the session's frame, in metres.
    pub map_from_camera: Pose,
    /// The camera, if the client told.
    pub camera: Option<Camera>,
    /// Gravity in the camera frame, if the client knows it.
    pub gravity: Option<Gravity>,
    /// The height that a barometer tells, in metres above a level of the session's own.
    pub height_m: Option<f64>,
    /// Its bag of words; empty for a blank wall.
    pub bow: BowVector,
    /// Whose words these are: a vocabulary's fingerprint, or [`CLIENTS_VOCABULARY`]. `None` if the client sent no bag of words.
    pub vocabulary: Option<Box<str>>,
    /// The vector of its whole image, if the client computed one.
    pub global_descriptor: Option<GlobalDescriptor>,
    /// Its features, if the client sent them.
    pub features: Option<Features>,
    /// Map points new or moved, in the session's frame, in metres: ascending, each once.
    pub map_points: Vec<(PointId, Point3)>,
    /// Every map point it observes, ascending: `observes` and `features.map_points` together.
    pub observes: Vec<PointId>,
    /// Covisible keyframes that the client declares, each with its number of shared points. An empty list says that there are
    /// none, `None` that the client does not know.
    pub covisible: Option<Vec<(KeyframeId, u32)>>,
    /// The objects detected in it.
    pub detections: Vec<Detection>,
}

/// A number, or a float: what it takes on disk, in bytes.
const NUMBER: usize = size_of::<i64>();

impl NewKeyframe {
    /// Returns a keyframe of the session `default` of which nothing is known but when and where it was taken; the pose
    /// is `map_from_camera`, in metres.
    pub fn at(id: KeyframeId, stamp: Stamp, map_from_camera: Pose) -> Self {
        Self {
            id,
            session: SessionId::default(),
            stamp,
            map_from_camera,
            camera: None,
            gravity: None,
            height_m: None,
            bow: BowVector::default(),
            vocabulary: None,
            global_descriptor: None,
            features: None,
            map_points: Vec::new(),
            observes: Vec::new(),
            covisible: None,
            detections: Vec::new(),
        }
    }

    /// Returns the covisible keyframes that the client declares.
    pub fn declared(&self) -> &[(KeyframeId, u32)] {
        self.covisible.as_deref().unwrap_or_default()
    }

    /// Returns what it takes on disk, in bytes: its lists, features, crops, names and texts. A map's quota counts
    /// these; its map points' positions count with the map's points, once each.
    pub fn bytes(&self) -> u64 {
        const STAMP: usize = size_of::<i64>() + size_of::<u32>();
        const POSE: usize = 7 * NUMBER;
        const CAMERA: usize = 4 * NUMBER + 2 * size_of::<u32>();
        const GRAVITY: usize = 3 * NUMBER;
        let head = self.id.as_str().len()
            + STAMP
            + POSE
            + self.camera.map_or(0, |_| CAMERA)
            + self.gravity.map_or(0, |_| GRAVITY)
            + self.height_m.map_or(0, |_| NUMBER)
            + self.global_descriptor.as_ref().map_or(0, GlobalDescriptor::bytes);
        let numbers =
            self.observes.len() + self.map_points.len() + self.declared().len() + self.bow.words().len();
        let features = self.features.as_ref().map_or(0, Features::bytes);
        let detections: usize = self.detections.iter().map(Detection::bytes).sum();
        (head + numbers * NUMBER + features + detections) as u64
    }
}

impl Features {
    fn bytes(&self) -> usize {
        /// u, v and angle, and the octave.
        const KEYPOINT: usize = 3 * NUMBER + 1;
        self.descriptors.len() + self.keypoints.len() * (KEYPOINT + NUMBER)
    }
}

impl Detection {
    fn bytes(&self) -> usize {
        /// Its confidence, and the four sides of its box.
        const HEAD: usize = 5 * NUMBER;
        let texts = [Some(&self.class), self.text.as_ref(), self.description.as_ref()];
        let texts: usize = texts.into_iter().flatten().map(String::len).sum();
        let position = self.position_in_session.map_or(0, |_| 3 * NUMBER);
        let crop = self.crop.as_ref().map_or(0, |crop| crop.bytes.len());
        HEAD + texts + position + self.map_points.len() * NUMBER + crop
    }
}
