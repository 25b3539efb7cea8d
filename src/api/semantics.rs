//! Semantics: the three functions of §IV-A.2, asked by hand.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::decoding::read::{Decode, Node};
use super::limits;

/// Two descriptions of objects of one class.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct TextPair {
    /// One description.
    #[schema(max_length = 4096)]
    pub a: String,
    /// The other description.
    #[schema(max_length = 4096)]
    pub b: String,
    /// The objects' class.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(min_length = 1, max_length = 64)]
    pub class: Option<String>,
}

/// A description of an object.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct OneText {
    /// The description.
    #[schema(max_length = 4096)]
    pub text: String,
    /// The object's class.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(min_length = 1, max_length = 64)]
    pub class: Option<String>,
}

/// SimilarityLevel or InformationLevel.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
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
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
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

impl Decode for TextPair {
    fn decode(node: &Node<'_>) -> Option<Self> {
        let body = node.object(&["a", "b", "class"])?;
        let [a, b] = ["a", "b"].map(|name| body.required(name, |node| node.text(limits::TEXT_CHARS)));
        let class = body.optional("class", |node| node.name(limits::CLASS_CHARS));
        Some(Self { a: a?, b: b?, class: class? })
    }
}

impl Decode for OneText {
    fn decode(node: &Node<'_>) -> Option<Self> {
        let body = node.object(&["text", "class"])?;
        let text = body.required("text", |node| node.text(limits::TEXT_CHARS));
        let class = body.optional("class", |node| node.name(limits::CLASS_CHARS));
        Some(Self { text: text?, class: class? })
    }
}
