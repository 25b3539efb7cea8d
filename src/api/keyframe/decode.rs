//! A keyframe read out of JSON, with every fault in it.

use std::collections::HashSet;

use super::detection::decode as decode_detection;
use super::digest;
use super::features::decode as decode_features;
use super::global_descriptor::decode as decode_global_descriptor;
use super::points::{ascending, points, unique};
use crate::api::decoding::column::{Column, Number};
use crate::api::decoding::document::{Json, Kind};
use crate::api::decoding::read::{self, Decode, Node, Object};
use crate::api::limits;
use crate::domain::bow::BowVector;
use crate::domain::global_descriptor::GlobalDescriptor;
use crate::domain::ids::{KeyframeId, PointId, SessionId};
use crate::domain::invalid::FieldError;
use crate::domain::keyframe::{CLIENTS_VOCABULARY, Camera, Detection, Features, NewKeyframe, Stamp};
use crate::domain::location::AskedKeyframe;
use crate::domain::request::Digest;
use crate::geometry::{Gravity, Point3, Pose};

const FIELDS: [&str; 13] = [
    "session",
    "stamp",
    "pose",
    "camera",
    "gravity",
    "bow",
    "global_descriptor",
    "features",
    "map_points",
    OBSERVES.list,
    OBSERVES.packed,
    "covisible",
    "detections",
];

/// The fields of a keyframe whose place nobody knows.
const UNPLACED_FIELDS: [&str; 13] = [
    // Of a robot's own map: accepted, so that the body of a PUT may be asked about, and of no use here.
    "session",
    OBSERVES.list,
    OBSERVES.packed,
    "covisible",
    "stamp",
    "pose",
    "camera",
    "gravity",
    "bow",
    "global_descriptor",
    "features",
    "map_points",
    "detections",
];

pub(in crate::api) const OBSERVES: Column =
    Column { list: "observes", packed: "observes_i64", number: Number::I64, row: None };
const WORDS: Column = Column { list: "words", packed: "words_u32", number: Number::U32, row: None };
const WEIGHTS: Column = Column { list: "weights", packed: "weights_f64", number: Number::F64, row: None };

/// The name of a keyframe that is asked about and not stored.
const INLINE: &str = "inline";
/// The field of a bulk line that names its keyframe.
const ID: &str = "id";

/// A keyframe as sent, with the digest that tells a retry from another keyframe.
#[derive(Clone, Debug, PartialEq)]
pub struct SentKeyframe {
    /// The keyframe, checked.
    pub keyframe: NewKeyframe,
    /// The digest of its facts, whatever the form of its body.
    pub digest: Digest,
}

/// Why a body is no keyframe, as far as that can be told without its map.
#[derive(Clone, Debug, PartialEq)]
pub struct Faulty {
    /// The faults.
    pub faults: Vec<FieldError>,
    /// The keyframes it declares covisible, with their places in the list: only the map can tell whether they exist.
    pub declared: Vec<(usize, KeyframeId)>,
}

impl Faulty {
    /// Joins these faults with what the keyframe's body declares.
    pub fn of(faults: Vec<FieldError>, body: Option<Json<'_>>) -> Self {
        let is_list = |list: &Json<'_>| list.kind() == Kind::List && list.len() <= limits::COVISIBLE;
        let list = body.and_then(|body| body.get("covisible")).filter(is_list);
        let named = |entry: Json<'_>| entry.get("keyframe")?.as_str()?.parse().ok();
        let declared = list.into_iter().flat_map(Json::items).map(named).enumerate();
        Self { faults, declared: declared.filter_map(|(place, id)| Some((place, id?))).collect() }
    }

    /// Returns all faults, with those that the map has found. A place is told off once.
    pub fn with(mut self, found: Vec<FieldError>) -> Vec<FieldError> {
        for fault in found {
            let is_told = self.faults.iter().any(|told| told.pointer == fault.pointer);
            if !is_told && self.faults.len() < limits::LISTED_FAULTS {
                self.faults.push(fault);
            }
        }
        self.faults
    }
}

/// Returns a keyframe whose name stands in the path.
pub fn named(body: Json<'_>, id: &KeyframeId) -> Result<SentKeyframe, Vec<FieldError>> {
    read::decode_with(body, |node| keyframe(node, &FIELDS, Named::Outside(id)))
}

/// Returns a keyframe of a bulk request: the very body of a PUT, and beside it the name.
pub fn of_line(line: Json<'_>) -> Result<SentKeyframe, Vec<FieldError>> {
    let fields: Vec<&str> = [ID].into_iter().chain(FIELDS).collect();
    read::decode_with(line, |node| keyframe(node, &fields, Named::Inside))
}

/// Returns a keyframe to be asked about and not stored: a member of a larger body, without a name of its own.
pub fn unnamed(node: &Node<'_>) -> Option<SentKeyframe> {
    keyframe(node, &FIELDS, Named::Nowhere)
}

/// Returns a keyframe whose place nobody knows: it may be without a stamp and without a pose.
pub fn unplaced(node: &Node<'_>) -> Option<AskedKeyframe> {
    let body = node.object(&UNPLACED_FIELDS)?;
    let stamp = body.optional("stamp", Stamp::decode);
    let pose = body.optional("pose", Pose::decode);
    let seen = seen(&body);
    let (id, stamp, pose) = (INLINE.parse().ok()?, stamp?, pose?);
    let unknown = Stamp { sec: 0, nanosec: 0 };
    let placed = NewKeyframe::at(id, stamp.unwrap_or(unknown), pose.unwrap_or_else(Pose::identity));
    Some(AskedKeyframe { keyframe: seen?.of(placed), has_pose: pose.is_some() })
}

/// The place of a keyframe's name.
enum Named<'i> {
    /// In the path.
    Outside(&'i KeyframeId),
    /// In the body.
    Inside,
    /// It has none: it is asked about and not stored.
    Nowhere,
}

/// Reads a keyframe that has these fields.
fn keyframe(node: &Node<'_>, fields: &[&str], named: Named<'_>) -> Option<SentKeyframe> {
    let body = node.object(fields)?;
    let id = match named {
        Named::Outside(id) => Some(id.clone()),
        Named::Inside => body.required(ID, read::id),
        Named::Nowhere => INLINE.parse().ok(),
    };
    let session = body.optional("session", read::id::<SessionId>);
    let stamp = body.required("stamp", Stamp::decode);
    let pose = body.required("pose", Pose::decode);
    let observes = body
        .optional_column(OBSERVES, |node| node.list(limits::MAP_POINTS, |point| point.whole(limits::POINT)));
    let covisible = body.optional("covisible", |node| covisible(node, id.as_ref()));
    let seen = seen(&body);
    let (session, observes, covisible) = (session?, observes?, covisible?);
    let placed = NewKeyframe {
        session: session.unwrap_or_default(),
        observes: observes.unwrap_or_default(),
        covisible,
        ..NewKeyframe::at(id?, stamp?, pose?)
    };
    let keyframe = seen?.of(placed);
    let digest = digest::of(&keyframe);
    Some(SentKeyframe { keyframe, digest })
}

/// The part of a keyframe that tells what the camera saw, wherever it was.
struct Seen {
    camera: Option<Camera>,
    gravity: Option<Gravity>,
    bow: Option<(BowVector, Box<str>)>,
    global_descriptor: Option<GlobalDescriptor>,
    features: Option<Features>,
    map_points: Vec<(PointId, Point3)>,
    detections: Vec<Detection>,
}

impl Seen {
    /// Returns a keyframe, of which nothing is known but its place, with what its camera saw.
    fn of(self, placed: NewKeyframe) -> NewKeyframe {
        let (bow, vocabulary) = self.bow.map_or_else(Default::default, |(bow, of)| (bow, Some(of)));
        NewKeyframe {
            camera: self.camera,
            gravity: self.gravity,
            bow,
            vocabulary,
            global_descriptor: self.global_descriptor,
            observes: observed(placed.observes, self.features.as_ref()),
            features: self.features,
            map_points: self.map_points,
            detections: self.detections,
            ..placed
        }
    }
}

/// Reads what the camera saw.
fn seen(body: &Object<'_>) -> Option<Seen> {
    let camera = body.optional("camera", camera);
    let gravity = body.optional("gravity", Gravity::decode);
    let bow = body.optional("bow", bow);
    let global_descriptor = body.optional("global_descriptor", decode_global_descriptor);
    let features = body.optional("features", decode_features);
    let map_points = body.optional("map_points", points);
    let detections = body.optional("detections", |node| node.list(limits::DETECTIONS, decode_detection));
    Some(Seen {
        camera: camera?,
        gravity: gravity?,
        bow: bow?,
        global_descriptor: global_descriptor?,
        features: features?,
        map_points: map_points?.unwrap_or_default(),
        detections: detections?.unwrap_or_default(),
    })
}

/// Observed is what the client lists, and what its features see; one listed twice is observed once.
fn observed(mut listed: Vec<PointId>, features: Option<&Features>) -> Vec<PointId> {
    listed.extend(features.into_iter().flat_map(|features| features.map_points.iter().flatten()));
    ascending(listed)
}

fn camera(node: &Node<'_>) -> Option<Camera> {
    let body = node.object(&["fx", "fy", "cx", "cy", "width", "height"])?;
    let [fx, fy] = ["fx", "fy"].map(|name| body.required(name, |node| node.number(limits::FOCAL_LENGTH_PX)));
    let [cx, cy] = ["cx", "cy"].map(|name| body.required(name, |node| node.number(limits::PIXEL)));
    let [width, height] =
        ["width", "height"].map(|name| body.required(name, |node| node.count(limits::IMAGE_SIDE_PX)));
    Some(Camera { fx: fx?, fy: fy?, cx: cx?, cy: cy?, width: width?, height: height? })
}

/// Returns the bag of words, and whose words they are.
fn bow(node: &Node<'_>) -> Option<(BowVector, Box<str>)> {
    let body = node.object(&[WORDS.list, WORDS.packed, WEIGHTS.list, WEIGHTS.packed, "vocabulary"])?;
    let vocabulary = body.optional("vocabulary", |node| node.text(limits::VOCABULARY_CHARS));
    let words =
        body.required_column(WORDS, |node| unique(node, limits::WORDS, |word| word.count(limits::WORD)));
    let weights = body
        .required_column(WEIGHTS, |node| node.list(limits::WORDS, |weight| weight.number(limits::WEIGHT)));
    body.parallel_columns(WORDS, WEIGHTS)?;
    match BowVector::normalised(words?.into_iter().zip(weights?).collect()) {
        Ok(bow) => Some((bow, vocabulary?.map_or_else(|| CLIENTS_VOCABULARY.into(), Into::into))),
        Err(error) => node.refuse(error.to_string(), "a bag of words"),
    }
}

/// Reads a list of covisible keyframes, none twice, without the keyframe itself.
pub(in crate::api) fn covisible(
    node: &Node<'_>,
    this: Option<&KeyframeId>,
) -> Option<Vec<(KeyframeId, u32)>> {
    let mut seen = HashSet::new();
    node.list(limits::COVISIBLE, |entry| {
        let body = entry.object(&["keyframe", "shared"])?;
        let keyframe = body.required("keyframe", |node| {
            let keyframe: KeyframeId = read::id(node)?;
            if Some(&keyframe) == this {
                return node.refuse("a keyframe is not covisible with itself", "another keyframe");
            }
            if !seen.insert(keyframe.clone()) {
                return node.refuse("the keyframe is listed twice", "each keyframe once");
            }
            Some(keyframe)
        });
        let shared = body.required("shared", |node| node.count(limits::SHARED));
        Some((keyframe?, shared?))
    })
}
