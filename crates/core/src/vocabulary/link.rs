//! A link: the children of a node, or its word.

/// Children or word of a node, in one read: the descent meets them far apart in memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Link(u64);

impl Link {
    /// Returns a node with `count` children, side by side from `first`.
    pub fn children(first: u32, count: u32) -> Self {
        Self(u64::from(count) << 32 | u64::from(first))
    }

    /// Returns a leaf.
    pub fn word(word: u32) -> Self {
        Self(u64::from(word))
    }

    /// Returns the number of children; 0 for a leaf.
    pub fn count(self) -> u32 {
        (self.0 >> 32) as u32
    }

    /// Returns the first child; for a leaf its word.
    pub fn target(self) -> u32 {
        self.0 as u32
    }

    /// As stored.
    pub fn bits(self) -> u64 {
        self.0
    }

    /// From storage; [`super::tree::Tree`] or a check of the file vouches for it.
    pub fn from_bits(bits: u64) -> Self {
        Self(bits)
    }
}
