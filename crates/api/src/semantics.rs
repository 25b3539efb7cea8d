//! Semantics: the three functions of §IV-A.2, asked by hand.

use revisit_core::domain::judge_answer::{Judged, Merged};
use revisit_shapes::{answer, body};

/// Two descriptions of objects of one class.
#[body]
pub struct TextPair {
    /// One description.
    #[schema(max_length = 4096)]
    pub a: String,
    /// The other description.
    #[schema(max_length = 4096)]
    pub b: String,
    /// The objects' class.
    #[schema(min_length = 1, max_length = 64)]
    pub class: Option<String>,
}

/// A description of an object.
#[body]
pub struct OneText {
    /// The description.
    #[schema(max_length = 4096)]
    pub text: String,
    /// The object's class.
    #[schema(min_length = 1, max_length = 64)]
    pub class: Option<String>,
}

/// SimilarityLevel or InformationLevel.
#[answer(of = Judged)]
pub struct LevelAnswer {
    /// 1 to 5. Similarity: 1 different objects, 5 the same. Information: 1 says nothing, 5 an identifier in context.
    #[schema(minimum = 1, maximum = 5)]
    pub level: u8,
    /// The judge: `identical`, `identifiers`, `lexical`, `operator` or `model:<name>`.
    pub source: String,
    /// One sentence for a person.
    pub reason: String,
    /// Whether the answer came from a cache of model answers.
    pub cached: bool,
    /// Whether the built-in judge stood in because a model was away.
    pub degraded: bool,
}

/// MergeText: one description out of two.
#[answer(of = Merged)]
pub struct MergeAnswer {
    /// The description.
    pub text: String,
    /// The source of the merged text: `lexical` or `model:<name>`.
    pub source: String,
    /// Whether the answer came from a cache of model answers.
    pub cached: bool,
    /// Whether the built-in judge stood in because a model was away.
    pub degraded: bool,
}
