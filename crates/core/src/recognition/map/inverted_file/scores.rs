//! The scores of one query against every keyframe, and the memory they are added up in.

use super::block_number::{BLOCK_KEYFRAMES, block_of, local_in_block};
use super::packed_score::{Term, unpack};
use super::row::Row;
use crate::domain::bow::Score;

/// Memory that queries reuse, one for each thread; a query allocates nothing once it is warm. It carries nothing from one query to the next.
#[derive(Debug, Default)]
pub struct Scratch {
    terms: Vec<Term>,
    /// By block, where its accumulators begin; [`NO_KEYFRAMES`] for one that holds nothing.
    places: Vec<usize>,
    /// One a keyframe id, whole blocks of them: score units above, common words below.
    accumulators: Vec<u64>,
    /// The query's weight by slot; all zero between queries.
    weight_by_slot: Vec<u32>,
}

/// The place of a block without keyframes. A map whose keyframes come and go leaves more and more of them behind.
const NO_KEYFRAMES: usize = usize::MAX;

impl Scratch {
    /// Bytes on the heap.
    #[cfg(test)]
    pub(super) fn heap_bytes(&self) -> usize {
        self.terms.capacity() * size_of::<Term>()
            + self.places.capacity() * size_of::<usize>()
            + self.accumulators.capacity() * size_of::<u64>()
            + self.weight_by_slot.capacity() * size_of::<u32>()
    }

    /// Readies the scratch for a query of these `(slot, weight)` terms; of each block, whether it holds anything.
    pub(super) fn begin(
        &mut self,
        terms: impl Iterator<Item = (u32, u32)>,
        held: impl Iterator<Item = bool>,
    ) -> (&[Term], Accumulators<'_>) {
        self.terms.clear();
        self.terms.extend(terms.map(|(slot, weight)| Term { slot, weight }));
        let mut keyframes = 0;
        self.places.clear();
        self.places.extend(held.map(|held| {
            let place = if held { keyframes } else { NO_KEYFRAMES };
            keyframes += if held { BLOCK_KEYFRAMES } else { 0 };
            place
        }));
        if self.accumulators.len() < keyframes {
            self.accumulators.resize(keyframes, 0);
        }
        let accumulators = Accumulators {
            places: &self.places,
            packed: &mut self.accumulators[..keyframes],
            weight_by_slot: &mut self.weight_by_slot,
        };
        (&self.terms, accumulators)
    }
}

/// The accumulators of a query that is being scored.
pub(super) struct Accumulators<'s> {
    places: &'s [usize],
    packed: &'s mut [u64],
    weight_by_slot: &'s mut Vec<u32>,
}

impl<'s> Accumulators<'s> {
    /// Returns the accumulators of each block that holds anything, still as the last query left them.
    pub(super) fn blocks(&mut self) -> impl Iterator<Item = (usize, &mut [u64; BLOCK_KEYFRAMES])> {
        let held = self.places.iter().enumerate().filter(|(_, place)| **place != NO_KEYFRAMES);
        held.map(|(number, _)| number).zip(self.packed.as_chunks_mut().0)
    }

    /// Scores keyframes that are in no segment yet, each word of theirs looked up in the query.
    pub(super) fn score_rows(&mut self, rows: &[Row], terms: &[Term], slot_count: usize) {
        if self.weight_by_slot.len() < slot_count {
            self.weight_by_slot.resize(slot_count, 0);
        }
        for term in terms {
            self.weight_by_slot[term.slot as usize] = term.weight;
        }
        for row in rows {
            let place = self.places[block_of(row.keyframe)] + usize::from(local_in_block(row.keyframe));
            self.packed[place] = row.score(self.weight_by_slot);
        }
        for term in terms {
            self.weight_by_slot[term.slot as usize] = 0;
        }
    }

    /// Returns the scores, to read.
    pub(super) fn finish(self) -> Scores<'s> {
        Scores { places: self.places, packed: self.packed }
    }
}

/// A query's score against every keyframe.
#[derive(Clone, Copy, Debug)]
pub struct Scores<'s> {
    places: &'s [usize],
    packed: &'s [u64],
}

impl<'s> Scores<'s> {
    /// Returns the score of one keyframe; zero for one that is not in the file.
    pub fn get(&self, keyframe: u32) -> Score {
        let place = self.places.get(block_of(keyframe)).filter(|place| **place != NO_KEYFRAMES);
        place.map_or(Score::default(), |place| {
            unpack(self.packed[place + usize::from(local_in_block(keyframe))])
        })
    }

    /// Returns the keyframes that share a word with the query, by ascending id.
    pub fn iter(&self) -> impl Iterator<Item = (u32, Score)> + use<'s> {
        let (places, packed) = (self.places, self.packed);
        let held = places.iter().enumerate().filter(|(_, place)| **place != NO_KEYFRAMES);
        held.flat_map(move |(number, &place)| {
            let first = (number * BLOCK_KEYFRAMES) as u32;
            let block = packed[place..place + BLOCK_KEYFRAMES].iter().enumerate();
            block
                .filter(|&(_, &packed)| packed != 0)
                .map(move |(at, &packed)| (first + at as u32, unpack(packed)))
        })
    }
}
