//! Judgements: jobs that ask a changed model again about what a map's verdicts say.

use serde::{Deserialize, Serialize};

use super::ids::{JudgementId, KeyframeSeq};
use crate::named::named;

named! {
    /// The verdicts that a job asks for again.
    Asks default All {
        /// The default: all of them.
        All = "all",
        /// Those about texts: levels and merged texts.
        Texts = "texts",
        /// The descriptions of crops.
        Crops = "crops",
    }
}

impl Asks {
    /// Whether crops are read again.
    pub fn crops(self) -> bool {
        self != Self::Texts
    }

    /// Whether texts are judged again.
    pub fn texts(self) -> bool {
        self != Self::Crops
    }
}

named! {
    /// The functions of §IV-A.2, in the order in which a job asks them again; the store sorts them by name.
    TextFunction {
        /// InformationLevel.
        Information = "information",
        /// MergeText.
        Merge = "merge",
        /// SimilarityLevel.
        Similarity = "similarity",
    }
}

/// A question that was answered before, by another model or by other prompts.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum PastQuestion {
    /// The reading of a detection's crop.
    Crop {
        /// The keyframe.
        keyframe: KeyframeSeq,
        /// The detection.
        detection: u16,
    },
    /// A verdict about texts of one class, in normal form.
    Texts {
        /// The question.
        function: TextFunction,
        /// The class.
        class: Box<str>,
        /// The only text, or the smaller of the two.
        a: Box<str>,
        /// The larger of the two; empty for one text.
        b: Box<str>,
    },
}

/// Number of questions of a kind that a job would ask.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Workload {
    /// Crops by class.
    pub crops: Vec<(String, u64)>,
    /// Questions about texts, each kind with the characters of its texts.
    pub texts: Vec<(TextFunction, u64, u64)>,
}

impl Workload {
    /// Returns the number of questions.
    pub fn questions(&self) -> u64 {
        let crops = self.crops.iter().map(|(_, count)| count);
        crops.chain(self.texts.iter().map(|(_, count, _)| count)).sum()
    }
}

/// The most that a job may take.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Estimate {
    /// Calls of models.
    pub calls: u64,
    /// Millionths of a US dollar.
    pub microusd: u64,
}

named! {
    /// The state of a job.
    JobState {
        /// It asks.
        Running = "running",
        /// Every question is settled.
        Done = "done",
        /// It was stopped.
        Stopped = "stopped",
    }
}

/// The outcomes of a job's questions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Tally {
    /// Answered otherwise than before.
    pub changed: u64,
    /// Answered as before.
    pub unchanged: u64,
    /// About something that the map no longer holds.
    pub gone: u64,
    /// Not answered.
    pub failed: u64,
}

impl Tally {
    /// Returns how many questions are settled.
    pub fn settled(self) -> u64 {
        self.changed + self.unchanged + self.gone + self.failed
    }
}

/// A job as the store keeps it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Judgement {
    /// Its id.
    pub id: JudgementId,
    /// The verdicts that it asks for again.
    pub asks: Asks,
    /// Its state.
    pub state: JobState,
    /// The map's version when it began.
    pub since_version: u64,
    /// Its questions, as counted when it began.
    pub questions: u64,
    /// The most that it may take, as foreseen when it began.
    pub estimate: Estimate,
    /// The outcomes of its questions.
    pub tally: Tally,
    /// The question that was settled last.
    pub position: Option<PastQuestion>,
}

/// A job has settled some of its questions.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct JudgementProgress {
    /// The job.
    pub id: JudgementId,
    /// The outcomes of the questions that were settled now.
    pub tally: Tally,
    /// The last of them; none if there were none left.
    pub position: Option<PastQuestion>,
    /// Whether none is left.
    pub is_over: bool,
}

/// A verdict that was replaced, beside the one that stands now.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Replaced {
    /// The version of the map that replaced it.
    pub map_version: u64,
    /// The question: `describe`, `information`, `merge` or `similarity`.
    pub operation: String,
    /// The class of the object.
    pub class: String,
    /// The texts that were judged; none of a crop.
    pub texts: Vec<String>,
    /// The crop's keyframe and detection; none of texts.
    pub crop: Option<(String, u16)>,
    /// The answer before, and its source.
    pub before: (String, String),
    /// The answer now, and its source.
    pub after: (String, String),
}
