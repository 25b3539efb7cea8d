//! What models said of a map's anchors: facts, fetched beforehand and kept.

use std::fmt;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::ids::{AnchorSeq, KeyframeSeq};

/// The reading of one detection's crop by a model, or by a reader of characters.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct CropReading {
    /// The description; empty if nothing could be made of the crop.
    pub text: Box<str>,
    /// `model:<name>`, or the reader's name.
    pub source: Arc<str>,
    /// Whether a model described it, rather than a reader of characters.
    pub described: bool,
    /// Whether a reader stood in because the model was away. It is read again then.
    pub degraded: bool,
}

/// One question and its answer.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct TranscriptStep {
    /// The source of the answer: `model:<name>`, or the reader's name.
    pub speaker: Arc<str>,
    /// The question.
    pub question: String,
    /// The answer.
    pub answer: String,
}

/// A crop was read: the reading and the dialogue that led to it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct CropRead {
    /// The anchor that the detection feeds.
    pub anchor: AnchorSeq,
    /// The keyframe.
    pub keyframe: KeyframeSeq,
    /// The detection.
    pub detection: u16,
    /// The reading of the crop.
    pub reading: CropReading,
    /// How; the index does not keep it.
    pub transcript: Vec<TranscriptStep>,
    /// The fingerprint of the models and prompts behind it; the index does not keep it.
    pub fingerprint: Arc<str>,
}

/// A reading with its dialogue, for a reader.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Transcript {
    /// The keyframe's name.
    pub keyframe: String,
    /// The number of the detection in it.
    pub detection: u16,
    /// Its outcome.
    pub reading: CropReading,
    /// The steps, in their order.
    pub steps: Vec<TranscriptStep>,
}

/// A finding of a model.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Finding {
    /// SimilarityLevel of two texts, 1 to 5.
    Similarity(u8),
    /// InformationLevel of one text, 1 to 5.
    Information(u8),
    /// MergeText of two texts.
    Merge(Box<str>),
}

impl Finding {
    /// Returns the name of the question that it answers.
    pub fn operation(&self) -> &'static str {
        match self {
            Self::Similarity(_) => "similarity",
            Self::Information(_) => "information",
            Self::Merge(_) => "merge",
        }
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Similarity(level) | Self::Information(level) => write!(out, "{level}"),
            Self::Merge(text) => out.write_str(text),
        }
    }
}

/// The outcome of a question to a model.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Answer {
    /// A crop was read.
    Reading(CropRead),
    /// Texts were judged.
    Verdict(ModelVerdict),
}

/// A model's verdict about texts of one class, in normal form.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ModelVerdict {
    /// The class of the objects that carry the texts.
    pub class: Box<str>,
    /// The only text, or the smaller of the two.
    pub a: Box<str>,
    /// The larger of the two; empty for one text.
    pub b: Box<str>,
    /// The finding.
    pub finding: Finding,
    /// `model:<name>`, or who stood in for good (a merge that the model could not do).
    pub source: Arc<str>,
    /// Why, in one sentence for a person; empty where it was not given.
    pub reason: Box<str>,
    /// The fingerprint of the model and prompts behind it; the index does not keep it.
    pub fingerprint: Arc<str>,
}
