//! Keyframes as the service answers them.

use revisit_core::domain::anchor::{AnchorState, Outcome};
use revisit_core::domain::bow::BowVector;
use revisit_core::domain::ids::KeyframeId;
use revisit_core::domain::keyframe::Detection;
use revisit_core::domain::report::{KeyframeRecord, KeyframeReport, KeyframeSummary};
use revisit_core::geometry::Gravity;
use revisit_shapes::answer;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::global_descriptor::GlobalDescriptorShape;
use super::original::is_named;
use super::shape::{BowShape, CameraShape, CovisibleShape, FeaturesShape, PointsShape, RangeName};
use crate::names::{AnchorStateName, IgnoredReasonName};
use crate::shown::Shown;
use crate::space::{Time, Transform};
use crate::verdict::LoopAnswer;

/// Said of a keyframe that is covisible with none, though its session has others.
const CUT_OFF: &str = "no keyframe is covisible with it, so the place that the robot has just left may be answered as a loop: \
    send `observes`, or `covisible` (an empty list says that none is), or keyframes closer together than the setting \
    covisibility_max_way_m";

/// A keyframe is stored.
#[answer(of = KeyframeReport)]
pub struct KeyframeAnswer {
    /// Its id.
    pub keyframe: String,
    /// The map's version after it.
    pub map_version: u64,
    /// How many keyframes are covisible with it.
    pub covisible: usize,
    /// The consequence of it, where nothing joins it with the others of its session; else left out.
    #[is(of.is_cut_off.then(|| CUT_OFF.to_owned()))]
    pub notice: Option<String>,
    /// What became of its detections, in their order.
    pub detections: Vec<OutcomeView>,
    /// The answer to the loop query, if the request asked it.
    #[serde(rename = "loop")]
    #[is(None)]
    pub loop_answer: Option<LoopAnswer>,
}

/// What became of a detection.
#[answer]
#[schema(as = DetectionOutcome)]
pub struct OutcomeView {
    /// The anchor that it feeds.
    pub anchor: Option<String>,
    /// What became of it.
    pub outcome: OutcomeName,
    /// Why it was ignored.
    pub reason: Option<IgnoredReasonName>,
    /// How far the anchor's description is.
    pub state: Option<AnchorStateName>,
}

/// What can become of a detection: it founds an anchor, is one more sight of a known one, or feeds none.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[expect(missing_docs, reason = "said above")]
pub enum OutcomeName {
    Created,
    Observed,
    Ignored,
}

/// A keyframe as it stands now: what was sent, as last corrected, and what became of it.
#[answer]
pub struct KeyframeView {
    /// Its id.
    pub id: String,
    /// The map's version.
    pub map_version: u64,
    /// Its session.
    pub session: String,
    /// When it was taken.
    pub stamp: Time,
    /// `map_from_camera` in the session's frame, in metres, as last corrected.
    pub pose: Transform,
    /// The camera.
    pub camera: Option<CameraShape>,
    /// The unit vector of gravity in the camera frame, as sent.
    #[schema(value_type = Option<[f64; 3]>, min_items = 3, max_items = 3, minimum = -1.001, maximum = 1.001)]
    pub gravity: Option<Gravity>,
    /// The height that a barometer tells, in metres, as sent.
    pub height_m: Option<f64>,
    /// The bag of words, words ascending, weights summing to one.
    pub bow: BowShape,
    /// The vector of the whole image.
    pub global_descriptor: Option<GlobalDescriptorShape>,
    /// The features.
    pub features: Option<FeaturesShape>,
    /// The map points it brought, at their present positions.
    pub map_points: PointsShape,
    /// Every map point it observes, ascending.
    pub observes: Vec<i64>,
    /// The covisible keyframes that its client declared; all of them are listed at `.../covisible`.
    pub covisible: Vec<CovisibleShape>,
    /// The number of keyframes that are covisible with it: by shared points, by declaration, by a confirmed loop or along the drive.
    pub covisible_total: usize,
    /// Its detections, each with what became of it.
    pub detections: Vec<DetectionView>,
}

/// A detection as stored; its crop is read through its anchor.
#[answer]
pub struct DetectionView {
    /// The object's class.
    pub class: String,
    /// The detector's confidence, 0 to 1.
    pub confidence: f64,
    /// `[x0,y0,x1,y1]`, in pixels.
    #[serde(rename = "box")]
    pub box_px: [f64; 4],
    /// The map points that the box covers, ascending.
    pub map_points: Vec<i64>,
    /// Where the object stands in the session's frame, in metres.
    pub position: Option<[f64; 3]>,
    /// `assumed` if nothing measured the distance of `position`; else left out.
    #[schema(inline)]
    pub range: Option<RangeName>,
    /// What a reader made of it.
    pub text: Option<String>,
    /// What a model or a person made of it.
    pub description: Option<String>,
    /// Whether a crop came with it.
    pub has_crop: bool,
    /// The anchor that it feeds.
    pub anchor: Option<String>,
    /// What became of it.
    pub outcome: OutcomeName,
    /// Why it was ignored.
    pub reason: Option<IgnoredReasonName>,
    /// How far the anchor's description is.
    pub state: Option<AnchorStateName>,
}

/// A line of the list of keyframes.
#[answer(of = KeyframeSummary)]
pub struct KeyframeLine {
    /// Its id.
    pub id: String,
    /// Its session.
    pub session: String,
    /// When it was taken.
    pub stamp: Time,
    /// `map_from_camera` in the session's frame, in metres, as last corrected.
    #[from(of.map_from_camera)]
    pub pose: Transform,
    /// How many keyframes are covisible with it.
    pub covisible: usize,
    /// The anchors it sees.
    pub anchors: Vec<String>,
}

/// A keyframe that is covisible with another.
#[answer(of = (KeyframeId, u32))]
pub struct CovisibleView {
    /// The other keyframe.
    #[from(of.0)]
    pub keyframe: String,
    /// How many map points they share: by observation, or as declared.
    #[from(of.1)]
    pub shared: u32,
}

impl Shown<(Outcome, Option<AnchorState>)> for OutcomeView {
    fn shown((outcome, state): (Outcome, Option<AnchorState>)) -> Self {
        let (outcome, anchor, reason) = match outcome {
            Outcome::Created(anchor) => (OutcomeName::Created, Some(anchor.public()), None),
            Outcome::Observed(anchor) => (OutcomeName::Observed, Some(anchor.public()), None),
            Outcome::Ignored(reason) => (OutcomeName::Ignored, None, Some(reason.into())),
        };
        Self { anchor, outcome, reason, state: state.map(AnchorStateName::from) }
    }
}

impl KeyframeView {
    /// A keyframe at a version of its map.
    pub fn of(map_version: u64, record: KeyframeRecord) -> Self {
        let KeyframeRecord { keyframe, detections: outcomes, has_crop, covisible } = record;
        Self {
            id: keyframe.id.to_string(),
            map_version,
            session: keyframe.session.to_string(),
            stamp: keyframe.stamp.into(),
            pose: keyframe.map_from_camera.into(),
            camera: keyframe.camera.map(CameraShape::from),
            gravity: keyframe.gravity,
            height_m: keyframe.height_m,
            bow: BowShape {
                vocabulary: keyframe.vocabulary.map(Into::into).filter(is_named),
                ..(&keyframe.bow).into()
            },
            global_descriptor: keyframe.global_descriptor.map(Into::into),
            features: keyframe.features.map(FeaturesShape::from),
            map_points: Shown::shown(keyframe.map_points),
            observes: keyframe.observes,
            covisible: Shown::shown(keyframe.covisible.unwrap_or_default()),
            covisible_total: covisible,
            detections: (keyframe.detections.into_iter().zip(outcomes).zip(has_crop))
                .map(|(detection, has_crop)| DetectionView { has_crop, ..detection.into() })
                .collect(),
        }
    }
}

impl From<(Detection, (Outcome, Option<AnchorState>))> for DetectionView {
    fn from((detection, outcome): (Detection, (Outcome, Option<AnchorState>))) -> Self {
        let OutcomeView { anchor, outcome, reason, state } = OutcomeView::shown(outcome);
        Self {
            class: detection.class,
            confidence: detection.confidence,
            box_px: detection.box_px,
            map_points: detection.map_points,
            position: detection.position_in_session.map(|point| point.coords.into()),
            range: detection.range_assumed.then_some(RangeName::Assumed),
            text: detection.text,
            description: detection.description,
            has_crop: detection.crop.is_some(),
            anchor,
            outcome,
            reason,
            state,
        }
    }
}

impl From<&BowVector> for BowShape {
    fn from(bow: &BowVector) -> Self {
        // Ten decimals: one unit of 2^-31 is 4.7e-10, and no word's weight may become zero.
        let shown = |units: u32| (f64::from(units) / f64::from(BowVector::ONE) * 1e10).round() / 1e10;
        Self {
            words: bow.words().to_vec(),
            weights: bow.weights().iter().map(|&units| shown(units)).collect(),
            vocabulary: None,
        }
    }
}
