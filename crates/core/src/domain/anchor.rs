//! The outcome of a detection: an observation of a semantic anchor, or a reason why not.

use serde::{Deserialize, Serialize};

use super::ids::{AnchorSeq, KeyframeSeq, PointId};
use super::judged::CropReading;
use crate::geometry::Point3;
use crate::named::named;

/// One detection of one keyframe that feeds an anchor.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Observation {
    /// The keyframe that saw the anchor.
    pub keyframe: KeyframeSeq,
    /// The number of the keyframe's detection.
    pub detection: u16,
    /// The detector's confidence, in `[0, 1]`: the weight of the reading's vote.
    pub confidence: f64,
    /// The map points in the detection's box, ascending.
    pub map_points: Box<[PointId]>,
    /// The object's position as it was sent with the keyframe, in its session's frame;
    /// [`position_now`](super::change::Keyframe::position_now) tells where it is by now.
    pub position_as_sent: Option<Point3>,
    /// Whether nothing measured the distance of that position.
    pub range_assumed: bool,
    /// The text that was read.
    pub reading: Option<Box<str>>,
    /// Whether a model or a person described it, rather than a reader of characters.
    pub described: bool,
    /// The area of the crop's box in pixels, if there is a crop.
    pub crop_area_px: Option<f64>,
    /// A model's reading of the crop, if there is one.
    pub crop_reading: Option<CropReading>,
}

impl Observation {
    /// Returns the texts that it was read as: by the client, by a model, or both.
    pub fn readings(&self) -> impl Iterator<Item = &str> {
        let by_client = self.reading.as_deref();
        let by_model = self.crop_reading.as_ref().map(|read| &*read.text);
        by_client.into_iter().chain(by_model.filter(|text| by_client != Some(text)))
    }
}

/// The outcome of a detection on arrival (the `outcome` of `openapi/openapi.yaml`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Outcome {
    /// It founded a new anchor.
    Created(AnchorSeq),
    /// It is one more sight of a known anchor.
    Observed(AnchorSeq),
    /// It was kept with its keyframe and feeds no anchor.
    Ignored(IgnoredReason),
}

named! {
    /// The reason why a detection feeds no anchor.
    IgnoredReason {
        /// The map's `anchor_classes` do not name its class.
        ClassNotAnchored = "class_not_anchored",
        /// It has neither map points nor a position.
        NoPlace = "no_place",
        /// An operator deleted the anchor it fed.
        AnchorDeleted = "anchor_deleted",
    }
}

named! {
    /// The progress of an anchor's description.
    AnchorState {
        /// Nothing has described it yet.
        Pending = "pending",
        /// Its description says enough to tell it from others (§IV-B).
        Valid = "valid",
        /// Its description says too little.
        Uninformative = "uninformative",
        /// The sign hangs there no longer: three passages had it in view and did not see it (`signs_may_change`, M18). It takes
        /// part in no comparison, and can be listed.
        Retired = "retired",
    }
}
