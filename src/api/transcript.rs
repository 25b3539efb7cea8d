//! Transcript: the dialogues that described an anchor (§IV-A.1).

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::domain::judged::{Transcript, TranscriptStep};
use crate::domain::prior::AnchorKey;

/// The dialogues about an anchor's crops.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct TranscriptList {
    /// The map's version.
    pub map_version: u64,
    /// The anchor.
    pub anchor: String,
    /// The dialogues, the newest keyframe's first; at most 32.
    pub items: Vec<TranscriptView>,
}

/// One dialogue about one crop, and what came of it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[schema(as = Transcript)]
pub struct TranscriptView {
    /// The keyframe that brought the crop.
    pub keyframe: String,
    /// The number of the detection in it.
    pub detection: u16,
    /// The description; empty if nothing could be made of the crop.
    pub text: String,
    /// The source of the description: `model:<name>`, or a reader of characters such as `tesseract`.
    pub source: String,
    /// Whether a reader stood in because a model was away. It is described again then.
    pub degraded: bool,
    /// Questions and answers, in their order.
    pub steps: Vec<StepView>,
}

/// One question and its answer.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[schema(as = TranscriptStep)]
pub struct StepView {
    /// The source of the answer.
    pub speaker: String,
    /// The question.
    pub question: String,
    /// The answer.
    pub answer: String,
}

impl TranscriptList {
    /// Returns the dialogues about an anchor at a version of its map.
    pub fn of(map_version: u64, anchor: &AnchorKey, transcripts: Vec<Transcript>) -> Self {
        let items = transcripts.into_iter().map(TranscriptView::from).collect();
        Self { map_version, anchor: anchor.to_string(), items }
    }
}

impl From<Transcript> for TranscriptView {
    fn from(transcript: Transcript) -> Self {
        let Transcript { keyframe, detection, reading, steps } = transcript;
        Self {
            keyframe,
            detection,
            text: reading.text.into(),
            source: reading.source.to_string(),
            degraded: reading.degraded,
            steps: steps.into_iter().map(StepView::from).collect(),
        }
    }
}

impl From<TranscriptStep> for StepView {
    fn from(step: TranscriptStep) -> Self {
        Self { speaker: step.speaker.to_string(), question: step.question, answer: step.answer }
    }
}
