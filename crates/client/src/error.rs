//! Error: a request that failed, said so that the person at the keyboard knows what to do.

use std::fmt;

use reqwest::StatusCode;
use revisit_core::domain::ids::IdError;
use serde::Deserialize;
use serde_json::Value;

use crate::tls::cause_of;

/// A body that is not problem+json is quoted up to this many characters.
const QUOTED_CHARACTERS: usize = 200;

/// The reason why an operation gave no answer.
#[derive(Debug, thiserror::Error)]
pub enum ClientError {
    /// The server's address cannot be read as one.
    #[error("{given:?} is not the address of a server: {why}")]
    Address {
        /// As given.
        given: String,
        /// Description of the fault.
        why: String,
    },
    /// An id that no URL can carry.
    #[error("{0:?} cannot be used as an id: a URL cannot carry it")]
    Id(String),
    /// An id that no server takes.
    #[error(transparent)]
    BadId(#[from] IdError),
    /// The server was not reached, or did not answer.
    #[error("{url}: {}", cause_of(.source))]
    Transport {
        /// The address that was asked.
        url: String,
        /// The failure.
        source: reqwest::Error,
    },
    /// Received bytes could not be written.
    #[error("cannot write: {0}")]
    Write(std::io::Error),
    /// The server answered, and refused.
    #[error(transparent)]
    Problem(#[from] Box<Problem>),
    /// A detection that is named as an anchor feeds none.
    #[error("detection {detection} of keyframe {keyframe} feeds no anchor")]
    NoAnchor {
        /// The keyframe.
        keyframe: String,
        /// The number of the detection in it, from 0.
        detection: usize,
    },
    /// The server answered something else than the API document promises.
    #[error("the answer of {url} is not understood: {source}")]
    Decode {
        /// The address that was asked.
        url: String,
        /// The place in the answer, and the value expected there.
        source: serde_path_to_error::Error<serde_json::Error>,
    },
}

impl ClientError {
    pub(super) fn transport(url: &str, source: reqwest::Error) -> Self {
        Self::Transport { url: url.to_owned(), source: source.without_url() }
    }

    /// Returns what the server refused, if it was the server.
    pub fn problem(&self) -> Option<&Problem> {
        match self {
            Self::Problem(problem) => Some(problem),
            _ => None,
        }
    }
}

/// An answer of 400 or above, as `application/problem+json` says it.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct Problem {
    /// HTTP status.
    #[serde(skip)]
    pub status: u16,
    /// The address that was asked.
    #[serde(skip)]
    pub url: String,
    /// The kind of problem in a few words.
    pub title: String,
    /// This occurrence of it.
    pub detail: Option<String>,
    /// A word for programs.
    pub code: Option<String>,
    /// The request's id in the server's log.
    pub request_id: Option<String>,
    /// Every fault of the body at once.
    pub errors: Vec<FieldProblem>,
}

/// One fault of a body.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct FieldProblem {
    /// JSON pointer to the place.
    pub pointer: String,
    /// Description of the fault.
    pub detail: String,
    /// The value that was sent.
    pub got: Option<Value>,
    /// The values that are allowed.
    pub limit: Option<Value>,
}

impl Problem {
    /// Reads a refusal; a proxy's own page becomes a problem as well.
    pub(super) fn read(status: StatusCode, url: &str, body: &[u8]) -> Self {
        let mut problem: Self =
            serde_json::from_slice(body).unwrap_or_else(|_| Self { detail: quoted(body), ..Self::default() });
        if problem.title.is_empty() {
            let reason = status.canonical_reason().unwrap_or("refused");
            reason.clone_into(&mut problem.title);
        }
        problem.status = status.as_u16();
        url.clone_into(&mut problem.url);
        problem
    }
}

fn quoted(body: &[u8]) -> Option<String> {
    let text = String::from_utf8_lossy(body);
    let text: Vec<&str> = text.split_whitespace().collect();
    let text: String = text.join(" ").chars().take(QUOTED_CHARACTERS).collect();
    (!text.is_empty()).then_some(text)
}

impl std::error::Error for Problem {}

/// One line for the problem, and one indented line for each fault of the body.
impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.status, self.title)?;
        if let Some(detail) = &self.detail {
            write!(f, ": {detail}")?;
        }
        write!(f, " ({}", self.url)?;
        if let Some(request_id) = &self.request_id {
            write!(f, ", request {request_id}")?;
        }
        f.write_str(")")?;
        self.errors.iter().try_for_each(|error| {
            f.write_str("\n  ")?;
            error.fmt(f)
        })
    }
}

/// Returns a text without its quotes, anything else as JSON.
fn plain(value: &Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), str::to_owned)
}

impl fmt::Display for FieldProblem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let place = if self.pointer.is_empty() { "/" } else { &self.pointer };
        write!(f, "{place}: {}", self.detail)?;
        match (self.got.as_ref().map(plain), self.limit.as_ref().map(plain)) {
            (Some(got), Some(limit)) => write!(f, " (got {got}, limit {limit})"),
            (Some(got), None) => write!(f, " (got {got})"),
            (None, Some(limit)) => write!(f, " (limit {limit})"),
            (None, None) => Ok(()),
        }
    }
}
