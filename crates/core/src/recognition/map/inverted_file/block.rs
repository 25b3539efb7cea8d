//! A block: the segments of consecutive keyframe ids, few enough that their accumulators stay in a fast cache.

use super::block_number::{BLOCK_KEYFRAMES, local_in_block};
use super::merge::Merge;
use super::packed_score::Term;
use super::row::Row;
use super::segment::Segment;

/// A block is rewritten when more than one in this many of its keyframes has been removed.
const REMOVED_SHARE: usize = 8;

/// The segments of one block, oldest first.
#[derive(Clone, Default)]
pub(super) struct Block {
    segments: Vec<Segment>,
    /// The merge that is under way.
    merge: Option<Merge>,
    is_sealed: bool,
}

impl Block {
    /// Adds rows as a new segment, to be merged with the latest ones as long as those are not clearly larger: each posting is
    /// then copied a logarithmic number of times, and the block has few segments.
    pub(super) fn add(&mut self, rows: &[Row], slot_count: usize) {
        self.segments.push(Segment::from_rows(rows, slot_count));
        self.begin_merge();
    }

    /// Seals the block: no more rows are expected, so it becomes one segment.
    pub(super) fn seal(&mut self) {
        if !self.is_sealed {
            self.is_sealed = true;
            self.begin_merge();
        }
    }

    /// Continues the block's merges for at most `budget` postings. Returns the rest of the budget; none if a merge remains.
    pub(super) fn advance(&mut self, budget: usize) -> Option<usize> {
        let mut left = budget;
        while let Some(merge) = &mut self.merge {
            left = merge.advance(&self.segments, left)?;
            self.finish_merge();
            self.begin_merge();
        }
        Some(left)
    }

    /// Whether segments are being merged.
    pub(super) fn is_merging(&self) -> bool {
        self.merge.is_some()
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
        self.begin_merge();
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
        let merge = self.merge.as_ref().map_or(0, Merge::heap_bytes);
        segments + self.segments.capacity() * size_of::<Segment>() + merge
    }

    /// Begins the merge that the block needs now, unless one is under way.
    fn begin_merge(&mut self) {
        if self.merge.is_none()
            && let Some(first) = self.first_to_merge()
        {
            self.merge = Some(Merge::begin(first, &self.segments[first..]));
        }
    }

    /// Returns the place of the first segment that is to be merged with all after it.
    fn first_to_merge(&self) -> Option<usize> {
        let removed: usize = self.segments.iter().map(Segment::removed_count).sum();
        let members: usize = self.segments.iter().map(Segment::member_count).sum();
        if removed * REMOVED_SHARE > members {
            return Some(0);
        }
        let last = self.segments.len().checked_sub(1)?;
        let mut first = last;
        let mut merged = self.segments[last].member_count();
        while first > 0 && (self.is_sealed || self.segments[first - 1].member_count() < 2 * merged) {
            first -= 1;
            merged += self.segments[first].member_count();
        }
        (first < last).then_some(first)
    }

    fn finish_merge(&mut self) {
        let Some(merge) = self.merge.take() else { return };
        let places = merge.places();
        let merged = merge.finish(&self.segments);
        let is_empty = merged.removed_count() == merged.member_count();
        self.segments.splice(places, (!is_empty).then_some(merged));
    }
}
