//! Body: the body of a request, in the shape that its operation takes or as it was recorded.

use serde::Serialize;
use serde_json::{Map, Value};

use crate::wire::anchor::AnchorPatchBody;
use crate::wire::backup::BackupBody;
use crate::wire::judgement::JudgementBody;
use crate::wire::key::KeyBody;
use crate::wire::keyframe::KeyframeBody;
use crate::wire::loop_query::LoopQueryBody;
use crate::wire::loops::LoopBody;
use crate::wire::map::{MapBody, MapPatchBody};
use crate::wire::model_verdict::ModelVerdictBody;
use crate::wire::poses::PosesBody;
use crate::wire::semantics::{OneText, TextPair};

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
    JudgementBody,
    KeyBody,
    KeyframeBody,
    LoopBody,
    LoopQueryBody,
    MapBody,
    MapPatchBody,
    ModelVerdictBody,
    OneText,
    PosesBody,
    TextPair,
}
