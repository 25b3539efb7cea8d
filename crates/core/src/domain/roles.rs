//! The roles of models that a server has configured.

/// The roles that a model fills where a question is answered: a verdict depends on them, so they are part of its id.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Roles {
    /// Whether crops are read, by a vision model or by a reader of characters.
    pub vision: bool,
    /// Whether texts are judged by a language model.
    pub text: bool,
}

impl Roles {
    /// Whether no role is filled.
    pub fn is_none(self) -> bool {
        self == Self::default()
    }
}
