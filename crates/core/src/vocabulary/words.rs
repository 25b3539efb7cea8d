//! A bag of words in doubles, as DBoW2 has it: its sums run in ascending order of words.

use crate::domain::bow::{BowError, BowVector};

/// Words and their weights, L1-normalised; words ascend, and none has weight 0.
///
/// [`WordVector::to_bow`] makes of it the vector that maps hold, in exact fixed point.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WordVector {
    entries: Vec<(u32, f64)>,
}

impl WordVector {
    /// Counts words, given one for each feature and ascending, and weighs them by `idf`.
    pub(super) fn of_sorted(words: &[u32], idf: impl Fn(u32) -> f64) -> Self {
        let mut entries: Vec<(u32, f64)> = Vec::with_capacity(words.len());
        for group in words.chunk_by(|a, b| a == b) {
            let weight = idf(group[0]);
            // Added up and not multiplied: the two round differently.
            let sum = group[1..].iter().fold(weight, |sum, _| sum + weight);
            entries.push((group[0], sum));
        }
        let norm: f64 = entries.iter().fold(0.0, |norm, (_, weight)| norm + weight);
        if norm > 0.0 {
            for (_, weight) in &mut entries {
                *weight /= norm;
            }
        }
        Self { entries }
    }

    /// `(word, weight)`, words ascending.
    pub fn entries(&self) -> &[(u32, f64)] {
        &self.entries
    }

    /// Returns the number of words.
    pub fn len(&self) -> usize {
        self.entries.len()
    }

    /// Whether there is no word: no features, or only words that every image has.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// DBoW2's L1 score, by its formula: 1 - |v - w| / 2, taken over the common words.
    pub fn l1_score(&self, other: &Self) -> f64 {
        let mut score = 0.0;
        let mut theirs = other.entries.iter().peekable();
        for &(word, ours) in &self.entries {
            while theirs.next_if(|(their_word, _)| *their_word < word).is_some() {}
            if let Some(&(_, theirs)) = theirs.next_if(|(their_word, _)| *their_word == word) {
                score += (ours - theirs).abs() - ours.abs() - theirs.abs();
            }
        }
        -score / 2.0
    }

    /// The vector a map holds.
    pub fn to_bow(&self) -> Result<BowVector, BowError> {
        BowVector::normalised(self.entries.clone())
    }
}
