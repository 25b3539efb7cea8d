//! Transcript: the dialogues that described an anchor (§IV-A.1).

use revisit_core::domain::judged::{Transcript, TranscriptStep};
use revisit_core::domain::prior::AnchorKey;
use revisit_shapes::answer;

/// The dialogues about an anchor's crops.
#[answer]
pub struct TranscriptList {
    /// The map's version.
    pub map_version: u64,
    /// The anchor.
    pub anchor: String,
    /// The dialogues, the newest keyframe's first; at most 32.
    pub items: Vec<TranscriptView>,
}

/// One dialogue about one crop, and what came of it.
#[answer(of = Transcript)]
#[schema(as = Transcript)]
pub struct TranscriptView {
    /// The keyframe that brought the crop.
    pub keyframe: String,
    /// The number of the detection in it.
    pub detection: u16,
    /// The description; empty if nothing could be made of the crop.
    #[from(of.reading.text)]
    pub text: String,
    /// The source of the description: `model:<name>`, or a reader of characters such as `tesseract`.
    #[from(of.reading.source)]
    pub source: String,
    /// Whether a reader stood in because a model was away. It is described again then.
    #[from(of.reading.degraded)]
    pub degraded: bool,
    /// Questions and answers, in their order.
    pub steps: Vec<StepView>,
}

/// One question and its answer.
#[answer(of = TranscriptStep)]
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
