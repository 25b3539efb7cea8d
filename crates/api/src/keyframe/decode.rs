//! A keyframe read out of JSON, with every fault in it.

use revisit_core::domain::bow::BowVector;
use revisit_core::domain::global_descriptor::GlobalDescriptor;
use revisit_core::domain::ids::{KeyframeId, PointId};
use revisit_core::domain::invalid::FieldError;
use revisit_core::domain::keyframe::{
    CLIENTS_VOCABULARY, Camera, Detection, Features, Keypoint, NewKeyframe,
};
use revisit_core::domain::request::Digest;
use revisit_core::geometry::Point3;

use super::digest;
use super::shape::{CovisibleShape, DetectionShape, FeaturesShape, KeyframeBody, PointsShape, RangeName};
use crate::decoding::document::{Json, Kind};
use crate::decoding::read::{self, Members as _, Node, Object};
use crate::limits;

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
    read::decode_with(body, |node| keyframe(&node.object(&KeyframeBody::names())?, Some(id.clone())))
}

/// Returns a keyframe of a bulk request: the very body of a PUT, and beside it the name.
pub fn of_line(line: Json<'_>) -> Result<SentKeyframe, Vec<FieldError>> {
    let names: Vec<&str> = [ID].into_iter().chain(KeyframeBody::names()).collect();
    read::decode_with(line, |node| {
        let line = node.object(&names)?;
        keyframe(&line, line.required(ID, read::id))
    })
}

/// Returns a keyframe to be asked about and not stored: a member of a larger body, without a name of its own.
pub fn unnamed(body: KeyframeBody) -> Option<SentKeyframe> {
    body.inline().map(sent)
}

/// Reads the members of a keyframe; its name was read before, or could not be.
fn keyframe(object: &Object<'_>, id: Option<KeyframeId>) -> Option<SentKeyframe> {
    let body = KeyframeBody::read(object);
    let others = object.optional("covisible", |node| others_than(node, id.as_ref()));
    let keyframe = body?.named(id?)?;
    others.map(|_| sent(keyframe))
}

fn sent(keyframe: NewKeyframe) -> SentKeyframe {
    let digest = digest::of(&keyframe);
    SentKeyframe { keyframe, digest }
}

/// Refuses a keyframe in its own list of covisible ones.
pub(crate) fn others_than(node: &Node<'_>, id: Option<&KeyframeId>) -> Option<()> {
    let (Some(id), Kind::List) = (id, node.value().kind()) else { return Some(()) };
    node.each(usize::MAX, |_, entry| {
        if entry.value().get("keyframe").and_then(Json::as_str) == Some(id.as_str()) {
            return entry.refuse_member(
                "keyframe",
                "a keyframe is not covisible with itself",
                "another keyframe",
            );
        }
        Some(())
    })
}

impl KeyframeBody {
    /// Returns the keyframe without a name of its own: it is asked about and not stored.
    pub fn inline(self) -> Option<NewKeyframe> {
        self.named(INLINE.parse().ok()?)
    }

    /// Returns the keyframe of this name; `None` if its pose is none.
    pub fn named(self, id: KeyframeId) -> Option<NewKeyframe> {
        let features = self.features.map(Features::from);
        // Observed is what the client lists, and what its features see; one listed twice is observed once.
        let mut observes = self.observes.unwrap_or_default();
        observes.extend(features.iter().flat_map(|features| features.map_points.iter().flatten()));
        let (bow, vocabulary) = match self.bow {
            Some(bow) => {
                let vocabulary = bow.vocabulary.map_or_else(|| CLIENTS_VOCABULARY.into(), Into::into);
                (
                    BowVector::normalised(bow.words.into_iter().zip(bow.weights).collect()).ok()?,
                    Some(vocabulary),
                )
            }
            None => Default::default(),
        };
        let listed =
            |list: Vec<CovisibleShape>| list.into_iter().map(|of| (of.keyframe, of.shared)).collect();
        Some(NewKeyframe {
            session: self.session.unwrap_or_default(),
            camera: self.camera.map(Camera::from),
            gravity: self.gravity,
            height_m: self.height_m,
            bow,
            vocabulary,
            global_descriptor: self.global_descriptor.map(GlobalDescriptor::from),
            features,
            map_points: self.map_points.map(PointsShape::ascending).unwrap_or_default(),
            observes: ascending(observes),
            covisible: self.covisible.map(listed),
            detections: self.detections.into_iter().flatten().map(Detection::from).collect(),
            ..NewKeyframe::at(id, self.stamp.into(), self.pose.pose()?)
        })
    }
}

impl PointsShape {
    /// Returns the points ascending by number: the order in which a client lists a set says nothing.
    pub fn ascending(self) -> Vec<(PointId, Point3)> {
        let positions = self.positions.into_iter().map(|at| Point3::from(at.0));
        let mut points: Vec<(PointId, Point3)> = self.ids.into_iter().zip(positions).collect();
        points.sort_unstable_by_key(|(id, _)| *id);
        points
    }
}

/// Returns a set of map points in the order in which the model keeps them.
pub(crate) fn ascending(mut points: Vec<PointId>) -> Vec<PointId> {
    points.sort_unstable();
    points.dedup();
    points
}

impl From<FeaturesShape> for Features {
    fn from(shape: FeaturesShape) -> Self {
        let keypoints: Vec<Keypoint> = shape.keypoints.into_iter().map(|of| of.0).collect();
        let observed = |listed: Vec<i64>| listed.into_iter().map(|id| (id >= 0).then_some(id)).collect();
        Self {
            descriptor_bytes: shape.descriptor_bytes as usize,
            descriptors: shape.descriptors.0,
            map_points: shape.map_points.map_or_else(|| vec![None; keypoints.len()], observed),
            keypoints,
        }
    }
}

impl From<DetectionShape> for Detection {
    fn from(shape: DetectionShape) -> Self {
        // A reader that read nothing sends blank text: that is no reading.
        let reading = |text: Option<String>| text.filter(|text| !text.trim().is_empty());
        Self {
            class: shape.class,
            confidence: shape.confidence,
            box_px: shape.box_px,
            map_points: ascending(shape.map_points.unwrap_or_default()),
            position_in_session: shape.position.map(Point3::from),
            range_assumed: shape.range == Some(RangeName::Assumed),
            text: reading(shape.text),
            description: reading(shape.description),
            crop: shape.crop.map(|crop| crop.0),
        }
    }
}
