//! What is wrong with a request's body: one entry for each field, all of them at once.

/// One offending field.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FieldError {
    /// JSON pointer into the body, such as `/detections/0/box`.
    pub pointer: String,
    /// Description of the fault, for a person.
    pub detail: String,
    /// The value that was sent, shortened.
    pub got: Option<String>,
    /// The values that are allowed.
    pub limit: Option<String>,
}

impl FieldError {
    /// Returns an error with neither `got` nor `limit`.
    pub fn new(pointer: impl Into<String>, detail: impl Into<String>) -> Self {
        Self { pointer: pointer.into(), detail: detail.into(), got: None, limit: None }
    }

    /// Returns the same error, telling what was sent.
    pub fn got(mut self, got: impl ToString) -> Self {
        let mut text = got.to_string();
        if let Some((cut, _)) = text.char_indices().nth(80) {
            text.truncate(cut);
            text.push('…');
        }
        self.got = Some(text);
        self
    }

    /// Returns the same error, telling what would have been allowed.
    pub fn limit(mut self, limit: impl ToString) -> Self {
        self.limit = Some(limit.to_string());
        self
    }
}
