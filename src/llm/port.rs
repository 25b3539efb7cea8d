//! The port: what a model can be asked, what it answers, and what can go wrong.

use std::sync::Arc;
use std::time::Duration;

use futures_util::future::BoxFuture;
use thiserror::Error;

use super::picture::Picture;

/// What is asked for; the key of usage and metrics.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Operation {
    /// SimilarityLevel.
    Similarity,
    /// InformationLevel.
    Information,
    /// MergeText.
    Merge,
    /// A question about an image, or about the dialogue around it.
    Describe,
    /// An embedding of a text.
    Embed,
}

impl Operation {
    /// Returns the operation's name in the API document.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Similarity => "similarity",
            Self::Information => "information",
            Self::Merge => "merge",
            Self::Describe => "describe",
            Self::Embed => "embed",
        }
    }
}

/// One round of a dialogue about an image.
#[derive(Clone, Debug, PartialEq, Eq, Hash, serde::Serialize)]
pub struct Round {
    /// What was asked.
    pub question: String,
    /// What was answered.
    pub answer: String,
}

/// A question to a model. Texts are clean: control, bidi and zero-width characters are gone. None addresses a model, but
/// for the one text of [`Question::Information`], whose level raises no pair, and that of [`Question::Embed`], which
/// is not obeyed but measured.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Question {
    /// Whether two descriptions mean the same physical object.
    Similarity {
        /// The objects' class.
        class: String,
        /// One description.
        a: String,
        /// The other description.
        b: String,
    },
    /// How much does a description tell?
    Information {
        /// The object's class.
        class: String,
        /// The description.
        text: String,
    },
    /// One description out of two.
    Merge {
        /// The objects' class.
        class: String,
        /// One description.
        a: String,
        /// The other description.
        b: String,
    },
    /// What is to be seen on this image?
    Look {
        /// The image.
        picture: Arc<Picture>,
        /// What to tell about it.
        question: String,
        /// What was asked before.
        history: Vec<Round>,
        /// What a reader of characters made of it.
        hint: Option<String>,
    },
    /// What to ask next about an image that only the other side sees?
    NextQuestion {
        /// The object's class.
        class: String,
        /// What was asked before.
        history: Vec<Round>,
    },
    /// What does the dialogue tell of the object?
    Summary {
        /// The object's class.
        class: String,
        /// What was asked.
        history: Vec<Round>,
    },
    /// The embedding of a text.
    Embed {
        /// The text.
        text: String,
    },
}

impl Question {
    /// Returns what is asked for.
    pub fn operation(&self) -> Operation {
        match self {
            Self::Similarity { .. } => Operation::Similarity,
            Self::Information { .. } => Operation::Information,
            Self::Merge { .. } => Operation::Merge,
            Self::Look { .. } | Self::NextQuestion { .. } | Self::Summary { .. } => Operation::Describe,
            Self::Embed { .. } => Operation::Embed,
        }
    }

    /// Whether the model must see.
    pub fn needs_eyes(&self) -> bool {
        matches!(self, Self::Look { .. })
    }
}

/// What a model answered, as it came, and what it took.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Reply {
    /// The answer.
    pub content: String,
    /// Tokens sent; `None` if the model does not tell.
    pub input_tokens: Option<u64>,
    /// Tokens received; `None` if the model does not tell.
    pub output_tokens: Option<u64>,
}

/// Why there is no answer. The texts name neither keys nor what a server wrote: it may have echoed one.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum Fault {
    /// No connection, or one that broke.
    #[error("the model cannot be reached: {0}")]
    Unreachable(String),
    /// No answer in time.
    #[error("the model did not answer within {} s", .0.as_secs_f32())]
    TimedOut(Duration),
    /// Too many questions.
    #[error("the model has too many questions")]
    Limited {
        /// When it wants the next one, if it says.
        retry_after: Option<Duration>,
    },
    /// A failure of the server.
    #[error("the model's server failed with status {0}")]
    Failing(u16),
    /// The server does not accept the question: a wrong key, a wrong name, a parameter it does not know.
    #[error("the model's server refused with status {0}")]
    Refused(u16),
    /// An answer that is none.
    #[error("the model's answer is unusable: {0}")]
    Garbled(&'static str),
    /// This model is not made for the question.
    #[error("this model cannot answer such a question")]
    Unable,
    /// The model failed too often, and is left alone for a while.
    #[error("the model is away; it is asked again later")]
    Away,
    /// What may be spent today is spent.
    #[error("the daily budget is spent")]
    Spent,
    /// A job panicked (a bug); it is tried again like any other that failed.
    #[error("the job broke off")]
    Broken,
    /// What must be kept could not be.
    #[error("the answer could not be kept: {0}")]
    Store(String),
}

impl Fault {
    /// Whether the very same question may be answered a moment later.
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

    /// Whether the server refuses this question, such as one that is too long for it, and may take others.
    pub fn is_about_the_question(&self) -> bool {
        matches!(self, Self::Refused(400 | 413 | 422))
    }

    /// Returns a short name, for the metrics.
    pub fn code(&self) -> &'static str {
        match self {
            Self::Unreachable(_) => "unreachable",
            Self::TimedOut(_) => "timeout",
            Self::Limited { .. } => "rate_limited",
            Self::Failing(_) => "server_error",
            Self::Refused(_) => "refused",
            Self::Garbled(_) => "unusable",
            Self::Unable => "unable",
            Self::Away => "away",
            Self::Spent => "budget",
            Self::Broken => "broken",
            Self::Store(_) => "store",
        }
    }
}

/// A model.
pub trait Model: Send + Sync + std::fmt::Debug {
    /// Its name, for people: the `<name>` of `model:<name>`.
    fn name(&self) -> &str;

    /// Returns all that its answers depend on besides the question: its address, its name, its parameters. Another
    /// identity means other keys in the cache.
    fn identity(&self) -> String;

    /// Whether it can answer this kind of question.
    fn can(&self, question: &Question) -> bool;

    /// Answers a question, once.
    fn answer<'a>(&'a self, question: &'a Question) -> BoxFuture<'a, Result<Reply, Fault>>;
}
