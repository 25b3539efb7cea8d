//! Prior anchor: a sign that a plan shows, known before any robot saw it (`openapi/openapi.yaml`).

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::decoding::read::{self, Decode, Node};
use super::limits;
use super::space::rounded;
use crate::domain::ids::{PriorId, SessionId};
use crate::domain::prior::{NewPrior, Prior, is_unit};
use crate::domain::report::PlanPlace;
use crate::geometry::Point3;

/// A sign that a plan shows.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct PriorBody {
    /// The class of the sign, as robots' detections name it: anchors of one class match.
    #[schema(min_length = 1, max_length = 64)]
    pub class: String,
    /// The text on the sign, or its description.
    #[schema(min_length = 1, max_length = 4096)]
    pub description: String,
    /// Its position `[x,y,z]` in the plan's frame, in metres; z points up.
    #[schema(inline, minimum = -1e9, maximum = 1e9)]
    pub position: [f64; 3],
    /// The plan's frame: the id of a session that no robot drives. Each floor has one, or one frame has heights.
    #[schema(min_length = 1, max_length = 128, pattern = r"^(\.{0,2}[A-Za-z0-9_:-]|\.{3})[A-Za-z0-9._:-]*$")]
    pub frame: String,
    /// The unit vector `[x,y,z]` out of the wall, towards those who read the sign, in the plan's frame; a norm more than 1 % off
    /// one is rejected.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(minimum = -1.01, maximum = 1.01)]
    pub normal: Option<[f64; 3]>,
    /// Where it is known from, for people: the file of the plan.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(min_length = 1, max_length = 256)]
    pub source: Option<String>,
}

/// A prior anchor without its id, which is in the path.
#[derive(Clone, Debug, PartialEq)]
pub struct PriorFields {
    class: String,
    description: String,
    position_in_frame: Point3,
    frame: SessionId,
    normal_in_frame: Option<[f64; 3]>,
    source: Option<String>,
}

impl PriorFields {
    /// Returns the prior anchor of this name.
    pub fn named(self, id: PriorId) -> NewPrior {
        let Self { class, description, position_in_frame, frame, normal_in_frame, source } = self;
        NewPrior { id, class, description, position_in_frame, frame, normal_in_frame, source }
    }
}

impl Decode for PriorFields {
    fn decode(node: &Node<'_>) -> Option<Self> {
        let body = node.object(&["class", "description", "position", "frame", "normal", "source"])?;
        let class = body.required("class", |node| node.name(limits::CLASS_CHARS));
        let description = body.required("description", |node| node.name(limits::TEXT_CHARS));
        let position = body.required("position", Point3::decode);
        let frame = body.required("frame", read::id::<SessionId>);
        let normal = body.optional("normal", |node| {
            let normal = node.numbers::<3>(limits::QUATERNION)?;
            if is_unit(&normal) {
                Some(normal)
            } else {
                node.refuse("not a unit vector", "a norm of 1, within 1 %")
            }
        });
        let source = body.optional("source", |node| node.name(limits::PRIOR_SOURCE_CHARS));
        Some(Self {
            class: class?,
            description: description?,
            position_in_frame: position?,
            frame: frame?,
            normal_in_frame: normal?,
            source: source?,
        })
    }
}

impl From<NewPrior> for PriorBody {
    fn from(prior: NewPrior) -> Self {
        let at = prior.position_in_frame;
        Self {
            class: prior.class,
            description: prior.description,
            position: [at.x, at.y, at.z],
            frame: prior.frame.to_string(),
            normal: prior.normal_in_frame,
            source: prior.source,
        }
    }
}

/// What a plan says of an anchor.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = Prior)]
pub struct PriorView {
    /// The plan's frame.
    pub frame: String,
    /// Its position `[x,y,z]` in that frame, in metres.
    pub position: [f64; 3],
    /// The unit vector `[x,y,z]` out of the wall, if the plan says so.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub normal: Option<[f64; 3]>,
    /// Where it is known from.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub source: Option<String>,
}

impl From<(SessionId, Prior)> for PriorView {
    fn from((frame, prior): (SessionId, Prior)) -> Self {
        let at = prior.position_in_frame;
        Self {
            frame: frame.to_string(),
            position: [at.x, at.y, at.z],
            normal: prior.normal_in_frame,
            source: prior.source.map(Into::into),
        }
    }
}

/// The place of an anchor in a plan's frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = PlanPosition)]
pub struct PlanPositionView {
    /// The plan's frame.
    pub frame: String,
    /// Its position `[x,y,z]` in that frame, in metres.
    pub position: [f64; 3],
    /// The aligned session that it is known by; left out for what the plan itself shows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub session: Option<String>,
}

impl From<PlanPlace> for PlanPositionView {
    fn from(place: PlanPlace) -> Self {
        let at = place.position_in_frame;
        Self {
            frame: place.frame.to_string(),
            position: [at.x, at.y, at.z].map(rounded),
            session: place.by.map(|session| session.to_string()),
        }
    }
}
