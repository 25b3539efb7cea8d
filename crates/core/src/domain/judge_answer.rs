//! Answers of the judge to one of its three functions (§IV-A.2): a level or a text, with its source.

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

impl Judged {
    /// Returns a level of the built-in judge.
    pub fn built_in(level: u8, source: &str, reason: String) -> Self {
        Self { level, source: source.to_owned(), reason, cached: false, degraded: false }
    }
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
