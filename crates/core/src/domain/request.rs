//! What a client asks for, checked: the requests that are more than an id.

use super::anchor::AnchorState;
use super::ids::{BackupId, JudgementId, KeyframeId, LoopId, PointId, ReleaseName, SessionId};
use super::judged::{CropReading, ModelVerdict};
use super::judgement::Asks;
use super::keyframe::NewKeyframe;
use super::named_detection::NamedDetection;
pub use super::observation_update::{ChangedKeyframe, ChangedObservations};
use super::release::MapBase;
use super::settings::SettingValue;
use super::verdict::Verify;
use crate::geometry::{Gravity, Point3, Pose, Sim3};
use crate::named::named;

/// Digest of a request: tells a retry from another request under the same id.
pub type Digest = [u8; 32];

/// Changes of a map; a field that is left out stays.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MapPatch {
    /// The new description.
    pub description: Option<String>,
    /// The new classes.
    pub anchor_classes: Option<Vec<String>>,
    /// The new classes of codes.
    pub code_classes: Option<Vec<String>>,
    /// Whether its lengths are metres.
    pub metric: Option<bool>,
    /// Gravity in its sessions' frame.
    pub gravity: Option<Gravity>,
    /// Settings to change, by name.
    pub settings: Vec<(String, SettingValue)>,
}

/// A map to be made.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NewMap {
    /// The differences from the defaults, or from the base.
    pub patch: MapPatch,
    /// The map that it begins as, if there is one.
    pub base: Option<MapBase>,
}

/// A verdict of a model, brought from elsewhere.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NewVerdict {
    /// A level, or a merged text.
    OfTexts(ModelVerdict),
    /// A reading of the crop of a detection.
    OfCrop(NamedDetection, CropReading),
}

/// A loop that a client has closed in its own map.
#[derive(Clone, Debug, PartialEq)]
pub struct NewLoop {
    /// Its name.
    pub id: LoopId,
    /// The keyframe that came back.
    pub keyframe: KeyframeId,
    /// The keyframe it came back to.
    pub candidate: KeyframeId,
    /// The query that found it.
    pub query: Option<String>,
    /// Maps points of the keyframe's camera frame into that of the candidate, as the client closed it.
    pub candidate_from_query: Option<Sim3>,
}

/// A backup that is to be taken.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct NewBackup {
    /// Its name; without one the server finds one.
    pub id: Option<BackupId>,
}

/// Corrected poses and map points of one session.
#[derive(Clone, Debug, PartialEq)]
pub struct PoseCorrection {
    /// The session.
    pub session: SessionId,
    /// The keyframes and their new `map_from_camera`, in metres.
    pub keyframes: Vec<(KeyframeId, Pose)>,
    /// The map points and their new positions, in the session's frame, in metres.
    pub map_points: Vec<(PointId, Point3)>,
}

/// The keyframe that is asked about.
#[derive(Clone, Debug)]
pub enum Subject {
    /// One of the map.
    Stored(KeyframeId),
    /// One that came with the query and is not stored.
    Inline(Box<NewKeyframe>, Digest),
}

named! {
    /// How much of a verdict the answer contains. The record of the verdict is always whole.
    Detail default Full {
        /// The default: every candidate with all of its figures.
        Full = "full",
        /// Without the rejected candidates, and without the `matches` of the others.
        Brief = "brief",
    }
}

/// A loop query.
#[derive(Clone, Debug)]
pub struct LoopQuery {
    /// The keyframe that is asked about.
    pub subject: Subject,
    /// The release of the map that is asked; the map as it stands if none is named.
    pub release: Option<ReleaseName>,
    /// The checks to run.
    pub verify: Verify,
    /// Maximum wait for descriptions that are still missing, in milliseconds.
    pub max_wait_ms: u64,
    /// The seed of whatever is drawn.
    pub seed: u64,
    /// Whether a loop counts that repeats a confirmed one.
    pub again: bool,
}

/// A job that asks a map's verdicts again, as asked for.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct NewJudgement {
    /// Its id; the server finds one if it is left out.
    pub id: Option<JudgementId>,
    /// The verdicts that it asks for again.
    pub asks: Asks,
    /// Whether it is only counted and not begun.
    pub preview: bool,
}

/// The wanted part of a list.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PageRequest {
    /// The cursor that the part before it ended with.
    pub cursor: Option<String>,
    /// The most items.
    pub limit: usize,
}

/// The wanted anchors.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct AnchorFilter {
    /// Of this class.
    pub class: Option<String>,
    /// With this text in their description, whatever the case, width and dashes.
    pub text: Option<String>,
    /// In this state.
    pub state: Option<AnchorState>,
    /// With those that were merged into others.
    pub merged: bool,
    /// Prior ones alone, or those alone that robots saw.
    pub prior: Option<bool>,
}
