//! InformationLevel, SimilarityLevel and MergeText (§IV-A.2): the built-in judge first, a model for open questions,
//! and identifiers with precedence over both.

use std::time::Duration;

use super::gateway::Gateway;
use super::parse;
use super::port::{Fault, Question};
use crate::domain::judge_answer::{Judged, Merged};
use crate::domain::judgement::TextFunction;
use crate::semantics::{self, Route, Text};
use crate::store::DayLimit;

/// The name of the built-in judge.
pub const BUILT_IN: &str = "lexical";

/// The level from which two texts describe one object; such an answer is asked again in reverse order.
const SAME_OBJECT: u8 = 4;

/// Maximum InformationLevel of a text that addresses a model: enough for an anchor, whatever the text demands.
const FLAGGED_LEVEL_MAX: u8 = 4;

/// The three functions of §IV-A.2.
#[derive(Clone, Debug, Default)]
pub struct Judge {
    /// The model to consult on open questions; without one, the built-in judge alone.
    pub(crate) model: Option<Gateway>,
    /// Maximum time that an answer waits for the model; unlimited without one.
    pub(crate) patience: Option<Duration>,
}

impl Judge {
    /// Returns a copy whose calls are charged to this payer.
    pub fn paid_by(&self, payer: Option<DayLimit>) -> Self {
        Self { model: self.model.as_ref().map(|model| model.paid_by(payer)), patience: self.patience }
    }

    /// Computes SimilarityLevel. Symmetric: the pair is asked in one order.
    pub async fn similarity(&self, class: &str, a: &str, b: &str) -> Judged {
        let (of_a, of_b) = (Text::parse(a), Text::parse(b));
        let route = semantics::route_similarity(&of_a, &of_b);
        let judgement = route.judgement();
        let built_in = Judged::built_in(judgement.level, judgement.source.as_str(), judgement.reason.clone());
        let (Route::Open(_), Some(model)) = (&route, &self.model) else { return built_in };
        if [a, b].into_iter().any(semantics::addresses_a_model) {
            let reason = format!("{}; no model was asked, for a text addresses it", built_in.reason);
            return Judged { reason, ..built_in };
        }
        let (low, high) =
            (of_a.normalised().min(of_b.normalised()), of_a.normalised().max(of_b.normalised()));
        match self.wait_for(ask_similarity(model, class, low, high)).await {
            Ok(told) => Judged { level: semantics::bound_similarity(&of_a, &of_b, told.level), ..told },
            Err(_) => Judged { degraded: true, ..built_in },
        }
    }

    /// Computes InformationLevel.
    pub async fn information(&self, class: &str, text: &str) -> Judged {
        let parsed = Text::parse(text);
        let (level, reason) = semantics::information(&parsed);
        let built_in = Judged::built_in(level, BUILT_IN, reason);
        let Some(model) = self.model.as_ref().filter(|_| semantics::information_is_open(&parsed)) else {
            return built_in;
        };
        // A sign that addresses a model is still rated, because its own level raises no pair.
        let most = if semantics::addresses_a_model(text) { FLAGGED_LEVEL_MAX } else { 5 };
        let question = question(TextFunction::Information, class, parsed.normalised(), "");
        match self.wait_for(ask_level(model, question)).await {
            Ok(told) => Judged { level: told.level.min(most), ..told },
            Err(_) => Judged { degraded: true, ..built_in },
        }
    }

    /// Computes MergeText. A model's text is accepted only if it has the identifiers of both, no others, and no new
    /// digits.
    pub async fn merge(&self, class: &str, a: &str, b: &str) -> Merged {
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
        let question = question(TextFunction::Merge, class, &low, &high);
        let asked = self.wait_for(async {
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

    /// Limits the time that the caller waits; the question continues without it.
    async fn wait_for<T>(&self, asked: impl Future<Output = Result<T, Fault>>) -> Result<T, Fault> {
        let patience = self.patience.unwrap_or(Duration::MAX);
        tokio::time::timeout(patience, asked).await.unwrap_or(Err(Fault::TimedOut(patience)))
    }
}

/// Asks a pair in canonical order. A 4 is asked again in reverse order, and the lower level counts.
async fn ask_similarity(model: &Gateway, class: &str, low: &str, high: &str) -> Result<Judged, Fault> {
    let first = ask_level(model, question(TextFunction::Similarity, class, low, high)).await?;
    if first.level != SAME_OBJECT {
        return Ok(first);
    }
    let second = ask_level(model, question(TextFunction::Similarity, class, high, low)).await?;
    let cached = first.cached && second.cached;
    let lower = if second.level < first.level { second } else { first };
    Ok(Judged { cached, ..lower })
}

async fn ask_level(model: &Gateway, question: Question) -> Result<Judged, Fault> {
    let answered = model.ask(question).await?;
    let (level, reason) = parse::level(&answered.content)?;
    let reason = reason.unwrap_or_else(|| "the model gave no reason".to_owned());
    let (source, cached) = (model.source().to_string(), answered.cached);
    Ok(Judged { level, source, reason, cached, degraded: false })
}

fn question(function: TextFunction, class: &str, a: &str, b: &str) -> Question {
    Question::Texts { function, class: class_name(class), a: a.to_owned(), b: b.to_owned() }
}

/// Cleans a class, which is client input as well.
pub fn class_name(class: &str) -> String {
    let name = semantics::clean(class);
    if name.is_empty() || semantics::addresses_a_model(&name) { "object".to_owned() } else { name }
}
