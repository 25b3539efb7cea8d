//! InformationLevel, SimilarityLevel and MergeText (§IV-A.2): the built-in judge first, a model for open questions,
//! and identifiers with precedence over both.

use std::time::Duration;

use super::daily_limits::Payer;
use super::gateway::Gateway;
use super::parse;
use super::port::{Fault, Question};
use crate::semantics::{self, Route, Text};

/// The name of the built-in judge.
pub const BUILT_IN: &str = "lexical";

/// The level from which two texts describe one object; such an answer is asked again in reverse order.
const SAME_OBJECT: u8 = 4;

/// Maximum InformationLevel of a text that addresses a model: enough for an anchor, whatever the text demands.
const FLAGGED_LEVEL_MAX: u8 = 4;

/// A level, its source and its reason.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Judged {
    /// 1 to 5.
    pub level: u8,
    /// `identical`, `identifiers`, `lexical` or `model:<name>`.
    pub source: String,
    /// One sentence for a person.
    pub reason: String,
    /// Whether a model's answer was cached.
    pub cached: bool,
    /// Whether the built-in judge substituted for an unavailable model.
    pub degraded: bool,
}

/// Two descriptions merged into one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Merged {
    /// The description.
    pub text: String,
    /// `lexical` or `model:<name>`.
    pub source: String,
    /// Whether a model's answer was cached.
    pub cached: bool,
    /// Whether the built-in judge substituted for an unavailable model.
    pub degraded: bool,
}

/// The three functions of §IV-A.2.
#[derive(Clone, Debug, Default)]
pub struct Judge {
    model: Option<Gateway>,
}

impl Judge {
    /// Creates a judge that consults this model on open questions; without one, the built-in judge alone.
    pub fn new(model: Option<Gateway>) -> Self {
        Self { model }
    }

    /// Returns a copy whose calls are charged to this payer.
    pub fn paid_by(&self, payer: Option<Payer>) -> Self {
        Self { model: self.model.as_ref().map(|model| model.paid_by(payer)) }
    }

    /// Returns the model to judge by.
    pub(super) fn model(&self) -> Option<&Gateway> {
        self.model.as_ref()
    }

    /// Whether there is a model to judge by.
    pub fn has_model(&self) -> bool {
        self.model.is_some()
    }

    /// Computes SimilarityLevel. Symmetric: the pair is asked in one order.
    pub async fn similarity(&self, class: &str, a: &str, b: &str, patience: Option<Duration>) -> Judged {
        let (of_a, of_b) = (Text::parse(a), Text::parse(b));
        let route = semantics::route_similarity(&of_a, &of_b);
        let built_in = judged(route.judgement());
        let (Route::Open(_), Some(model)) = (&route, &self.model) else { return built_in };
        if let Some(hostile) = not_sent(&built_in, &[a, b]) {
            return hostile;
        }
        let (low, high) =
            (of_a.normalised().min(of_b.normalised()), of_a.normalised().max(of_b.normalised()));
        match within(patience, ask_similarity(model, &class_name(class), low, high)).await {
            Ok((level, reason, cached)) => Judged {
                level: semantics::bound_similarity(&of_a, &of_b, level),
                source: model.source().to_string(),
                reason: reason.unwrap_or_else(|| "the model gave no reason".to_owned()),
                cached,
                degraded: false,
            },
            Err(_) => Judged { degraded: true, ..built_in },
        }
    }

    /// Computes InformationLevel.
    pub async fn information(&self, class: &str, text: &str, patience: Option<Duration>) -> Judged {
        let parsed = Text::parse(text);
        let (level, reason) = semantics::information(&parsed);
        let built_in = Judged { level, source: BUILT_IN.to_owned(), reason, cached: false, degraded: false };
        let Some(model) = self.model.as_ref().filter(|_| semantics::information_is_open(&parsed)) else {
            return built_in;
        };
        // A sign that addresses a model is still rated, because its own level raises no pair.
        let most = if semantics::addresses_a_model(text) { FLAGGED_LEVEL_MAX } else { 5 };
        let question =
            Question::Information { class: class_name(class), text: parsed.normalised().to_owned() };
        match within(patience, ask_level(model, question)).await {
            Ok((level, reason, cached)) => Judged {
                level: level.min(most),
                source: model.source().to_string(),
                reason: reason.unwrap_or_else(|| "the model gave no reason".to_owned()),
                cached,
                degraded: false,
            },
            Err(_) => Judged { degraded: true, ..built_in },
        }
    }

    /// Computes MergeText. A model's text is accepted only if it has the identifiers of both, no others, and no new
    /// digits.
    pub async fn merge(&self, class: &str, a: &str, b: &str, patience: Option<Duration>) -> Merged {
        let text = semantics::merge(a, b);
        let built_in = Merged { source: BUILT_IN.to_owned(), cached: false, degraded: false, text };
        let one_says_all = built_in.text == a || built_in.text == b;
        let hostile = [a, b].into_iter().any(semantics::addresses_a_model);
        let excluded = semantics::conflict(&Text::parse(a), &Text::parse(b)).is_some();
        let Some(model) = self.model.as_ref().filter(|_| !one_says_all && !hostile && !excluded) else {
            return built_in;
        };
        let (clean_a, clean_b) = (semantics::clean(a), semantics::clean(b));
        let in_order = Text::parse(a).normalised() <= Text::parse(b).normalised();
        let (low, high) = if in_order { (clean_a, clean_b) } else { (clean_b, clean_a) };
        let question = Question::Merge { class: class_name(class), a: low, b: high };
        let asked = within(patience, async {
            let answered = model.ask(question).await?;
            Ok((parse::text(&answered.content)?, answered.cached))
        });
        match asked.await {
            Ok((text, cached)) if semantics::accepts_merge(a, b, &text) => {
                Merged { text, source: model.source().to_string(), cached, degraded: false }
            }
            Ok(_) => built_in,
            Err(_) => Merged { degraded: true, ..built_in },
        }
    }
}

/// Asks a pair in canonical order. A 4 is asked again in reverse order, and the lower level counts.
async fn ask_similarity(
    model: &Gateway,
    class: &str,
    low: &str,
    high: &str,
) -> Result<(u8, Option<String>, bool), Fault> {
    let question =
        |a: &str, b: &str| Question::Similarity { class: class.to_owned(), a: a.to_owned(), b: b.to_owned() };
    let first = ask_level(model, question(low, high)).await?;
    if first.0 != SAME_OBJECT {
        return Ok(first);
    }
    let second = ask_level(model, question(high, low)).await?;
    let cached = first.2 && second.2;
    let (level, reason, _) = if second.0 < first.0 { second } else { first };
    Ok((level, reason, cached))
}

async fn ask_level(model: &Gateway, question: Question) -> Result<(u8, Option<String>, bool), Fault> {
    let answered = model.ask(question).await?;
    let (level, reason) = parse::level(&answered.content)?;
    Ok((level, reason, answered.cached))
}

/// Limits the time that the caller waits; the question continues without it.
async fn within<T>(
    patience: Option<Duration>,
    asked: impl Future<Output = Result<T, Fault>>,
) -> Result<T, Fault> {
    match patience {
        None => asked.await,
        Some(patience) => {
            tokio::time::timeout(patience, asked).await.unwrap_or(Err(Fault::TimedOut(patience)))
        }
    }
}

/// Returns the built-in verdict if a text addresses the model, so that it is not sent.
fn not_sent(built_in: &Judged, texts: &[&str]) -> Option<Judged> {
    texts.iter().any(|text| semantics::addresses_a_model(text)).then(|| Judged {
        reason: format!("{}; no model was asked, for a text addresses it", built_in.reason),
        ..built_in.clone()
    })
}

/// Cleans a class, which is client input as well.
pub fn class_name(class: &str) -> String {
    let name = semantics::clean(class);
    if name.is_empty() || semantics::addresses_a_model(&name) { "object".to_owned() } else { name }
}

fn judged(judgement: &semantics::Judgement) -> Judged {
    Judged {
        level: judgement.level,
        source: judgement.source.as_str().to_owned(),
        reason: judgement.reason.clone(),
        cached: false,
        degraded: false,
    }
}
