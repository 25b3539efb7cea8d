//! Model verdict: what a model said of a map's texts or crops, brought from elsewhere.

use revisit_core::domain::judged::{CropReading, Finding, ModelVerdict};
use revisit_core::domain::recorded::NamedDetection;
use revisit_core::domain::request::NewVerdict;
use revisit_core::semantics::Text;
use revisit_shapes::answer;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::decoding::read::{self, Decode, Node, Object};
use super::limits;

/// A verdict of a model: a level or a merged text of texts of one class, or a description of a detection's crop.
#[answer]
#[derive(Default)]
#[serde(deny_unknown_fields)]
#[schema(as = ModelVerdict)]
pub struct ModelVerdictBody {
    /// The question.
    pub operation: ModelOperationName,
    /// The class of the objects that carry the texts; of all but `describe`.
    #[schema(min_length = 1, max_length = 64)]
    pub class: Option<String>,
    /// The texts: two, or one for `information`; none for `describe`.
    #[schema(max_items = 2)]
    pub texts: Option<Vec<String>>,
    /// The level of `similarity` and `information`.
    #[schema(minimum = 1, maximum = 5)]
    pub level: Option<u8>,
    /// The text of `merge` and `describe`; empty where nothing could be made of a crop.
    #[schema(max_length = 4096)]
    pub text: Option<String>,
    /// The keyframe of the crop that was described.
    #[schema(min_length = 1, max_length = 128, pattern = r"^(\.{0,2}[A-Za-z0-9_:-]|\.{3})[A-Za-z0-9._:-]*$")]
    pub keyframe: Option<String>,
    /// The number of the detection in it, from 0.
    #[schema(minimum = 0, maximum = 499)]
    pub detection: Option<u16>,
    /// Whether a model described the crop, rather than a reader of characters.
    #[schema(default = true)]
    pub described: Option<bool>,
    /// Whether a reader stood in for the model: it is read again once a model is there.
    #[schema(default = false)]
    pub degraded: Option<bool>,
    /// Its source, such as `model:gpt-4o-mini`.
    #[schema(min_length = 1, max_length = 128)]
    pub source: String,
    /// Why, in one sentence for a person.
    #[schema(max_length = 4096)]
    pub reason: Option<String>,
}

/// The functions of §IV-A.2 (`similarity`, `information`, `merge`), and `describe`, the description of a crop (§IV-B).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = ModelOperation)]
#[expect(missing_docs, reason = "said above")]
pub enum ModelOperationName {
    Similarity,
    Information,
    Merge,
    #[default]
    Describe,
}

/// The effect of a verdict.
#[answer]
#[derive(Copy)]
pub struct ModelVerdictAnswer {
    /// The map's version after it.
    pub map_version: u64,
    /// Whether it changed the map: not where no anchor carries the texts, or the crop was read before.
    pub applied: bool,
}

const FIELDS: [&str; 11] = [
    "operation",
    "class",
    "texts",
    "level",
    "text",
    "keyframe",
    "detection",
    "described",
    "degraded",
    "reason",
    "source",
];

impl Decode for ModelOperationName {
    fn decode(node: &Node<'_>) -> Option<Self> {
        node.one_of([
            ("similarity", Self::Similarity),
            ("information", Self::Information),
            ("merge", Self::Merge),
            ("describe", Self::Describe),
        ])
    }
}

impl Decode for NewVerdict {
    fn decode(node: &Node<'_>) -> Option<Self> {
        let body = node.object(&FIELDS)?;
        let operation = body.required("operation", ModelOperationName::decode);
        let source = body.required("source", |node| node.name(limits::SOURCE_CHARS));
        let reason = body.optional("reason", |node| node.text(limits::TEXT_CHARS));
        match operation? {
            ModelOperationName::Describe => described(&body, source),
            of_texts => Some(Self::OfTexts(ModelVerdict {
                reason: reason?.unwrap_or_default().into(),
                fingerprint: "".into(),
                ..judged(&body, of_texts, source)?
            })),
        }
    }
}

fn described(body: &Object<'_>, source: Option<String>) -> Option<NewVerdict> {
    let keyframe = body.required("keyframe", read::id);
    let number = body.required("detection", |node| node.whole(limits::DETECTION));
    let text = body.required("text", |node| node.text(limits::TEXT_CHARS));
    let described = body.optional("described", read::switch);
    let degraded = body.optional("degraded", read::switch);
    Some(NewVerdict::OfCrop(
        NamedDetection { keyframe: keyframe?, number: u16::try_from(number?).ok()? },
        CropReading {
            text: text?.into(),
            source: source?.into(),
            described: described?.unwrap_or(true),
            degraded: degraded?.unwrap_or(false),
        },
    ))
}

/// Returns a verdict about texts, which are brought into normal form and order.
fn judged(body: &Object<'_>, operation: ModelOperationName, source: Option<String>) -> Option<ModelVerdict> {
    let count = if operation == ModelOperationName::Information { 1 } else { 2 };
    let class = body.required("class", |node| node.name(limits::CLASS_CHARS));
    let texts = body.required("texts", |node| {
        let texts = node.list(2, |node| node.text(limits::TEXT_CHARS))?;
        if texts.len() == count {
            Some(texts)
        } else {
            node.refuse("another number of texts is judged", count)
        }
    });
    let level = || {
        let level = body.required("level", |node| node.whole(limits::LEVEL))?;
        u8::try_from(level).ok()
    };
    let finding = match operation {
        ModelOperationName::Similarity => level().map(Finding::Similarity),
        ModelOperationName::Information => level().map(Finding::Information),
        _ => body
            .required("text", |node| node.text(limits::TEXT_CHARS))
            .map(|text| Finding::Merge(text.into())),
    };
    let mut texts: Vec<Box<str>> = texts?.iter().map(|text| Text::parse(text).normalised().into()).collect();
    texts.sort_unstable();
    let mut texts = texts.into_iter();
    Some(ModelVerdict {
        class: class?.into(),
        a: texts.next()?,
        b: texts.next().unwrap_or_default(),
        finding: finding?,
        source: source?.into(),
        reason: "".into(),
        fingerprint: "".into(),
    })
}

impl From<ModelVerdict> for ModelVerdictBody {
    fn from(verdict: ModelVerdict) -> Self {
        let ModelVerdict { class, a, b, finding, source, reason, fingerprint: _ } = verdict;
        let (operation, level, text) = match finding {
            Finding::Similarity(level) => (ModelOperationName::Similarity, Some(level), None),
            Finding::Information(level) => (ModelOperationName::Information, Some(level), None),
            Finding::Merge(text) => (ModelOperationName::Merge, None, Some(text.into())),
        };
        let b = Some(b).filter(|_| operation != ModelOperationName::Information);
        Self {
            operation,
            class: Some(class.into()),
            texts: Some([a].into_iter().chain(b).map(Into::into).collect()),
            level,
            text,
            source: source.to_string(),
            reason: Some(reason.into()).filter(|reason: &String| !reason.is_empty()),
            ..Self::default()
        }
    }
}

impl From<(NamedDetection, CropReading)> for ModelVerdictBody {
    fn from((detection, reading): (NamedDetection, CropReading)) -> Self {
        Self {
            operation: ModelOperationName::Describe,
            text: Some(reading.text.into()),
            keyframe: Some(detection.keyframe.to_string()),
            detection: Some(detection.number),
            described: (!reading.described).then_some(false),
            degraded: reading.degraded.then_some(true),
            source: reading.source.to_string(),
            ..Self::default()
        }
    }
}
