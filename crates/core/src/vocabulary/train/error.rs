//! Reasons why descriptors make no vocabulary.

use crate::vocabulary::tree_fault::TreeFault;

/// Why there is no vocabulary.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum TrainError {
    /// No descriptors at all.
    #[error("there are no descriptors to train on")]
    NoDescriptors,
    /// A tree that is none.
    #[error("k must be at least 2, it is {0}")]
    Branching(u32),
    /// Descriptors of another length than those before.
    #[error("descriptors of {got} bytes, where those before have {expected}")]
    MixedDescriptors {
        /// Bytes of these.
        got: usize,
        /// Bytes of those before.
        expected: usize,
    },
    /// A length that no descriptor has, or bytes that are not whole descriptors.
    #[error("{bytes} bytes are not whole descriptors of {each} bytes, a multiple of 8 up to 512")]
    Length {
        /// Number of bytes given.
        bytes: usize,
        /// Bytes of a descriptor.
        each: usize,
    },
    /// k or L out of bounds, or a tree too large.
    #[error(transparent)]
    Tree(#[from] TreeFault),
    /// More descriptors than can be numbered.
    #[error("more than {} descriptors", u32::MAX)]
    TooMany,
}
