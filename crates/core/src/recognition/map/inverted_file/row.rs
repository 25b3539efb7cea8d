//! A row: the words of one keyframe that is in no segment yet.

use super::packed_score::pack;

/// A keyframe that is in no segment yet.
#[derive(Clone)]
pub(super) struct Row {
    /// The keyframe's id in the map.
    pub(super) keyframe: u32,
    /// The slots of its words.
    pub(super) slots: Box<[u32]>,
    /// Their weights, parallel to `slots`.
    pub(super) weights: Box<[u32]>,
}

impl Row {
    /// Returns the score against a query spread out by slot, packed as an accumulator.
    pub(super) fn score(&self, weight_by_slot: &[u32]) -> u64 {
        let mut sum = 0;
        for (&slot, &weight) in self.slots.iter().zip(&self.weights) {
            let in_query = weight_by_slot[slot as usize];
            // No branch: which words are common cannot be predicted.
            sum += pack(weight.min(in_query), u32::from(in_query != 0));
        }
        sum
    }

    /// `(keyframe, slot, weight)` of every posting.
    pub(super) fn postings(&self) -> impl Iterator<Item = (u32, u32, u32)> + '_ {
        self.slots.iter().zip(&self.weights).map(|(&slot, &weight)| (self.keyframe, slot, weight))
    }

    /// Bytes on the heap.
    pub(super) fn heap_bytes(&self) -> usize {
        size_of_val(&*self.slots) + size_of_val(&*self.weights)
    }
}
