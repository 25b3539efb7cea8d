//! The scores of one query against every keyframe, and the memory they are added up in.

use super::block::BLOCK_KEYFRAMES;
use super::row::Row;
use crate::model::bow::Score;

/// Memory that queries reuse, one for each thread; a query allocates nothing once it is warm. It carries nothing from one query to the next.
#[derive(Debug, Default)]
pub struct Scratch {
    terms: Vec<Term>,
    /// One a keyframe id, whole blocks of them: score units above, common words below.
    accumulators: Vec<u64>,
    /// The query's weight by slot; all zero between queries.
    weight_by_slot: Vec<u32>,
}

/// A word of the query that the map knows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Term {
    /// The word's slot.
    pub(super) slot: u32,
    /// Its weight in the query.
    pub(super) weight: u32,
}

impl Scratch {
    /// Memory that will grow to the size of the maps it is used with.
    pub fn new() -> Self {
        Self::default()
    }

    /// Readies the scratch for a query of these `(slot, weight)` terms over so many blocks.
    pub(super) fn begin(
        &mut self,
        terms: impl Iterator<Item = (u32, u32)>,
        blocks: usize,
    ) -> (&[Term], Accumulators<'_>) {
        self.terms.clear();
        self.terms.extend(terms.map(|(slot, weight)| Term { slot, weight }));
        let keyframes = blocks * BLOCK_KEYFRAMES;
        if self.accumulators.len() < keyframes {
            self.accumulators.resize(keyframes, 0);
        }
        let accumulators = Accumulators {
            packed: &mut self.accumulators[..keyframes],
            weight_by_slot: &mut self.weight_by_slot,
        };
        (&self.terms, accumulators)
    }
}

/// The accumulators of a query that is being scored.
pub(super) struct Accumulators<'s> {
    packed: &'s mut [u64],
    weight_by_slot: &'s mut Vec<u32>,
}

impl<'s> Accumulators<'s> {
    /// The accumulators of each block, still as the last query left them.
    pub(super) fn blocks(&mut self) -> impl Iterator<Item = &mut [u64; BLOCK_KEYFRAMES]> {
        self.packed.as_chunks_mut().0.iter_mut()
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
            self.packed[row.keyframe as usize] = row.score(self.weight_by_slot);
        }
        for term in terms {
            self.weight_by_slot[term.slot as usize] = 0;
        }
    }

    /// The scores, to read.
    pub(super) fn finish(self) -> Scores<'s> {
        Scores { packed: self.packed }
    }
}

/// A query's score against every keyframe.
#[derive(Clone, Copy, Debug)]
pub struct Scores<'s> {
    packed: &'s [u64],
}

impl<'s> Scores<'s> {
    /// The score of one keyframe; zero for one that is not in the file.
    pub fn get(&self, keyframe: u32) -> Score {
        self.packed.get(keyframe as usize).map_or(Score::default(), |&packed| unpack(packed))
    }

    /// The keyframes that share a word with the query, by ascending id.
    pub fn iter(&self) -> impl Iterator<Item = (u32, Score)> + use<'s> {
        let touched = self.packed.iter().enumerate().filter(|&(_, &packed)| packed != 0);
        touched.map(|(keyframe, &packed)| (keyframe as u32, unpack(packed)))
    }
}

/// A score as an accumulator holds it: the sums of both halves are taken by one addition. Neither overflows:
/// the units of a whole vector sum to 2^31, and it has at most 65,535 words.
pub(super) fn pack(units: u32, common_words: u32) -> u64 {
    u64::from(units) << 32 | u64::from(common_words)
}

fn unpack(packed: u64) -> Score {
    Score::new((packed >> 32) as u32, packed as u32)
}
