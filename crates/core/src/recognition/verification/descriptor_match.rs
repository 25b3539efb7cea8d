//! A match of two descriptors.

/// Two features that match.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Match {
    /// The feature of the query.
    pub query: u32,
    /// The feature of the candidate.
    pub candidate: u32,
    /// The number of bits they differ in.
    pub distance: u32,
}
