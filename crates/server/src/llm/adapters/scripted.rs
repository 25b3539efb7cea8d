//! A scripted model: for tests, and to count the cost of another.

use std::fmt;

use futures_util::future::BoxFuture;
use serde_json::json;

use crate::domain::judgement::TextFunction;
use crate::llm::dialogue::summary;
use crate::llm::port::{Fault, Model, Question, Reply, Role};
use crate::llm::prompts::prompt;
use crate::semantics::{self, Text};

type Script = dyn Fn(&Question) -> Result<String, Fault> + Send + Sync;

/// A model that follows a script; its tokens are estimated from the real prompts.
pub struct Scripted {
    name: String,
    script: Box<Script>,
}

/// English text has about four characters per token.
const CHARS_PER_TOKEN: usize = 4;

/// A small image has a few hundred tokens in most vision models.
const TOKENS_PER_IMAGE: u64 = 300;

impl Scripted {
    /// Returns a model that answers by this script.
    pub fn new(
        name: impl Into<String>,
        script: impl Fn(&Question) -> Result<String, Fault> + Send + Sync + 'static,
    ) -> Self {
        Self { name: name.into(), script: Box::new(script) }
    }

    /// Returns a model that gives the built-in judge's verdicts and keeps asking questions: for counting calls and
    /// tokens. Of an image it says what the client read.
    pub fn rehearsal() -> Self {
        Self::new("scripted", |question| {
            Ok(match question {
                Question::Texts { function: TextFunction::Similarity, a, b, .. } => {
                    let judgement = semantics::similarity(&Text::parse(a), &Text::parse(b));
                    json!({"level": judgement.level, "reason": judgement.reason}).to_string()
                }
                Question::Texts { function: TextFunction::Information, a, .. } => {
                    let (level, reason) = semantics::information(&Text::parse(a));
                    json!({"level": level, "reason": reason}).to_string()
                }
                Question::Texts { function: TextFunction::Merge, a, b, .. } => {
                    json!({"text": semantics::merge(a, b)}).to_string()
                }
                Question::Look { hint, .. } => hint.clone().unwrap_or_else(|| "unknown".to_owned()),
                Question::NextQuestion { .. } => "What else is to be seen on it?".to_owned(),
                Question::Summary { history, .. } => summary(history),
                Question::Embed { .. } => return Err(Fault::Unable),
            })
        })
    }
}

impl Model for Scripted {
    fn name(&self) -> &str {
        &self.name
    }

    fn identity(&self) -> String {
        format!("scripted {}", self.name)
    }

    fn can(&self, role: Role) -> bool {
        role != Role::Embeddings
    }

    fn answer<'a>(&'a self, question: &'a Question) -> BoxFuture<'a, Result<Reply, Fault>> {
        Box::pin(async move {
            let content = (self.script)(question)?;
            let asked = prompt(question);
            let image = if question.role() == Role::Vision { TOKENS_PER_IMAGE } else { 0 };
            let sent = ((asked.rules.len() + asked.data.len()) / CHARS_PER_TOKEN) as u64;
            let output_tokens = Some((content.len() / CHARS_PER_TOKEN) as u64 + 1);
            Ok(Reply { content, input_tokens: Some(sent + image), output_tokens })
        })
    }
}

impl fmt::Debug for Scripted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Scripted({})", self.name)
    }
}
