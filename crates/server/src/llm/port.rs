//! The port: questions to a model, its answers, and its errors.

use std::sync::Arc;
use std::time::Duration;

use futures_util::future::BoxFuture;
use thiserror::Error;

use super::picture::Picture;
use crate::domain::judgement::TextFunction;
use crate::store::StoreError;

/// The role of the model that answers a question. Each has its own timeout and price.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// It answers about texts.
    Text,
    /// It looks at images.
    Vision,
    /// It embeds texts.
    Embeddings,
}

/// One round of a dialogue about an image.
#[derive(Clone, Debug, PartialEq, Eq, Hash, serde::Serialize)]
pub struct Round {
    /// The question.
    pub question: String,
    /// The answer.
    pub answer: String,
}

/// A question to a model. Texts are clean: without control, bidi and zero-width characters. None addresses a model,
/// with two exceptions. The text of [`TextFunction::Information`] may, because its level raises no pair. That of
/// [`Question::Embed`] may, because it is measured and not followed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Question {
    /// A function of §IV-A.2.
    Texts {
        /// The function.
        function: TextFunction,
        /// The objects' class.
        class: String,
        /// The only description, or the first of two.
        a: String,
        /// The second description; empty for one.
        b: String,
    },
    /// Describes an image.
    Look {
        /// The image.
        picture: Arc<Picture>,
        /// The aspect to describe.
        question: String,
        /// The dialogue before.
        history: Vec<Round>,
        /// The OCR reading.
        hint: Option<String>,
    },
    /// Requests the next question about an image that only the other model sees.
    NextQuestion {
        /// The object's class.
        class: String,
        /// The dialogue before.
        history: Vec<Round>,
    },
    /// Summarises the dialogue about the object.
    Summary {
        /// The object's class.
        class: String,
        /// The dialogue.
        history: Vec<Round>,
    },
    /// The embedding of a text.
    Embed {
        /// The text.
        text: String,
    },
}

impl Question {
    /// Returns the name of the operation, by which usage is counted.
    pub fn operation(&self) -> &'static str {
        match self {
            Self::Texts { function, .. } => function.as_str(),
            Self::Look { .. } | Self::NextQuestion { .. } | Self::Summary { .. } => "describe",
            Self::Embed { .. } => "embed",
        }
    }

    /// Returns the role of the model that answers it.
    pub fn role(&self) -> Role {
        match self {
            Self::Look { .. } => Role::Vision,
            Self::Embed { .. } => Role::Embeddings,
            Self::Texts { .. } | Self::NextQuestion { .. } | Self::Summary { .. } => Role::Text,
        }
    }
}

/// A model's raw answer, and its usage.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Reply {
    /// The answer.
    pub content: String,
    /// Input tokens; `None` if the model does not report them.
    pub input_tokens: Option<u64>,
    /// Output tokens; `None` if the model does not report them.
    pub output_tokens: Option<u64>,
}

/// The reason for a missing answer. The texts contain neither keys nor a server's text, which may echo one.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum Fault {
    /// No connection, or one that failed.
    #[error("the model cannot be reached: {0}")]
    Unreachable(String),
    /// Timeout.
    #[error("the model did not answer within {} s", .0.as_secs_f32())]
    TimedOut(Duration),
    /// Too many questions.
    #[error("the model has too many questions")]
    Limited {
        /// The requested delay, if any.
        retry_after: Option<Duration>,
    },
    /// A failure of the server.
    #[error("the model's server failed with status {0}")]
    Failing(u16),
    /// The server rejects the question: a wrong key, a wrong name, an unknown parameter.
    #[error("the model's server refused with status {0}")]
    Refused(u16),
    /// An invalid answer.
    #[error("the model's answer is unusable: {0}")]
    Garbled(&'static str),
    /// This model does not support the question.
    #[error("this model cannot answer such a question")]
    Unable,
    /// The model failed too often and is not called for a while.
    #[error("the model is away; it is asked again later")]
    Away,
    /// The daily budget is spent.
    #[error("the daily budget is spent")]
    Spent,
    /// A job panicked (a bug); it is retried like any failed job.
    #[error("the job broke off")]
    Broken,
    /// The answer could not be stored.
    #[error("the answer could not be kept: {0}")]
    Store(String),
}

impl From<StoreError> for Fault {
    fn from(error: StoreError) -> Self {
        Self::Store(error.to_string())
    }
}

impl Fault {
    /// Whether the same question may be answered a moment later.
    pub fn is_passing(&self) -> bool {
        matches!(
            self,
            Self::Unreachable(_)
                | Self::TimedOut(_)
                | Self::Limited { .. }
                | Self::Failing(_)
                | Self::Garbled(_)
        )
    }

    /// Whether the server rejects only this question, for example because it is too long.
    pub fn is_about_the_question(&self) -> bool {
        matches!(self, Self::Refused(400 | 413 | 422))
    }
}

/// A model.
pub trait Model: Send + Sync + std::fmt::Debug {
    /// Returns its name, for people: the `<name>` of `model:<name>`.
    fn name(&self) -> &str;

    /// Returns all inputs of its answers beside the question: its address, name and parameters. Another identity means
    /// other keys in the cache.
    fn identity(&self) -> String;

    /// Whether it can answer the questions of a role.
    fn can(&self, role: Role) -> bool;

    /// Answers a question once.
    fn answer<'a>(&'a self, question: &'a Question) -> BoxFuture<'a, Result<Reply, Fault>>;
}
