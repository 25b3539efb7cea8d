//! A scripted model: for tests, and to count the cost of another.

use std::fmt;
use std::sync::Arc;

use futures_util::future::BoxFuture;

use super::built_in::BuiltIn;
use crate::llm::port::{Fault, Model, Question, Reply};
use crate::llm::prompts::prompt;

type Script = dyn Fn(&Question) -> Result<String, Fault> + Send + Sync;

/// A model that follows a script; its tokens are estimated from the real prompts.
pub struct Scripted {
    name: String,
    script: Option<Arc<Script>>,
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
        Self { name: name.into(), script: Some(Arc::new(script)) }
    }

    /// Returns a model that gives the built-in judge's verdicts and keeps asking questions: for counting calls and
    /// tokens.
    pub fn rehearsal() -> Self {
        Self { name: "scripted".to_owned(), script: None }
    }
}

impl Model for Scripted {
    fn name(&self) -> &str {
        &self.name
    }

    fn identity(&self) -> String {
        format!("scripted {}", self.name)
    }

    fn can(&self, question: &Question) -> bool {
        !matches!(question, Question::Embed { .. })
    }

    fn answer<'a>(&'a self, question: &'a Question) -> BoxFuture<'a, Result<Reply, Fault>> {
        Box::pin(async move {
            let content = match (&self.script, question) {
                (Some(script), question) => script(question)?,
                (None, Question::NextQuestion { .. }) => "What else is to be seen on it?".to_owned(),
                (None, question) => BuiltIn.answer(question).await?.content,
            };
            let asked = prompt(question);
            let image = if question.needs_eyes() { TOKENS_PER_IMAGE } else { 0 };
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
