//! A vocabulary as it lies in memory: its tree in flat arrays.

use std::fmt;

use super::arrays::Arrays;
use super::fingerprint::Fingerprint;
use super::shape::Shape;

/// A vocabulary, in flat arrays laid out for the descent.
///
/// Nodes are numbered breadth first, so that the children of a node lie side by side: choosing among them reads
/// one stretch of memory.
#[derive(Clone, PartialEq)]
pub struct Vocabulary {
    pub(super) shape: Shape,
    pub(super) arrays: Arrays,
    pub(super) fingerprint: Fingerprint,
}

impl Vocabulary {
    /// Returns what the vocabulary declares of itself.
    pub fn shape(&self) -> Shape {
        self.shape
    }

    /// Bytes of one descriptor, a multiple of 8.
    pub fn descriptor_bytes(&self) -> usize {
        self.shape.descriptor_bytes
    }

    /// Returns the number of words; they are numbered from 0.
    pub fn word_count(&self) -> usize {
        self.arrays.word_count()
    }

    /// Returns how many nodes there are, the root included.
    pub fn node_count(&self) -> usize {
        self.arrays.node_count()
    }

    /// Returns the inverse document frequency of a word.
    pub fn word_weight(&self, word: u32) -> Option<f64> {
        self.arrays.parts().weights.get(word as usize).copied().map(f64::from_bits)
    }

    /// Returns the name of the content: equal for the text and the binary form of one vocabulary.
    pub fn fingerprint(&self) -> Fingerprint {
        self.fingerprint
    }

    /// Returns the memory the vocabulary occupies, in bytes, without the allocator's own.
    pub fn heap_bytes(&self) -> usize {
        self.arrays.bytes()
    }

    /// Returns how many 64-bit words a descriptor has.
    pub(super) fn descriptor_words(&self) -> usize {
        self.shape.descriptor_bytes / 8
    }
}

impl fmt::Debug for Vocabulary {
    /// Returns the figures only; the nodes fill a library.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter
            .debug_struct("Vocabulary")
            .field("shape", &self.shape)
            .field("nodes", &self.node_count())
            .field("words", &self.word_count())
            .field("fingerprint", &self.fingerprint)
            .finish_non_exhaustive()
    }
}
