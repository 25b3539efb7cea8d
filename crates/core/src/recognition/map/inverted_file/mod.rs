//! The inverted file: from a bag of words to its score against every keyframe of the map.
//!
//! For every word, the keyframes that have it and their weights (*postings*). One query reads the postings of
//! its words, a million or more in a large map, so the layout is chosen for reading:
//!
//! - Keyframes are cut into *blocks* of 8,192 consecutive ids. A posting then fits six bytes, 16 bits of
//!   keyframe and 32 of exact weight, and the accumulators of a block (64 KB) stay in cache as its postings stream by.
//! - Within a block, postings lie word after word in *segments* that are written once, at exact capacity.
//!   An insert never touches them: new keyframes wait as *rows*, 64 at a time become a small segment, and
//!   segments of like size are merged, as in a log-structured merge tree. A merge runs in steps, a bounded number of postings
//!   an insert, and its segments answer queries until it is done. So no insert waits for a block, however large the map is.
//! - A map that is loaded writes each block once, from all of its rows.
//! - A removed keyframe is only marked, its score erased after its segment was read; the next merge drops it. A block that
//!   lost all of its keyframes costs neither time nor accumulators.

mod block;
mod block_number;
mod merge;
mod packed_score;
mod row;
mod scores;
mod segment;

use std::collections::{HashMap, VecDeque};
use std::fmt;

use foldhash::fast::RandomState;

use self::block::Block;
use self::block_number::{BLOCK_KEYFRAMES, block_of};
use self::row::Row;
pub use self::scores::{Scores, Scratch};
use crate::domain::bow::BowVector;

/// Rows kept until they become a segment. A query looks at each of them in full, about half a microsecond,
/// and each merge pays for every word of the map: 64 keeps both small.
const ROWS_MAX: usize = 64;

/// Postings that one insert copies to larger segments at most: some 0.1 ms. A posting is copied ten times or so in all, and a
/// keyframe brings a thousand of them at most, so merges keep pace.
const MERGE_POSTINGS: usize = if cfg!(test) { 256 } else { 32 * 1024 };

/// The words of one map's keyframes, ready to be scored against a query.
///
/// Keyframes are dense ids given by the caller, meant to grow with each insert. Two files are equal when they
/// hold the same keyframes with the same vectors, whatever was inserted and removed to get there.
#[derive(Clone, Default)]
pub struct InvertedFile {
    /// Word -> slot, the dense number of a word in the order of its first appearance.
    slots: HashMap<u32, u32, RandomState>,
    /// Indexed by `keyframe / BLOCK_KEYFRAMES`.
    blocks: Vec<Block>,
    /// The latest keyframes, not in any segment yet.
    rows: Vec<Row>,
    /// The blocks with a merge under way.
    merging: VecDeque<usize>,
    /// The blocks before this one are sealed.
    sealed_count: usize,
    /// Whether keyframes are being loaded: rows then wait for their whole block.
    is_loading: bool,
    posting_count: usize,
}

impl InvertedFile {
    /// Adds a keyframe, which must not be in the file. An empty vector leaves no trace.
    pub fn insert(&mut self, keyframe: u32, bow: &BowVector) {
        if bow.is_empty() {
            return;
        }
        debug_assert!(!self.contains(keyframe), "keyframe {keyframe} is in the inverted file already");
        let slots = bow.words().iter().map(|&word| self.slot_for(word)).collect();
        self.rows.push(Row { keyframe, slots, weights: bow.weights().into() });
        self.posting_count += bow.len();
        let block = block_of(keyframe);
        if block >= self.blocks.len() {
            self.blocks.resize_with(block + 1, Block::default);
        }
        if self.is_loading {
            // Keyframes are loaded in order, so that a block is written once, in one piece.
            let is_next_block = self.rows.first().is_some_and(|row| block_of(row.keyframe) != block);
            if is_next_block || self.rows.len() == BLOCK_KEYFRAMES {
                self.flush();
            }
        } else if self.rows.len() == ROWS_MAX {
            self.flush();
        }
        self.advance_merges(MERGE_POSTINGS);
    }

    /// Begins loading: keyframes follow in order, before the first query.
    pub fn begin_loading(&mut self) {
        self.is_loading = true;
    }

    /// Ends loading: all keyframes are here.
    pub fn finish_loading(&mut self) {
        self.is_loading = false;
        self.flush();
        self.advance_merges(usize::MAX);
    }

    /// Removes a keyframe, given the vector it was inserted with. A keyframe that is not in the file stays out of it.
    pub fn remove(&mut self, keyframe: u32, bow: &BowVector) {
        if let Some(at) = self.rows.iter().position(|row| row.keyframe == keyframe) {
            self.rows.remove(at);
        } else {
            let number = block_of(keyframe);
            if !self.blocks.get_mut(number).is_some_and(|block| block.remove(keyframe)) {
                return;
            }
            self.note_merge(number);
            self.advance_merges(MERGE_POSTINGS);
        }
        self.posting_count = self.posting_count.saturating_sub(bow.len());
    }

    /// Scores `query` against every keyframe: DBoW2's L1 score, the sum over common words of min(v_i, w_i).
    pub fn score_all<'s>(&self, query: &BowVector, scratch: &'s mut Scratch) -> Scores<'s> {
        let known = query.iter().filter_map(|(word, weight)| Some((*self.slots.get(&word)?, weight)));
        // Rows are of the last block or two.
        let first_of_rows = self.rows.iter().map(|row| block_of(row.keyframe)).min().unwrap_or(usize::MAX);
        let blocks = self.blocks.iter().enumerate();
        let held = blocks.map(|(number, block)| number >= first_of_rows || !block.is_empty());
        let (terms, mut accumulators) = scratch.begin(known, held);
        for (number, accumulators) in accumulators.blocks() {
            self.blocks[number].score(terms, accumulators);
        }
        if !self.rows.is_empty() {
            accumulators.score_rows(&self.rows, terms, self.slots.len());
        }
        accumulators.finish()
    }

    /// Returns how many postings the file holds: the sum of the keyframes' numbers of words.
    pub fn posting_count(&self) -> usize {
        self.posting_count
    }

    /// Returns the heap memory the file occupies, in bytes, without the allocator's own.
    pub fn heap_bytes(&self) -> usize {
        // The standard hash map fills at most 7/8 of its buckets; a bucket is an entry and a control byte.
        let slots = self.slots.capacity() / 7 * 8 * (size_of::<(u32, u32)>() + 1);
        let blocks: usize = self.blocks.iter().map(Block::heap_bytes).sum();
        let rows: usize = self.rows.iter().map(Row::heap_bytes).sum();
        slots
            + blocks
            + self.blocks.capacity() * size_of::<Block>()
            + rows
            + self.rows.capacity() * size_of::<Row>()
    }

    fn contains(&self, keyframe: u32) -> bool {
        self.rows.iter().any(|row| row.keyframe == keyframe)
            || self.blocks.get(block_of(keyframe)).is_some_and(|block| block.contains(keyframe))
    }

    fn slot_for(&mut self, word: u32) -> u32 {
        let next = self.slots.len() as u32;
        *self.slots.entry(word).or_insert(next)
    }

    /// Turns the rows into segments of their blocks, and seals every block but the last.
    fn flush(&mut self) {
        let slot_count = self.slots.len();
        self.rows.sort_by_key(|row| block_of(row.keyframe));
        let rows = std::mem::take(&mut self.rows);
        for rows in rows.chunk_by(|a, b| block_of(a.keyframe) == block_of(b.keyframe)) {
            let number = block_of(rows[0].keyframe);
            self.blocks[number].add(rows, slot_count);
            self.note_merge(number);
        }
        let last = self.blocks.len().saturating_sub(1);
        while self.sealed_count < last {
            self.blocks[self.sealed_count].seal();
            self.note_merge(self.sealed_count);
            self.sealed_count += 1;
        }
    }

    /// Queues a block that has begun to merge.
    fn note_merge(&mut self, block: usize) {
        if self.blocks[block].is_merging() && !self.merging.contains(&block) {
            self.merging.push_back(block);
        }
    }

    /// Continues merges, block after block, for at most `budget` postings.
    fn advance_merges(&mut self, budget: usize) {
        let mut left = budget;
        while let Some(&block) = self.merging.front() {
            let Some(rest) = self.blocks[block].advance(left) else { return };
            left = rest;
            self.merging.pop_front();
        }
    }

    /// `(keyframe, slot, weight)` of every posting in one block, in no particular order.
    fn postings_of_block(&self, block: usize) -> impl Iterator<Item = (u32, u32, u32)> + '_ {
        let in_segments = self.blocks.get(block).into_iter().flat_map(move |held| held.postings(block));
        let rows = self.rows.iter().filter(move |row| block_of(row.keyframe) == block);
        in_segments.chain(rows.flat_map(Row::postings))
    }

    /// `(keyframe, word, weight)` of every posting in one block, sorted.
    fn sorted_postings_of_block(&self, block: usize, word_by_slot: &[u32]) -> Vec<(u32, u32, u32)> {
        let with_word = |(keyframe, slot, weight)| (keyframe, word_by_slot[slot as usize], weight);
        let mut postings: Vec<_> = self.postings_of_block(block).map(with_word).collect();
        postings.sort_unstable();
        postings
    }

    fn words_by_slot(&self) -> Vec<u32> {
        let mut words = vec![0; self.slots.len()];
        for (&word, &slot) in &self.slots {
            words[slot as usize] = word;
        }
        words
    }
}

impl PartialEq for InvertedFile {
    fn eq(&self, other: &Self) -> bool {
        let (our_words, their_words) = (self.words_by_slot(), other.words_by_slot());
        let blocks = self.blocks.len().max(other.blocks.len());
        // Block by block: the whole sorted at once would take many times the file's own memory.
        self.posting_count == other.posting_count
            && (0..blocks).all(|block| {
                self.sorted_postings_of_block(block, &our_words)
                    == other.sorted_postings_of_block(block, &their_words)
            })
    }
}

impl Eq for InvertedFile {}

impl fmt::Debug for InvertedFile {
    /// Returns the figures only; the postings of a map fill many screens.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter
            .debug_struct("InvertedFile")
            .field("words", &self.slots.len())
            .field("postings", &self.posting_count)
            .field("blocks", &self.blocks.len())
            .field("rows", &self.rows.len())
            .finish_non_exhaustive()
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests;
