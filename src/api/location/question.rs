//! The question: keyframes of an unknown place, and the maps they are held against.

use revisit_shapes::{answer, body};

use crate::api::decoding::read::{self, Decode, Node};
use crate::api::keyframe::{
    BowShape, CameraShape, CovisibleShape, DetectionShape, FeaturesShape, GlobalDescriptorShape, PointsShape,
    unplaced,
};
use crate::api::limits;
use crate::api::space::{Time, Transform};
use crate::domain::ids::{KeyframeId, MapId, SessionId};
use crate::domain::key::MapPattern;
use crate::domain::location::{ASKED_KEYFRAMES_MAX, LocateRequest, LocationHint};
use crate::geometry::Point3;

/// "Where am I?" Exactly one of `keyframe` and `keyframes`.
#[answer]
#[derive(Default)]
#[serde(deny_unknown_fields)]
pub struct LocateBody {
    /// What the camera sees.
    pub keyframe: Option<UnplacedKeyframeBody>,
    /// What the camera sees in one moment or on one short drive. With a `pose` each, all in one frame, their signs are
    /// compared together. The answer's poses are those of the first one.
    #[schema(min_items = 1, max_items = 16)]
    pub keyframes: Option<Vec<UnplacedKeyframeBody>>,
    /// The maps to ask, as ids in which `*` stands for any characters; at most 64 maps. Left out: every map that the key may
    /// query.
    #[schema(max_items = 100)]
    pub maps: Option<Vec<String>>,
    /// The release of each map that is asked; maps without a release of this name are left out, and one that `maps` names must have
    /// it. Left out: the maps as they stand.
    #[schema(min_length = 1, max_length = 128, pattern = r"^(\.{0,2}[A-Za-z0-9_:-]|\.{3})[A-Za-z0-9._:-]*$")]
    pub release: Option<String>,
    /// A guess. It decides what is looked at first, and never what the answer is.
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
#[answer]
#[derive(Default)]
#[serde(deny_unknown_fields)]
#[schema(as = UnplacedKeyframe)]
pub struct UnplacedKeyframeBody {
    /// Of the robot's own map, as are `observes` and `covisible`: accepted, so that the body of a PUT may be asked about as it
    /// is, and not listened to.
    #[schema(max_length = 128)]
    pub session: Option<String>,
    /// Not listened to.
    #[schema(max_items = 100_000, value_type = Option<Vec<crate::api::keyframe::PointNumber>>, inline)]
    pub observes: Option<Vec<i64>>,
    /// Not listened to.
    #[schema(max_length = 1_066_668)]
    pub observes_i64: Option<String>,
    /// Not listened to.
    #[schema(max_items = 10000)]
    pub covisible: Option<Vec<CovisibleShape>>,
    /// When it was taken.
    pub stamp: Option<Time>,
    /// `map_from_camera` in a frame of the robot's own, in metres. Left out: positions are in the camera's frame, x right,
    /// y down, z forward.
    pub pose: Option<Transform>,
    /// The undistorted pinhole camera.
    pub camera: Option<CameraShape>,
    /// The unit vector of gravity in the camera's frame.
    #[schema(value_type = Option<crate::api::keyframe::Direction>, inline)]
    pub gravity: Option<[f64; 3]>,
    /// The bag of words.
    #[schema(value_type = Option<crate::api::keyframe::SentBow>)]
    pub bow: Option<BowShape>,
    /// A global descriptor of the image.
    pub global_descriptor: Option<GlobalDescriptorShape>,
    /// Binary features.
    #[schema(value_type = Option<crate::api::keyframe::SentFeatures>)]
    pub features: Option<FeaturesShape>,
    /// Map points of the robot's own, in its own frame.
    #[schema(value_type = Option<crate::api::keyframe::SentPoints>)]
    pub map_points: Option<PointsShape>,
    /// The objects detected in it.
    #[schema(max_items = 500)]
    pub detections: Option<Vec<DetectionShape>>,
}

/// A guess where the camera is.
#[body(checked LocationHint)]
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
const PLACES: i64 = 5;

impl Decode for LocateRequest {
    fn decode(node: &Node<'_>) -> Option<Self> {
        let body =
            node.object(&["keyframe", "keyframes", "maps", "release", "hint", "exclude", "max", "seed"])?;
        let one = body.optional("keyframe", unplaced);
        let several = body.optional("keyframes", |node| {
            let keyframes = node.list(ASKED_KEYFRAMES_MAX, unplaced)?;
            if keyframes.is_empty() {
                return node.refuse("the list is empty", "1 to 16 keyframes");
            }
            Some(keyframes)
        });
        let maps = body.optional("maps", |node| node.list(limits::KEY_PATTERNS, MapPattern::decode));
        let release = body.optional("release", read::id);
        let hint = body.optional("hint", LocationHint::decode);
        let exclude = body.optional("exclude", LocateExcludeBody::decode);
        let max = body.optional("max", |node| node.whole(limits::LOCATE_PLACES));
        let seed = body.optional("seed", |node| node.whole(limits::SEED));
        if body.has("keyframe") == body.has("keyframes") {
            return node.refuse("ask about one keyframe or several", "either \"keyframe\" or \"keyframes\"");
        }
        let keyframes = match (one?, several?) {
            (Some(keyframe), _) => vec![keyframe],
            (None, several) => several?,
        };
        let exclude = exclude?.unwrap_or_default();
        Some(Self {
            keyframes,
            maps: maps?.unwrap_or_default(),
            release: release?,
            hint: hint?.unwrap_or_default(),
            without_keyframes: exclude.keyframes.into_iter().flatten().collect(),
            without_sessions: exclude.sessions.into_iter().flatten().collect(),
            max: max?.unwrap_or(PLACES).unsigned_abs() as usize,
            seed: seed?.unwrap_or(0).unsigned_abs(),
        })
    }
}

impl LocateHintBody {
    fn checked(self, node: &Node<'_>) -> Option<LocationHint> {
        if self.radius_m.is_some() && self.position.is_none() {
            return node.refuse("a radius needs a position", "both \"position\" and \"radius_m\"");
        }
        Some(LocationHint {
            map: self.map,
            position: self.position.map(Point3::from),
            radius_m: self.radius_m.unwrap_or(HINT_RADIUS_M),
        })
    }
}
