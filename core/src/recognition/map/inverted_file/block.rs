//! A block: the segments of consecutive keyframe ids, few enough that their accumulators stay in a fast cache.

use super::block_number::{BLOCK_KEYFRAMES, local_in_block};
use super::packed_score::Term;
use super::row::Row;
use super::segment::Segment;

/// A block is rewritten when more than one in this many of its keyframes has been removed.
const REMOVED_SHARE: usize = 8;

/// The segments of one block, oldest first.
#[derive(Clone, Default)]
pub(super) struct Block {
    segments: Vec<Segment>,
}

impl Block {
    /// Adds rows as a new segment, merged with the latest ones as long as those are not clearly larger:
    /// each posting is then copied a logarithmic number of times, and the block has as few segments.
    pub(super) fn add(&mut self, rows: &[Row], slot_count: usize) {
        let segment = Segment::from_rows(rows, slot_count);
        let mut merged = segment.member_count();
        let mut first = self.segments.len();
        self.segments.push(segment);
        while first > 0 && self.segments[first - 1].member_count() < 2 * merged {
            first -= 1;
            merged += self.segments[first].member_count();
        }
        self.merge_from(first);
    }

    /// Leaves the block in one segment.
    pub(super) fn seal(&mut self) {
        self.merge_from(0);
    }

    /// Sets the accumulators to the scores of the block's keyframes, whatever they were before.
    pub(super) fn score(&self, terms: &[Term], accumulators: &mut [u64; BLOCK_KEYFRAMES]) {
        // Only now, and not once for all blocks: it brings the accumulators into the cache.
        accumulators.fill(0);
        for segment in &self.segments {
            segment.accumulate(terms, accumulators);
        }
    }

    /// Whether no keyframe is in a segment.
    pub(super) fn is_empty(&self) -> bool {
        self.segments.is_empty()
    }

    /// Removes a keyframe, if it is here.
    pub(super) fn remove(&mut self, keyframe: u32) -> bool {
        let found = self.segments.iter_mut().any(|segment| segment.remove(local_in_block(keyframe)));
        let removed: usize = self.segments.iter().map(Segment::removed_count).sum();
        let members: usize = self.segments.iter().map(Segment::member_count).sum();
        if removed * REMOVED_SHARE > members {
            self.rewrite(0);
        }
        found
    }

    /// Whether a keyframe is here.
    pub(super) fn contains(&self, keyframe: u32) -> bool {
        self.segments.iter().any(|segment| segment.contains(local_in_block(keyframe)))
    }

    /// `(keyframe, slot, weight)` of every posting, given the block's own number.
    pub(super) fn postings(&self, number: usize) -> impl Iterator<Item = (u32, u32, u32)> + '_ {
        let first = (number * BLOCK_KEYFRAMES) as u32;
        let postings = self.segments.iter().flat_map(Segment::postings);
        postings.map(move |(local, slot, weight)| (first + u32::from(local), slot, weight))
    }

    /// Bytes on the heap.
    pub(super) fn heap_bytes(&self) -> usize {
        let segments: usize = self.segments.iter().map(Segment::heap_bytes).sum();
        segments + self.segments.capacity() * size_of::<Segment>()
    }

    fn merge_from(&mut self, first: usize) {
        if self.segments.len() > first + 1 {
            self.rewrite(first);
        }
    }

    fn rewrite(&mut self, first: usize) {
        let merged = Segment::merge(&self.segments[first..]);
        self.segments.truncate(first);
        if merged.member_count() > 0 {
            self.segments.push(merged);
        }
    }
}
