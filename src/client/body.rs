//! Body: the body of a request, in the shape that its operation takes or as it was recorded.

use serde::Serialize;
use serde_json::{Map, Value};

use crate::api::anchor::AnchorPatchBody;
use crate::api::backup::BackupBody;
use crate::api::erasure::ErasureBody;
use crate::api::judgement::JudgementBody;
use crate::api::key::KeyBody;
use crate::api::keyframe::KeyframeBody;
use crate::api::location::LocateBody;
use crate::api::loop_query::LoopQueryBody;
use crate::api::loops::LoopBody;
use crate::api::map::{MapBody, MapPatchBody};
use crate::api::model_verdict::ModelVerdictBody;
use crate::api::observations::ObservationsBody;
use crate::api::poses::PosesBody;
use crate::api::prior::PriorBody;
use crate::api::release::ReleaseBody;
use crate::api::semantics::{OneText, TextPair};
use crate::api::session_merge::MergeBody;

/// A body for an operation that takes `Shape`.
pub trait Body<Shape>: Serialize {}

/// A body as it was recorded: it is sent as it is, and the server says what is wrong with it.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[serde(transparent)]
pub struct Recorded(pub Map<String, Value>);

impl<Shape> Body<Shape> for Recorded {}

macro_rules! bodies {
    ($($shape:ty,)+) => {
        $(impl Body<$shape> for $shape {})+
    };
}

bodies! {
    AnchorPatchBody,
    BackupBody,
    ErasureBody,
    JudgementBody,
    KeyBody,
    KeyframeBody,
    LocateBody,
    LoopBody,
    LoopQueryBody,
    MapBody,
    MapPatchBody,
    ModelVerdictBody,
    ObservationsBody,
    MergeBody,
    OneText,
    PosesBody,
    PriorBody,
    ReleaseBody,
    TextPair,
}
