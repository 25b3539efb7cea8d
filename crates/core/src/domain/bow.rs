//! A bag-of-words vector in fixed point, and DBoW2's L1 score between two of them.
//!
//! Floating-point sums depend on their order; sums of integers do not. Weights are therefore whole units of
//! 2^-31 that add up to exactly 2^31, so that a score is the same bytes whoever adds it up, and a vector
//! scores exactly 1 against itself.

use std::cmp::Ordering;

use serde::{Deserialize, Serialize};

/// A bag-of-words vector, L1-normalised exactly: weights are units of 2^-31 that sum to [`BowVector::ONE`], or there are none.
#[derive(Clone, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(try_from = "BowParts")]
pub struct BowVector {
    /// Strictly ascending.
    words: Box<[u32]>,
    /// Parallel to `words`, each at least one unit.
    weights: Box<[u32]>,
}

/// The parts of a vector that may be none.
#[derive(Deserialize)]
struct BowParts {
    words: Vec<u32>,
    weights: Vec<u32>,
}

impl TryFrom<BowParts> for BowVector {
    type Error = BowError;

    fn try_from(parts: BowParts) -> Result<Self, BowError> {
        Self::from_parts(parts.words, parts.weights)
    }
}

impl BowVector {
    /// The whole, in weight units.
    pub const ONE: u32 = 1 << 31;
    /// The most words a vector may have: a count of common words fits 16 bits, and every weight keeps some precision.
    pub const MAX_WORDS: usize = u16::MAX as usize;

    /// Normalises `(word, weight)` entries given in any order; the result does not depend on that order.
    ///
    /// Words of weight zero are dropped; if none is left the vector is empty. Every word that stays has at
    /// least one unit, and what rounding leaves over goes, unit by unit, to the largest weights.
    pub fn normalised(mut entries: Vec<(u32, f64)>) -> Result<Self, BowError> {
        entries.sort_unstable_by_key(|&(word, _)| word);
        for pair in entries.windows(2) {
            if pair[0].0 == pair[1].0 {
                return Err(BowError::DuplicateWord { word: pair[0].0 });
            }
        }
        if let Some(&(word, weight)) = entries.iter().find(|(_, weight)| !weight.is_finite() || *weight < 0.0)
        {
            return Err(BowError::InvalidWeight { word, weight });
        }
        entries.retain(|&(_, weight)| weight > 0.0);
        check_word_count(entries.len())?;

        let weights = to_units(&entries);
        let words = entries.into_iter().map(|(word, _)| word).collect();
        Ok(Self { words, weights: weights.into() })
    }

    /// Puts a vector together again from its parts, refusing parts that no vector has.
    pub fn from_parts(words: Vec<u32>, weights: Vec<u32>) -> Result<Self, BowError> {
        if words.len() != weights.len() {
            return Err(BowError::LengthMismatch { words: words.len(), weights: weights.len() });
        }
        check_word_count(words.len())?;
        for pair in words.windows(2) {
            match pair[0].cmp(&pair[1]) {
                Ordering::Less => {}
                Ordering::Equal => return Err(BowError::DuplicateWord { word: pair[0] }),
                Ordering::Greater => return Err(BowError::UnsortedWords { word: pair[1] }),
            }
        }
        if let Some(at) = weights.iter().position(|&weight| weight == 0) {
            return Err(BowError::InvalidWeight { word: words[at], weight: 0.0 });
        }
        let sum: u64 = weights.iter().copied().map(u64::from).sum();
        if !words.is_empty() && sum != u64::from(Self::ONE) {
            return Err(BowError::NotNormalised { sum });
        }
        Ok(Self { words: words.into(), weights: weights.into() })
    }

    /// Returns the words, strictly ascending.
    pub fn words(&self) -> &[u32] {
        &self.words
    }

    /// Returns the weights in units of 2^-31, parallel to [`BowVector::words`].
    pub fn weights(&self) -> &[u32] {
        &self.weights
    }

    /// Returns how many words the vector has.
    pub fn len(&self) -> usize {
        self.words.len()
    }

    /// Whether the vector has no word at all: a blank wall.
    pub fn is_empty(&self) -> bool {
        self.words.is_empty()
    }

    /// `(word, weight in units)`, words ascending.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = (u32, u32)> + '_ {
        self.words.iter().copied().zip(self.weights.iter().copied())
    }

    /// DBoW2's L1 score: the sum over common words of min(v_i, w_i).
    pub fn similarity(&self, other: &Self) -> Score {
        let (mut units, mut common_words) = (0, 0);
        let mut theirs = other.iter().peekable();
        for (word, weight) in self.iter() {
            while theirs.next_if(|&(their_word, _)| their_word < word).is_some() {}
            if let Some((_, their_weight)) = theirs.next_if(|&(their_word, _)| their_word == word) {
                units += weight.min(their_weight);
                common_words += 1;
            }
        }
        Score::new(units, common_words)
    }
}

/// A BoW score in [0, 1], exact, with the number of words the two vectors have in common.
///
/// Scores order by their value; at the same value, the one with fewer common words comes first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct Score {
    units: u32,
    common_words: u32,
}

impl Score {
    /// Returns a score of `units` times 2^-31 over `common_words` words.
    pub const fn new(units: u32, common_words: u32) -> Self {
        Self { units, common_words }
    }

    /// Returns the score in units of 2^-31, at most [`BowVector::ONE`].
    pub const fn units(self) -> u32 {
        self.units
    }

    /// Returns how many words the two vectors have in common.
    pub const fn common_words(self) -> u32 {
        self.common_words
    }

    /// Returns the score as a number in [0, 1]; the division is exact.
    pub fn value(self) -> f64 {
        f64::from(self.units) / f64::from(BowVector::ONE)
    }
}

/// The reason why entries or parts are not a bag-of-words vector.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BowError {
    /// A word is listed twice.
    #[error("word {word} is listed twice")]
    DuplicateWord {
        /// The word.
        word: u32,
    },
    /// A weight is negative, not finite or, in stored parts, zero.
    #[error("the weight of word {word} is {weight}; it must be finite and not negative")]
    InvalidWeight {
        /// The word.
        word: u32,
        /// Its weight.
        weight: f64,
    },
    /// More words than [`BowVector::MAX_WORDS`].
    #[error("{words} words; at most {} are allowed", BowVector::MAX_WORDS)]
    TooManyWords {
        /// Number of words.
        words: usize,
    },
    /// Stored parts of different lengths.
    #[error("{words} words but {weights} weights")]
    LengthMismatch {
        /// Number of words.
        words: usize,
        /// Number of weights.
        weights: usize,
    },
    /// Stored words that do not ascend.
    #[error("word {word} follows a larger one")]
    UnsortedWords {
        /// The word out of order.
        word: u32,
    },
    /// Stored weights that do not sum to [`BowVector::ONE`].
    #[error("the weights sum to {sum} units instead of {}", BowVector::ONE)]
    NotNormalised {
        /// Their sum, in units of 2^-31.
        sum: u64,
    },
}

fn check_word_count(words: usize) -> Result<(), BowError> {
    if words > BowVector::MAX_WORDS { Err(BowError::TooManyWords { words }) } else { Ok(()) }
}

/// Positive weights, words ascending -> units that sum to exactly one.
fn to_units(entries: &[(u32, f64)]) -> Vec<u32> {
    // Taken relative to the largest, so that neither the sum nor a share overflows.
    let largest = entries.iter().map(|&(_, weight)| weight).fold(0.0, f64::max);
    let sum: f64 = entries.iter().map(|&(_, weight)| weight / largest).sum();
    // Rounded to nearest and not down: a vector that is already in units comes back unchanged.
    let mut units: Vec<u32> = entries
        .iter()
        .map(|&(_, weight)| (weight / largest / sum * f64::from(BowVector::ONE)).round().max(1.0) as u32)
        .collect();

    let total: i64 = units.iter().copied().map(i64::from).sum();
    let mut left_over = i64::from(BowVector::ONE) - total;
    if left_over == 0 || units.is_empty() {
        return units;
    }
    let mut largest_first: Vec<usize> = (0..units.len()).collect();
    largest_first.sort_by(|&a, &b| entries[b].1.total_cmp(&entries[a].1).then(a.cmp(&b)));
    let mut next = 0;
    while left_over != 0 {
        let at = largest_first[next];
        next = (next + 1) % largest_first.len();
        if left_over > 0 {
            units[at] += 1;
            left_over -= 1;
        } else if units[at] > 1 {
            units[at] -= 1;
            left_over += 1;
        } else {
            // No later word has more than one unit; passing over all of them, one weight among 65,535 took seconds.
            next = 0;
        }
    }
    units
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn entries() -> impl Strategy<Value = Vec<(u32, f64)>> {
        let weight = prop_oneof![4 => 0.01..10.0, 1 => Just(0.0), 1 => 1e-300..1e-200, 1 => 1e300..1.7e308];
        proptest::collection::btree_map(0_u32..300, weight, 0..80).prop_map(|map| map.into_iter().collect())
    }

    proptest! {
        #[test]
        fn weights_sum_to_one_whatever_the_order(given in entries(), seed in any::<u64>()) {
            let bow = BowVector::normalised(given.clone()).unwrap();
            let sum: u64 = bow.weights().iter().copied().map(u64::from).sum();
            prop_assert_eq!(sum, if bow.is_empty() { 0 } else { 1 << 31 });
            prop_assert_eq!(bow.len(), given.iter().filter(|(_, weight)| *weight > 0.0).count());

            let mut shuffled = given;
            shuffled.sort_by_key(|&(word, _)| (u64::from(word) ^ seed).wrapping_mul(0x9e37_79b9_7f4a_7c15));
            prop_assert_eq!(BowVector::normalised(shuffled).unwrap(), bow);
        }

        #[test]
        fn a_vector_in_units_comes_back_unchanged(given in entries()) {
            let bow = BowVector::normalised(given).unwrap();
            let again = bow.iter().map(|(word, weight)| (word, f64::from(weight))).collect();
            prop_assert_eq!(BowVector::normalised(again).unwrap(), bow.clone());
            prop_assert_eq!(BowVector::from_parts(bow.words().to_vec(), bow.weights().to_vec()).unwrap(), bow);
        }

        #[test]
        fn similarity_is_symmetric_bounded_and_one_with_itself(a in entries(), b in entries()) {
            let (a, b) = (BowVector::normalised(a).unwrap(), BowVector::normalised(b).unwrap());
            prop_assert_eq!(a.similarity(&b), b.similarity(&a));
            prop_assert!(a.similarity(&b).value() <= 1.0);
            prop_assert_eq!(a.similarity(&a).value(), if a.is_empty() { 0.0 } else { 1.0 });
        }
    }

    #[test]
    fn a_score_is_the_sum_of_the_smaller_weights() {
        let a = BowVector::normalised(vec![(3, 1.0), (5, 1.0), (9, 2.0)]).unwrap();
        let b = BowVector::normalised(vec![(5, 3.0), (9, 1.0)]).unwrap();
        assert_eq!(a.similarity(&b), Score::new(1 << 30, 2));
        assert_eq!(a.similarity(&b).value(), 0.5);
    }

    #[test]
    fn bad_entries_are_refused() {
        let duplicate = BowVector::normalised(vec![(1, 0.5), (2, 0.1), (1, 0.4)]);
        assert_eq!(duplicate, Err(BowError::DuplicateWord { word: 1 }));
        for weight in [-0.1, f64::NAN, f64::INFINITY] {
            let bad = BowVector::normalised(vec![(7, weight)]);
            assert!(matches!(bad, Err(BowError::InvalidWeight { word: 7, .. })), "{weight}");
        }
        let many = BowVector::normalised((0..65_536).map(|word| (word, 1.0)).collect());
        assert_eq!(many, Err(BowError::TooManyWords { words: 65_536 }));
        assert!(BowVector::normalised((0..65_535).map(|word| (word, 1.0)).collect()).is_ok());
        // One word has nearly all the weight, and every other one its unit.
        let heavy = (0..65_535).map(|word| (word, if word == 9 { 1e30 } else { 5e-324 })).collect();
        let heavy = BowVector::normalised(heavy).unwrap();
        assert_eq!((heavy.weights()[9], heavy.weights()[8]), (BowVector::ONE - 65_534, 1));
    }

    #[test]
    fn bad_parts_are_refused() {
        let half = 1 << 30;
        let check = |words: &[u32], weights: &[u32], expected: BowError| {
            assert_eq!(BowVector::from_parts(words.to_vec(), weights.to_vec()), Err(expected));
        };
        check(&[1], &[], BowError::LengthMismatch { words: 1, weights: 0 });
        check(&[1, 1], &[half, half], BowError::DuplicateWord { word: 1 });
        check(&[2, 1], &[half, half], BowError::UnsortedWords { word: 1 });
        check(&[1, 2], &[half, half - 1], BowError::NotNormalised { sum: (1 << 31) - 1 });
        check(&[1, 2], &[1 << 31, 0], BowError::InvalidWeight { word: 2, weight: 0.0 });
        assert_eq!(BowVector::from_parts(vec![], vec![]), Ok(BowVector::default()));
    }
}
