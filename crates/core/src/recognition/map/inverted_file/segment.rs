//! A segment: the postings of some keyframes of one block, word after word, written once.

use std::hint::black_box;

use super::block_number::{BLOCK_KEYFRAMES, local_in_block};
use super::packed_score::{Term, pack};
use super::row::Row;

/// Words whose postings are fetched together, some tens of kilobytes of them.
const FETCH_WORDS: usize = 16;
/// One posting in this many is touched to fetch them all: less than 64 bytes, a cache line, apart.
const FETCH_STRIDE: usize = 10;

/// Postings in compressed sparse rows, by slot.
#[derive(Clone)]
pub(super) struct Segment {
    /// `offsets[slot]..offsets[slot + 1]` are the postings of a slot; slots given out later have none here.
    offsets: Box<[u32]>,
    /// By slot, those of one slot in the order the keyframes came.
    postings: Box<[Posting]>,
    /// The keyframes, within the block, ascending; those removed included.
    members: Box<[u16]>,
    /// Members removed since the segment was written.
    removed: Vec<u16>,
}

impl Segment {
    /// Writes the postings of rows that all belong to one block.
    pub(super) fn from_rows(rows: &[Row], slot_count: usize) -> Self {
        let mut offsets = vec![0_u32; slot_count + 1];
        for &slot in rows.iter().flat_map(|row| &row.slots) {
            offsets[slot as usize + 1] += 1;
        }
        for slot in 0..slot_count {
            offsets[slot + 1] += offsets[slot];
        }
        let count = offsets[slot_count] as usize;
        let mut next = offsets.clone();
        let mut postings = vec![Posting::default(); count];
        for (keyframe, slot, weight) in rows.iter().flat_map(Row::postings) {
            let at = &mut next[slot as usize];
            postings[*at as usize] = Posting::new(local_in_block(keyframe), weight);
            *at += 1;
        }
        let members = rows.iter().map(|row| local_in_block(row.keyframe)).collect();
        Self::of_parts(offsets, postings, members)
    }

    /// Adds this segment's share to the accumulators of its block.
    pub(super) fn accumulate(&self, terms: &[Term], accumulators: &mut [u64; BLOCK_KEYFRAMES]) {
        for terms in terms.chunks(FETCH_WORDS) {
            let mut lists: [&[Posting]; FETCH_WORDS] = [&[]; FETCH_WORDS];
            for (list, term) in lists.iter_mut().zip(terms) {
                *list = self.slot(term.slot);
            }
            fetch(&lists);
            for (list, term) in lists.iter().zip(terms) {
                for posting in *list {
                    // The remainder changes nothing; it tells the compiler that no bounds check is needed.
                    let accumulator = &mut accumulators[usize::from(posting.local) % BLOCK_KEYFRAMES];
                    *accumulator += pack(posting.weight().min(term.weight), 1);
                }
            }
        }
        // Erases nothing else: a keyframe that came back since is in a later segment, or still a row.
        for &local in &self.removed {
            accumulators[usize::from(local)] = 0;
        }
    }

    /// Marks a keyframe as removed, if it is here.
    pub(super) fn remove(&mut self, local: u16) -> bool {
        let found = self.contains(local);
        if found {
            self.removed.push(local);
        }
        found
    }

    /// Whether a keyframe is here and was not removed.
    pub(super) fn contains(&self, local: u16) -> bool {
        self.members.binary_search(&local).is_ok() && !self.removed.contains(&local)
    }

    /// Returns how many keyframes are here, those removed included.
    pub(super) fn member_count(&self) -> usize {
        self.members.len()
    }

    /// Returns how many keyframes are marked as removed.
    pub(super) fn removed_count(&self) -> usize {
        self.removed.len()
    }

    /// `(keyframe within the block, slot, weight)` of every posting that counts.
    pub(super) fn postings(&self) -> impl Iterator<Item = (u16, u32, u32)> + '_ {
        let kept = self.kept();
        (0..self.slot_count() as u32)
            .flat_map(move |slot| {
                self.slot(slot).iter().map(move |posting| (posting.local, slot, posting.weight()))
            })
            .filter(move |&(local, ..)| kept.as_ref().is_none_or(|kept| kept[usize::from(local)]))
    }

    /// Bytes on the heap.
    pub(super) fn heap_bytes(&self) -> usize {
        size_of_val(&*self.offsets)
            + size_of_val(&*self.postings)
            + size_of_val(&*self.members)
            + self.removed.capacity() * size_of::<u16>()
    }

    /// Returns the number of postings, those of removed keyframes included.
    pub(super) fn posting_count(&self) -> usize {
        self.postings.len()
    }

    /// Returns the keyframes that were removed since the segment was written, in the order of removal.
    pub(super) fn removed(&self) -> &[u16] {
        &self.removed
    }

    /// Puts a segment together from its parts.
    pub(super) fn of_parts(offsets: Vec<u32>, postings: Vec<Posting>, mut members: Vec<u16>) -> Self {
        members.sort_unstable();
        Self {
            offsets: offsets.into(),
            postings: postings.into(),
            members: members.into(),
            removed: Vec::new(),
        }
    }

    /// Returns the number of slots for which the segment has an offset.
    pub(super) fn slot_count(&self) -> usize {
        self.offsets.len() - 1
    }

    /// Returns the postings of one slot.
    pub(super) fn slot(&self, slot: u32) -> &[Posting] {
        let slot = slot as usize;
        let Some(&[from, to]) = self.offsets.get(slot..slot + 2) else {
            return &[];
        };
        &self.postings[from as usize..to as usize]
    }

    /// Returns the keyframes that still count.
    pub(super) fn live_members(&self) -> impl Iterator<Item = u16> + '_ {
        let kept = self.kept();
        self.members
            .iter()
            .copied()
            .filter(move |&local| kept.as_ref().is_none_or(|kept| kept[usize::from(local)]))
    }

    /// Returns which keyframes still count; none if all do.
    pub(super) fn kept(&self) -> Option<Vec<bool>> {
        if self.removed.is_empty() {
            return None;
        }
        let mut kept = vec![true; BLOCK_KEYFRAMES];
        for &local in &self.removed {
            kept[usize::from(local)] = false;
        }
        Some(kept)
    }
}

/// A keyframe and its weight for one word, in six bytes: 32 bits next to 16 would be padded to eight.
#[derive(Clone, Copy, Default)]
pub(super) struct Posting {
    /// The keyframe, within the block.
    pub(super) local: u16,
    /// The weight, low half first.
    weight: [u16; 2],
}

impl Posting {
    fn new(local: u16, weight: u32) -> Self {
        Self { local, weight: [weight as u16, (weight >> 16) as u16] }
    }

    fn weight(self) -> u32 {
        u32::from(self.weight[0]) | u32::from(self.weight[1]) << 16
    }
}

/// Brings postings into the cache. They lie scattered over all memory in short lists, and waiting for each as
/// it is added up takes most of a query; touched in one go they arrive together. Measured: more than twice as fast.
fn fetch(lists: &[&[Posting]]) {
    let mut touched = 0;
    for posting in lists.iter().flat_map(|list| list.iter().step_by(FETCH_STRIDE)) {
        touched ^= posting.local;
    }
    black_box(touched);
}
