//! Recorded operations: what a map was sent, one by one, as a recording writes it.

use super::ids::{LoopId, PriorId, SessionId};
use super::judged::{CropReading, ModelVerdict};
use super::keyframe::NewKeyframe;
pub use super::named_detection::NamedDetection;
use super::prior::NewPrior;
use super::request::{ChangedObservations, MapPatch, NewLoop, PoseCorrection};
use super::session_merge::SessionMergeRequest;

/// An operation that changed a map, as its client sent it.
#[derive(Clone, Debug, PartialEq)]
pub enum Recorded {
    /// The map was made, or what it names was changed.
    Map(MapPatch),
    /// A keyframe was stored, with its pose and positions of that time.
    Keyframe(Box<NewKeyframe>),
    /// Poses and map points were corrected.
    Poses(PoseCorrection),
    /// The client's map changed what keyframes observe.
    Observations(ChangedObservations),
    /// A session merged into another one.
    SessionsMerged(SessionMergeRequest),
    /// A merge of this session was revoked.
    MergeRevoked(SessionId),
    /// A loop was confirmed.
    Loop(NewLoop),
    /// A loop was revoked.
    LoopRevoked(LoopId),
    /// The anchor that a detection feeds was described by hand, or given back to its readings.
    Description {
        /// The detection.
        detection: NamedDetection,
        /// The description.
        text: Option<String>,
    },
    /// The anchor that a detection fed was deleted.
    AnchorDeleted(NamedDetection),
    /// A prior anchor was put.
    Prior(NewPrior),
    /// A prior anchor was deleted.
    PriorDeleted(PriorId),
    /// A model judged texts.
    Judged(ModelVerdict),
    /// A model, or a reader of characters, read the crop of a detection.
    CropRead {
        /// The detection.
        detection: NamedDetection,
        /// The reading.
        reading: CropReading,
    },
}
