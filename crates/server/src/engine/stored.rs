//! The result of a write that may be repeated.

/// A write's result, and whether it was made now or had been before.
#[derive(Clone, Debug, PartialEq)]
pub struct Stored<T> {
    /// False if the identical request was answered before.
    pub created: bool,
    /// The result.
    pub value: T,
}
