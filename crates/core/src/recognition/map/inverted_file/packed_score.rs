//! A score as an accumulator holds it, and the terms that add to it.

use crate::domain::bow::Score;

/// A word of the query that the map knows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Term {
    /// The word's slot.
    pub(super) slot: u32,
    /// Its weight in the query.
    pub(super) weight: u32,
}

/// Returns a score as an accumulator holds it: the sums of both halves are taken by one addition. Neither overflows:
/// the units of a whole vector sum to 2^31, and it has at most 65,535 words.
pub(super) fn pack(units: u32, common_words: u32) -> u64 {
    u64::from(units) << 32 | u64::from(common_words)
}

/// Returns the score that an accumulator holds.
pub(super) fn unpack(packed: u64) -> Score {
    Score::new((packed >> 32) as u32, packed as u32)
}
