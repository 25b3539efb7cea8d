//! The built-in judge as a model: its verdicts about texts, and for an image the text that the client read.

use futures_util::future::BoxFuture;
use serde_json::json;

use crate::llm::dialogue::summary;
use crate::llm::port::{Fault, Model, Question, Reply};
use crate::semantics::{self, Text};

/// A model that is free and always available.
#[derive(Clone, Copy, Debug, Default)]
pub struct BuiltIn;

impl BuiltIn {
    fn say(question: &Question) -> Result<String, Fault> {
        Ok(match question {
            Question::Similarity { a, b, .. } => {
                let judgement = semantics::similarity(&Text::parse(a), &Text::parse(b));
                json!({"level": judgement.level, "reason": judgement.reason}).to_string()
            }
            Question::Information { text, .. } => {
                let (level, reason) = semantics::information(&Text::parse(text));
                json!({"level": level, "reason": reason}).to_string()
            }
            Question::Merge { a, b, .. } => json!({"text": semantics::merge(a, b)}).to_string(),
            Question::Look { hint, .. } => hint.clone().unwrap_or_else(|| "unknown".to_owned()),
            Question::NextQuestion { .. } | Question::Embed { .. } => return Err(Fault::Unable),
            Question::Summary { history, .. } => summary(history),
        })
    }
}

impl Model for BuiltIn {
    fn name(&self) -> &'static str {
        "built-in"
    }

    fn identity(&self) -> String {
        format!("built-in {}", env!("CARGO_PKG_VERSION"))
    }

    fn can(&self, question: &Question) -> bool {
        !matches!(question, Question::NextQuestion { .. } | Question::Embed { .. })
    }

    fn answer<'a>(&'a self, question: &'a Question) -> BoxFuture<'a, Result<Reply, Fault>> {
        Box::pin(async move {
            let content = Self::say(question)?;
            Ok(Reply { content, input_tokens: Some(0), output_tokens: Some(0) })
        })
    }
}
