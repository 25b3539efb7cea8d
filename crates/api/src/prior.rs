//! Prior anchor: a sign that a plan shows, known before any robot saw it (`openapi/openapi.yaml`).

use revisit_core::domain::ids::{PriorId, SessionId};
use revisit_core::domain::prior::{NewPrior, Prior, is_unit};
use revisit_core::domain::report::PlanPlace;
use revisit_core::geometry::Point3;
use revisit_shapes::{answer, body};

use super::decoding::read::Node;
use super::limits;

/// A sign that a plan shows.
#[body(of = NewPrior)]
pub struct PriorBody {
    /// The class of the sign, as robots' detections name it: anchors of one class match.
    #[schema(min_length = 1, max_length = 64)]
    pub class: String,
    /// The text on the sign, or its description.
    #[schema(min_length = 1, max_length = 4096)]
    pub description: String,
    /// Its position `[x,y,z]` in the plan's frame, in metres; z points up.
    #[schema(inline, minimum = -1e9, maximum = 1e9)]
    #[from(of.position_in_frame)]
    pub position: [f64; 3],
    /// The plan's frame: the id of a session that no robot drives. Each floor has one, or one frame has heights.
    #[id]
    pub frame: SessionId,
    /// The unit vector `[x,y,z]` out of the wall, towards those who read the sign, in the plan's frame; a norm more than 1 % off
    /// one is rejected.
    #[schema(minimum = -1.01, maximum = 1.01)]
    #[read(unit)]
    #[from(of.normal_in_frame)]
    pub normal: Option<[f64; 3]>,
    /// Where it is known from, for people: the file of the plan.
    #[schema(min_length = 1, max_length = 256)]
    pub source: Option<String>,
}

impl PriorBody {
    /// Returns the prior anchor of this name.
    pub fn named(self, id: PriorId) -> NewPrior {
        let Self { class, description, position, frame, normal, source } = self;
        let position_in_frame = Point3::from(position);
        NewPrior { id, class, description, position_in_frame, frame, normal_in_frame: normal, source }
    }
}

fn unit(node: &Node<'_>) -> Option<[f64; 3]> {
    let normal = node.numbers::<3>(limits::QUATERNION)?;
    if is_unit(&normal) { Some(normal) } else { node.refuse("not a unit vector", "a norm of 1, within 1 %") }
}

/// What a plan says of an anchor.
#[answer(of = (SessionId, Prior))]
#[schema(as = Prior)]
pub struct PriorView {
    /// The plan's frame.
    #[from(of.0)]
    pub frame: String,
    /// Its position `[x,y,z]` in that frame, in metres.
    #[from(of.1.position_in_frame)]
    pub position: [f64; 3],
    /// The unit vector `[x,y,z]` out of the wall, if the plan says so.
    #[from(of.1.normal_in_frame)]
    pub normal: Option<[f64; 3]>,
    /// Where it is known from.
    #[from(of.1.source)]
    pub source: Option<String>,
}

/// The place of an anchor in a plan's frame.
#[answer(of = PlanPlace)]
#[schema(as = PlanPosition)]
pub struct PlanPositionView {
    /// The plan's frame.
    pub frame: String,
    /// Its position `[x,y,z]` in that frame, in metres.
    #[from(<[f64; 3]>::from(of.position_in_frame.coords))]
    #[rounded]
    pub position: [f64; 3],
    /// The aligned session that it is known by; left out for what the plan itself shows.
    #[from(of.by)]
    pub session: Option<String>,
}
