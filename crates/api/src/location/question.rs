//! The question: keyframes of an unknown place, and the maps they are held against.

use revisit_core::domain::ids::{KeyframeId, MapId, ReleaseName, SessionId};
use revisit_core::domain::key::MapPattern;
use revisit_core::domain::location::{AskedKeyframe, LocateRequest, LocationHint};
use revisit_core::geometry::{Gravity, Point3, Pose};
use revisit_shapes::body;

use crate::decoding::read::{Decode as _, Node};
use crate::keyframe::{
    BowShape, CameraShape, CovisibleShape, DetectionShape, FeaturesShape, GlobalDescriptorShape,
    KeyframeBody, PointsShape, SentBagOfWords, SentFeatures, SentMapPoints, features,
};
use crate::space::{Time, Transform};

/// "Where am I?" Exactly one of `keyframe` and `keyframes`.
#[body(checked LocateRequest)]
#[derive(Default)]
pub struct LocateBody {
    /// What the camera sees.
    #[schema(value_type = Option<UnplacedKeyframe>)]
    pub keyframe: Option<UnplacedKeyframeBody>,
    /// What the camera sees in one moment or on one short drive. With a `pose` each, all in one frame, their signs are
    /// compared together. The answer's poses are those of the first one.
    #[schema(value_type = Option<Vec<UnplacedKeyframe>>, min_items = 1, max_items = 16)]
    pub keyframes: Option<Vec<UnplacedKeyframeBody>>,
    /// The maps to ask, as ids in which `*` stands for any characters; at most 64 maps. Left out: every map that the key may
    /// query.
    #[schema(max_items = 100, value_type = Option<Vec<String>>)]
    pub maps: Option<Vec<MapPattern>>,
    /// The release of each map that is asked; maps without a release of this name are left out, and one that `maps` names must have
    /// it. Left out: the maps as they stand.
    #[id]
    pub release: Option<ReleaseName>,
    /// A guess. It decides what is looked at first, and never what the answer is.
    #[read(LocateHintBody::consistent)]
    pub hint: Option<LocateHintBody>,
    /// Keyframes that are no candidates, say those of the robot's own drive.
    pub exclude: Option<LocateExcludeBody>,
    /// Maximum number of places in the answer.
    #[schema(default = 5, minimum = 1, maximum = 20)]
    pub max: Option<u32>,
    /// The seed of what is drawn at random.
    #[schema(default = 0, minimum = 0)]
    pub seed: Option<i64>,
}

/// A keyframe of an unknown place. Nothing is required; what can be compared is compared.
#[body(sent UnplacedKeyframe)]
#[derive(Default)]
#[schema(as = UnplacedKeyframeLists)]
pub struct UnplacedKeyframeBody {
    /// Of the robot's own map, as are `observes` and `covisible`: accepted, so that the body of a PUT may be asked about as it
    /// is, and not listened to.
    #[schema(max_length = 128)]
    #[unread]
    pub session: Option<String>,
    /// Not listened to.
    #[schema(max_items = 100_000, minimum = 0)]
    #[column(observes_i64, I64)]
    #[unread]
    pub observes: Option<Vec<i64>>,
    /// Not listened to.
    #[schema(max_items = 10000)]
    #[unread]
    pub covisible: Option<Vec<CovisibleShape>>,
    /// When it was taken.
    pub stamp: Option<Time>,
    /// `map_from_camera` in a frame of the robot's own, in metres. Left out: positions are in the camera's frame, x right,
    /// y down, z forward.
    pub pose: Option<Transform>,
    /// The undistorted pinhole camera.
    pub camera: Option<CameraShape>,
    /// The unit vector of gravity in the camera's frame.
    #[schema(value_type = Option<[f64; 3]>, min_items = 3, max_items = 3, minimum = -1.001, maximum = 1.001)]
    pub gravity: Option<Gravity>,
    /// The height that a barometer tells, in metres. Not listened to.
    #[schema(minimum = -1e5, maximum = 1e5)]
    pub height_m: Option<f64>,
    /// The bag of words.
    #[schema(value_type = Option<SentBagOfWords>)]
    pub bow: Option<BowShape>,
    /// A global descriptor of the image.
    pub global_descriptor: Option<GlobalDescriptorShape>,
    /// Binary features.
    #[schema(value_type = Option<SentFeatures>)]
    #[read(features)]
    pub features: Option<FeaturesShape>,
    /// Map points of the robot's own, in its own frame.
    #[schema(value_type = Option<SentMapPoints>)]
    pub map_points: Option<PointsShape>,
    /// The objects detected in it.
    #[schema(max_items = 500)]
    pub detections: Option<Vec<DetectionShape>>,
}

/// A guess where the camera is.
#[body]
#[derive(Default)]
#[schema(as = LocateHint)]
pub struct LocateHintBody {
    /// The map, say that of the floor at which the lift stopped.
    #[id]
    pub map: Option<MapId>,
    /// `[x,y,z]` in the frame of any of its sessions, in metres.
    #[schema(min_items = 3, max_items = 3, minimum = -1e9, maximum = 1e9)]
    pub position: Option<[f64; 3]>,
    /// How far from that position the camera may be, in metres.
    #[schema(default = 10.0, minimum = 0.0, maximum = 1e9)]
    pub radius_m: Option<f64>,
}

/// Keyframes that are no candidates, in any map.
#[body]
#[derive(Default)]
#[schema(as = LocateExclude)]
pub struct LocateExcludeBody {
    /// Keyframes, by id; those that a map does not have are ignored.
    #[schema(max_items = 10000)]
    #[id]
    pub keyframes: Option<Vec<KeyframeId>>,
    /// Whole sessions, by name.
    #[schema(max_items = 10000)]
    #[id]
    pub sessions: Option<Vec<SessionId>>,
}

/// Radius of a hint that tells none, in metres.
const HINT_RADIUS_M: f64 = 10.0;
/// Places of an answer whose question tells no number.
const PLACES: u32 = 5;

impl LocateBody {
    fn checked(self, node: &Node<'_>) -> Option<LocateRequest> {
        let keyframes = match (self.keyframe, self.keyframes) {
            (Some(one), None) => vec![one],
            (None, Some(several)) => several,
            _ => {
                return node
                    .refuse("ask about one keyframe or several", "either \"keyframe\" or \"keyframes\"");
            }
        };
        let exclude = self.exclude.unwrap_or_default();
        Some(LocateRequest {
            keyframes: keyframes.into_iter().map(UnplacedKeyframeBody::asked).collect::<Option<_>>()?,
            maps: self.maps.unwrap_or_default(),
            release: self.release,
            hint: self.hint.map(LocationHint::from).unwrap_or_default(),
            without_keyframes: exclude.keyframes.into_iter().flatten().collect(),
            without_sessions: exclude.sessions.into_iter().flatten().collect(),
            max: self.max.unwrap_or(PLACES) as usize,
            seed: self.seed.unwrap_or(0).unsigned_abs(),
        })
    }
}

impl UnplacedKeyframeBody {
    /// Returns the keyframe that is asked about; it may be without a stamp and without a pose.
    fn asked(self) -> Option<AskedKeyframe> {
        let has_pose = self.pose.is_some();
        let stamp = self.stamp.unwrap_or(Time { sec: 0, nanosec: 0 });
        let pose = self.pose.unwrap_or_else(|| Pose::identity().into());
        let keyframe = KeyframeBody {
            camera: self.camera,
            gravity: self.gravity,
            height_m: self.height_m,
            bow: self.bow,
            global_descriptor: self.global_descriptor,
            features: self.features,
            map_points: self.map_points,
            detections: self.detections,
            ..KeyframeBody::at(stamp, pose)
        };
        Some(AskedKeyframe { keyframe: keyframe.inline()?, has_pose })
    }
}

impl LocateHintBody {
    fn consistent(node: &Node<'_>) -> Option<Self> {
        let hint = Self::decode(node)?;
        if hint.radius_m.is_some() && hint.position.is_none() {
            return node.refuse("a radius needs a position", "both \"position\" and \"radius_m\"");
        }
        Some(hint)
    }
}

impl From<LocateHintBody> for LocationHint {
    fn from(hint: LocateHintBody) -> Self {
        Self {
            map: hint.map,
            position: hint.position.map(Point3::from),
            radius_m: hint.radius_m.unwrap_or(HINT_RADIUS_M),
        }
    }
}
