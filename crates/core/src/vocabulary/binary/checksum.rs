//! The checksum: tells a damaged file, at the speed of reading it; SHA-256 would take longer than all the rest.

/// An odd multiplier with well spread bits: 2^64 divided by the golden ratio.
const MULTIPLIER: u64 = 0x9e37_79b9_7f4a_7c15;

/// A checksum in four lanes, which the processor multiplies side by side.
///
/// Each step is a bijection of its lane: one wrong word always shows.
#[derive(Clone, Copy)]
pub(super) struct Checksum([u64; 4]);

impl Checksum {
    /// Of nothing.
    pub fn new() -> Self {
        Self([1, 2, 3, 4])
    }

    /// Goes on with the words of one block. The sum depends on how words are cut into blocks.
    pub fn add(&mut self, words: &[u64]) {
        let (rows, rest) = words.as_chunks::<4>();
        for row in rows {
            for (lane, word) in self.0.iter_mut().zip(row) {
                *lane = step(*lane, *word);
            }
        }
        for (lane, word) in self.0.iter_mut().zip(rest) {
            *lane = step(*lane, *word);
        }
    }

    /// Returns the sum.
    pub fn finish(self) -> u64 {
        self.0.iter().fold(0, |sum, lane| step(sum, *lane))
    }
}

#[inline]
fn step(lane: u64, word: u64) -> u64 {
    (lane ^ word).wrapping_mul(MULTIPLIER).rotate_left(29)
}
