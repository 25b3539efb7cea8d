//! What became of a detection: an observation of a semantic anchor, or a reason why not.

use super::ids::{AnchorSeq, KeyframeSeq, PointId};
use super::judged::CropReading;
use crate::geometry::Point3;

/// One detection of one keyframe that feeds an anchor.
#[derive(Clone, Debug, PartialEq)]
pub struct Observation {
    /// The keyframe that saw the anchor.
    pub keyframe: KeyframeSeq,
    /// Which of the keyframe's detections it was.
    pub detection: u16,
    /// The detector's confidence, in `[0, 1]`: the weight of the reading's vote.
    pub confidence: f64,
    /// The map points in the detection's box, ascending.
    pub map_points: Box<[PointId]>,
    /// Where the object stands, in the keyframe's session's frame.
    pub position_in_session: Option<Point3>,
    /// Whether nothing measured the distance of that position.
    pub range_assumed: bool,
    /// What was read.
    pub reading: Option<Box<str>>,
    /// Did a model or a person describe it, rather than a reader of characters?
    pub described: bool,
    /// The area of the crop's box in pixels, if there is a crop.
    pub crop_area_px: Option<f64>,
    /// What a model made of the crop, if one has read it.
    pub crop_reading: Option<CropReading>,
}

/// What ingest made of a detection (the `outcome` of `openapi/openapi.yaml`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// It founded a new anchor.
    Created(AnchorSeq),
    /// It is one more sight of a known anchor.
    Observed(AnchorSeq),
    /// It was kept with its keyframe and feeds no anchor.
    Ignored(IgnoredReason),
}

/// Why a detection feeds no anchor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum IgnoredReason {
    /// The map's `anchor_classes` do not name its class.
    ClassNotAnchored,
    /// It has neither map points nor a position.
    NoPlace,
    /// An operator deleted the anchor it fed.
    AnchorDeleted,
}

impl IgnoredReason {
    /// The reason's name in the API document.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::ClassNotAnchored => "class_not_anchored",
            Self::NoPlace => "no_place",
            Self::AnchorDeleted => "anchor_deleted",
        }
    }

    /// The reason of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        [Self::ClassNotAnchored, Self::NoPlace, Self::AnchorDeleted].into_iter().find(|r| r.as_str() == name)
    }
}

/// How far an anchor's description is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum AnchorState {
    /// Nothing has described it yet.
    Pending,
    /// Its description says enough to tell it from others (§IV-B).
    Valid,
    /// Its description says too little.
    Uninformative,
    /// Retired: the sign hangs there no longer (M18). It takes part in no comparison, and can be listed.
    Retired,
}

impl AnchorState {
    /// The state's name in the API document.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Pending => "pending",
            Self::Valid => "valid",
            Self::Uninformative => "uninformative",
            Self::Retired => "retired",
        }
    }

    /// The state of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        [Self::Pending, Self::Valid, Self::Uninformative, Self::Retired]
            .into_iter()
            .find(|s| s.as_str() == name)
    }
}
