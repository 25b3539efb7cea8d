//! Anchor: what a reader is shown of a semantic anchor, and what an operator may change (`openapi/openapi.yaml`).

use revisit_core::domain::ids::SessionId;
use revisit_core::domain::report::{AnchorMatchReport, AnchorReport, ReadingReport};
use revisit_core::domain::verdict::LocalAnchorReport;
use revisit_core::geometry::{Aabb, Point3};
use revisit_shapes::answer;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::decoding::document::Kind;
use super::decoding::read::{Decode, Node};
use super::keyframe::RangeName;
use super::limits;
use super::names::{AnchorStateName, TextKindName};
use super::prior::{PlanPositionView, PriorView};
use super::space::rounded;

/// A semantic anchor with all that was derived about it.
#[answer(of = AnchorReport)]
#[schema(as = Anchor)]
pub struct AnchorView {
    /// Its id: given by the service, or by the client that put a prior anchor.
    #[from(of.name)]
    pub id: String,
    /// The map's version; left out inside a list, which says it once.
    #[is(None)]
    pub map_version: Option<u64>,
    /// Its class.
    pub class: String,
    /// The state of its description.
    pub state: AnchorStateName,
    /// Its description, if it has one.
    pub description: Option<String>,
    /// What kind of text that is; left out without a description.
    pub kind: Option<TextKindName>,
    /// The source of its description: `readings` (the vote over all readings), `operator`, or `plan` for a prior anchor.
    pub description_source: String,
    /// The identifiers found in the description, such as a room's number.
    pub identifiers: Vec<String>,
    /// InformationLevel of the description, 1 (says nothing) to 5 (an identifier in context).
    #[schema(minimum = 1, maximum = 5)]
    pub information_level: u8,
    /// One sentence for a person that says why it has that level; left out without a description.
    pub information_reason: Option<String>,
    /// The formats of the building's numbers on signs of this class, given or learned: patterns, or shapes such as `#.99`, in
    /// which `#` is a run of digits of any length and `9` one digit; left out while it is not known.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub numbering: Vec<String>,
    /// The distinct readings with their votes, heaviest first.
    pub readings: Vec<ReadingView>,
    /// Two readings by models or people that cannot be of one object, such as "901 is not 910"; left out if there are none.
    pub disagreement: Option<String>,
    /// The keyframes that saw it, in order of arrival.
    pub keyframes: Vec<String>,
    /// Its box in the frame of the oldest session that saw it; left out while its place is unknown.
    #[serde(rename = "box")]
    #[from(of.frames.first().map(|(_, bounds, _)| *bounds))]
    pub bounds: Option<BoxView>,
    /// The box's centre, `[x,y,z]` in metres, in the same frame.
    #[is(of.frames.first().map(|(_, bounds, _)| place(&bounds.centre())))]
    pub center: Option<[f64; 3]>,
    /// Its box in the frame of each session that saw it, oldest session first.
    pub frames: Vec<AnchorFrameView>,
    /// Number of its distinct map points.
    pub map_points: usize,
    /// The anchors that match it, oldest first; at most 100 of `matches_total`.
    pub matches: Vec<AnchorMatchView>,
    /// Number of anchors that match it in all.
    pub matches_total: usize,
    /// Of a retired one, the anchor that hangs in its place, if any does.
    pub replaced_by: Option<String>,
    /// The anchor whose name it goes by since they became one.
    pub merged_into: Option<String>,
    /// The anchors that go by its name.
    pub merged_from: Vec<String>,
    /// What a plan says of it; left out where no plan shows it.
    pub prior: Option<PriorView>,
    /// Its place in a plan's frame; left out where no plan shows it and no session that saw it is aligned to one.
    #[from(of.plan_place)]
    pub plan_position: Option<PlanPositionView>,
    /// Whether there is a crop at `.../crop`.
    pub has_crop: bool,
    /// Grows with each fact about this anchor; the `etag` of its answers, wanted by `if-match`.
    pub version: u64,
}

/// A distinct reading of an anchor.
#[answer(of = ReadingReport)]
#[schema(as = Reading)]
pub struct ReadingView {
    /// The text, as last read.
    pub text: String,
    /// The sum of its detections' confidences.
    #[rounded]
    pub weight: f64,
    /// Number of detections that read it.
    pub count: usize,
}

/// An axis-aligned box, in metres; it may be flat.
#[answer(of = Aabb)]
#[schema(as = Box)]
pub struct BoxView {
    /// The corner with the smallest `[x,y,z]`.
    #[is(place(&of.min()))]
    pub min: [f64; 3],
    /// The corner with the largest `[x,y,z]`.
    #[is(place(&of.max()))]
    pub max: [f64; 3],
}

/// An anchor's place in one session's frame.
#[answer(of = (SessionId, Aabb, bool))]
#[schema(as = AnchorFrame)]
pub struct AnchorFrameView {
    /// The session whose frame it is.
    #[from(of.0)]
    pub session: String,
    /// The anchor's box in that frame.
    #[serde(rename = "box")]
    #[from(of.1)]
    pub bounds: BoxView,
    /// The box's centre, `[x,y,z]` in metres.
    #[is(place(&of.1.centre()))]
    pub center: [f64; 3],
    /// `assumed` where the distance of a sight that it is placed by was a guess; else left out.
    #[is(of.2.then_some(RangeName::Assumed))]
    pub range: Option<RangeName>,
}

/// Another anchor with the same meaning.
#[answer(of = AnchorMatchReport)]
#[schema(as = AnchorMatch)]
pub struct AnchorMatchView {
    /// The other anchor.
    #[from(of.name)]
    pub anchor: String,
    /// SimilarityLevel of the two descriptions, 1 (different objects) to 5 (the same).
    #[schema(minimum = 1, maximum = 5)]
    pub level: u8,
    /// The judge: `identical`, `identifiers`, `lexical`, `operator` or `model:<name>`.
    pub source: String,
    /// Whether the two were seen apart, so that the robot has come back.
    #[is(if of.revisit { MatchKind::Revisit } else { MatchKind::Covisible })]
    pub kind: MatchKind,
    /// One sentence for a person.
    pub reason: String,
}

/// `revisit`: none of the two anchors' keyframes are covisible, the robot has come back. `covisible`: some are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[expect(missing_docs, reason = "said above")]
pub enum MatchKind {
    Revisit,
    Covisible,
}

/// A description by hand.
#[answer]
#[serde(deny_unknown_fields)]
pub struct AnchorPatchBody {
    /// The description that stands from now on, whatever is read; null takes an earlier one back.
    #[schema(required, max_length = 4096)]
    #[null]
    pub description: Option<String>,
}

/// The local anchor map M_k of §V-A.
#[answer]
pub struct LocalAnchorMap {
    /// The central keyframe.
    pub keyframe: String,
    /// The map's version.
    pub map_version: u64,
    /// The anchors that the keyframe and those covisible with it see.
    pub anchors: Vec<LocalAnchorView>,
}

/// An anchor as seen from a central keyframe.
#[answer(of = LocalAnchorReport)]
#[schema(as = LocalAnchor)]
pub struct LocalAnchorView {
    /// The anchor.
    pub anchor: String,
    /// Its class.
    pub class: String,
    /// The state of its description; only valid ones count in S.
    pub state: AnchorStateName,
    /// Its description, if it has one.
    pub description: Option<String>,
    /// What kind of text that is; left out without a description.
    pub kind: Option<TextKindName>,
    /// Unit vector towards its centre in the camera's frame, `[x,y,z]`: right, down, forward.
    #[from(of.bearing.direction_in_camera())]
    #[rounded]
    pub bearing: [f64; 3],
    /// Its distance, in metres.
    #[from(of.bearing.distance_m())]
    #[rounded]
    pub distance_m: f64,
    /// Its weight in Eq. (2), in 1/m.
    #[rounded]
    pub weight: f64,
}

impl Decode for AnchorPatchBody {
    fn decode(node: &Node<'_>) -> Option<Self> {
        let body = node.object(&["description"])?;
        body.required("description", |node| {
            if node.value().kind() == Kind::Null {
                return Some(Self { description: None });
            }
            node.text(limits::TEXT_CHARS).map(|text| Self { description: Some(text) })
        })
    }
}

impl AnchorView {
    /// Returns an anchor as an answer of its own, at a version of its map.
    pub fn at(map_version: u64, anchor: AnchorReport) -> Self {
        Self { map_version: Some(map_version), ..anchor.into() }
    }
}

fn place(point: &Point3) -> [f64; 3] {
    [point.x, point.y, point.z].map(rounded)
}
