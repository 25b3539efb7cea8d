//! A merge of segments, done in steps: an insert waits for a bounded number of postings, however large the segments are.

use super::segment::{Posting, Segment};

/// Segments of one block that become one. They answer queries until all of their postings are written.
#[derive(Clone)]
pub(super) struct Merge {
    /// The place of the first of them in its block.
    first: usize,
    /// By segment, which keyframes counted when the merge began; none if all did.
    kept: Vec<Option<Vec<bool>>>,
    /// By segment, how many of its keyframes had been removed by then.
    removed_before: Vec<usize>,
    members: Vec<u16>,
    /// The slots that are written end here.
    offsets: Vec<u32>,
    postings: Vec<Posting>,
    slot_count: usize,
}

impl Merge {
    /// Begins to merge segments, of which the first is at `first`.
    pub(super) fn begin(first: usize, segments: &[Segment]) -> Self {
        let slot_count = segments.iter().map(Segment::slot_count).max().unwrap_or(0);
        let mut offsets = Vec::with_capacity(slot_count + 1);
        offsets.push(0);
        Self {
            first,
            kept: segments.iter().map(Segment::kept).collect(),
            removed_before: segments.iter().map(Segment::removed_count).collect(),
            members: segments.iter().flat_map(Segment::live_members).collect(),
            offsets,
            postings: Vec::with_capacity(segments.iter().map(Segment::posting_count).sum()),
            slot_count,
        }
    }

    /// Returns the places of the segments in their block.
    pub(super) fn places(&self) -> std::ops::Range<usize> {
        self.first..self.first + self.kept.len()
    }

    /// Writes about as many postings as `budget` allows, each slot in full. Returns the rest of the budget; none if slots remain.
    pub(super) fn advance(&mut self, segments: &[Segment], budget: usize) -> Option<usize> {
        let mut left = budget;
        while self.offsets.len() <= self.slot_count {
            let slot = (self.offsets.len() - 1) as u32;
            let before = self.postings.len();
            for (segment, kept) in segments[self.places()].iter().zip(&self.kept) {
                let of_segment = segment.slot(slot);
                if let Some(kept) = kept {
                    self.postings
                        .extend(of_segment.iter().filter(|posting| kept[usize::from(posting.local)]));
                } else {
                    self.postings.extend_from_slice(of_segment);
                }
            }
            self.offsets.push(self.postings.len() as u32);
            // A slot without postings takes its time, too.
            left = left.checked_sub(self.postings.len() - before + 1)?;
        }
        Some(left)
    }

    /// Returns the segment that stands for all of them, once every slot is written. Keyframes that were removed since the
    /// merge began are removed from it.
    pub(super) fn finish(self, segments: &[Segment]) -> Segment {
        let places = self.places();
        let mut merged = Segment::of_parts(self.offsets, self.postings, self.members);
        for (segment, before) in segments[places].iter().zip(self.removed_before) {
            for local in &segment.removed()[before..] {
                merged.remove(*local);
            }
        }
        merged
    }

    /// Returns the bytes on the heap.
    pub(super) fn heap_bytes(&self) -> usize {
        self.offsets.capacity() * size_of::<u32>()
            + self.postings.capacity() * size_of::<Posting>()
            + self.members.capacity() * size_of::<u16>()
            + self.kept.iter().flatten().map(Vec::capacity).sum::<usize>()
    }
}
