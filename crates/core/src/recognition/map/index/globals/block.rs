//! A block: the global descriptors of keyframes with neighbouring numbers, one after the other.

use crate::domain::global_descriptor::{GlobalDescriptor, GlobalEncoding, GlobalForm};
use crate::domain::ids::KeyframeSeq;

/// Descriptors of up to [`Block::KEYFRAMES`] keyframes. All lists are ascending by keyframe, so that blocks with the same
/// content are equal, in whatever order it came.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Block {
    keyframes: Vec<KeyframeSeq>,
    /// The descriptors, in the same order.
    rows: Vec<u8>,
    /// Of signed bytes: one divided by the length of each vector, 0 for a vector of zeros. Of bits: empty.
    inverse_lengths: Vec<f64>,
}

impl Block {
    /// Keyframes of a block: long enough to be read in one go, short enough that removing one moves little.
    pub(super) const KEYFRAMES: u32 = 256;

    /// Rows for which memory is taken at a time: doubling would leave half of a map's descriptors' memory unused.
    const GROWTH: usize = 16;

    /// Returns the number of the block that a keyframe belongs to.
    pub(super) fn number(keyframe: KeyframeSeq) -> u32 {
        keyframe.0 / Self::KEYFRAMES
    }

    /// Returns what a descriptor of this form takes in a block, in bytes.
    pub(super) fn row_bytes(form: &GlobalForm) -> usize {
        let length = match form.encoding {
            GlobalEncoding::Int8 => size_of::<f64>(),
            GlobalEncoding::Bits => 0,
        };
        size_of::<KeyframeSeq>() + form.bytes + length
    }

    pub(super) fn is_empty(&self) -> bool {
        self.keyframes.is_empty()
    }

    pub(super) fn get(&self, keyframe: KeyframeSeq) -> Option<&[u8]> {
        let at = self.keyframes.binary_search(&keyframe).ok()?;
        Some(self.row(at))
    }

    /// Returns the keyframes, ascending.
    #[inline(always)]
    pub(super) fn keyframes(&self) -> &[KeyframeSeq] {
        &self.keyframes
    }

    /// Returns the descriptor of one of them, by its place in that list.
    #[inline(always)]
    pub(super) fn row(&self, at: usize) -> &[u8] {
        let each = self.row_len();
        &self.rows[at * each..][..each]
    }

    /// Returns one divided by the length of each vector, in the same order; nothing where they are bits.
    #[inline(always)]
    pub(super) fn inverse_lengths(&self) -> &[f64] {
        &self.inverse_lengths
    }

    /// Returns the bytes of one descriptor.
    #[inline(always)]
    fn row_len(&self) -> usize {
        self.rows.len().checked_div(self.keyframes.len()).unwrap_or(0)
    }

    /// Adds a descriptor as long as the others; returns whether the keyframe had none.
    pub(super) fn insert(&mut self, keyframe: KeyframeSeq, descriptor: &GlobalDescriptor) -> bool {
        let Err(at) = self.keyframes.binary_search(&keyframe) else { return false };
        if self.keyframes.len() == self.keyframes.capacity() {
            self.keyframes.reserve_exact(Self::GROWTH);
            self.rows.reserve_exact(Self::GROWTH * descriptor.data.len());
        }
        self.keyframes.insert(at, keyframe);
        let begin = at * descriptor.data.len();
        self.rows.splice(begin..begin, descriptor.data.iter().copied());
        if descriptor.encoding == GlobalEncoding::Int8 {
            self.inverse_lengths.insert(at, inverse_length(&descriptor.data));
        }
        true
    }

    /// Removes a keyframe's descriptor; returns whether it had one.
    pub(super) fn remove(&mut self, keyframe: KeyframeSeq) -> bool {
        let Ok(at) = self.keyframes.binary_search(&keyframe) else { return false };
        let each = self.row_len();
        self.keyframes.remove(at);
        self.rows.drain(at * each..(at + 1) * each);
        if !self.inverse_lengths.is_empty() {
            self.inverse_lengths.remove(at);
        }
        true
    }
}

/// Returns one divided by the length of a vector of signed bytes; 0 for a vector without a direction.
pub(super) fn inverse_length(numbers: &[u8]) -> f64 {
    let squares: i32 = numbers.iter().map(|byte| i32::from(*byte as i8).pow(2)).sum();
    if squares == 0 { 0.0 } else { 1.0 / f64::from(squares).sqrt() }
}
