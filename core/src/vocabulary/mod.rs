//! The vocabulary: a tree of binary descriptors that turns the descriptors of an image into a bag of words.
//!
//! It follows DBoW2 word for word: the same words, weights and scores come out, to the last bit of every double.
//!
//! | file | concept |
//! |---|---|
//! | `tree` | nodes in the order of a file become the arrays held here |
//! | `nearest` | which of a node's children is nearest to a descriptor |
//! | `descent` | descriptors go down the tree, all of them level by level |
//! | `transform` | descriptors -> words and groups |
//! | `words` | a bag of words in doubles, and its score |
//! | `groups` | features that share a node, for matching |
//! | `source` | plain, gzip or zstd, told by the first bytes |
//! | `text` | DBoW2's text form |
//! | `binary` | a form of our own that loads at once |
//! | `fingerprint` | the name of a vocabulary's content |
//! | `train` | recorded descriptors become a vocabulary |

mod binary;
mod descent;
mod error;
mod fingerprint;
mod groups;
mod nearest;
mod source;
mod text;
pub mod train;
mod transform;
mod tree;
mod words;

use std::fmt;
use std::fs::File;
use std::io::{self, BufRead, Read, Write};
use std::path::Path;

pub use self::binary::BinaryFault;
pub use self::error::VocabularyError;
pub use self::fingerprint::Fingerprint;
pub use self::groups::FeatureGroups;
pub use self::source::decompressed;
pub use self::text::TextFault;
pub use self::transform::{DescriptorMismatch, Transformed};
pub use self::tree::TreeFault;
pub use self::words::WordVector;

use self::tree::Link;

/// How many levels above the words features are grouped for matching: ORB-SLAM's choice.
pub const LEVELS_UP: u32 = 4;

/// What a vocabulary declares of itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shape {
    /// k: how many children a node was meant to have.
    pub branching: u32,
    /// L: how many levels below the root it was meant to have. Groups count from it, whatever the tree's real depth.
    pub levels: u32,
    /// Bytes of one descriptor, a multiple of 8.
    pub descriptor_bytes: usize,
}

/// A vocabulary, in flat arrays laid out for the descent.
///
/// Nodes are numbered breadth first, so that the children of a node lie side by side: choosing among them reads
/// one stretch of memory.
#[derive(Clone, PartialEq)]
pub struct Vocabulary {
    shape: Shape,
    /// By node: its children, or its word.
    links: Vec<Link>,
    /// By node: its number in the file, by which groups are named.
    node_ids: Vec<u32>,
    /// By word.
    weights: Vec<f64>,
    /// By node, `descriptor_bytes / 8` words each, little endian; the root's are zero and never looked at.
    descriptors: Vec<u64>,
    fingerprint: Fingerprint,
}

impl Vocabulary {
    /// Loads a vocabulary in either form, plain or compressed.
    pub fn load(path: &Path) -> Result<Self, VocabularyError> {
        Self::read(File::open(path)?)
    }

    /// Reads a vocabulary in either form, plain or compressed, told by the first bytes.
    pub fn read(bytes: impl Read + Send + 'static) -> Result<Self, VocabularyError> {
        let (mut reader, is_binary) = source::open(bytes)?;
        if is_binary { binary::read(&mut reader) } else { text::read(&mut reader) }
    }

    /// Reads DBoW2's text form.
    pub fn read_text(mut text: impl BufRead) -> Result<Self, VocabularyError> {
        text::read(&mut text)
    }

    /// Reads the binary form.
    pub fn read_binary(mut bytes: impl Read) -> Result<Self, VocabularyError> {
        binary::read(&mut bytes)
    }

    /// Writes DBoW2's text form. It ends without a newline: some readers of that form take a blank last line for a word.
    pub fn write_text(&self, out: impl Write) -> io::Result<()> {
        text::write(self, out)
    }

    /// Writes the binary form.
    pub fn write_binary(&self, out: impl Write) -> io::Result<()> {
        binary::write(self, out)
    }

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
        self.weights.len()
    }

    /// Returns how many nodes there are, the root included.
    pub fn node_count(&self) -> usize {
        self.links.len()
    }

    /// Returns the inverse document frequency of a word.
    pub fn word_weight(&self, word: u32) -> Option<f64> {
        self.weights.get(word as usize).copied()
    }

    /// Returns the name of the content: equal for the text and the binary form of one vocabulary.
    pub fn fingerprint(&self) -> Fingerprint {
        self.fingerprint
    }

    /// Whether the content is what its fingerprint says. The binary form carries the fingerprint along, and
    /// loading it verifies a faster checksum only.
    pub fn fingerprint_holds(&self) -> bool {
        self.fingerprint == Fingerprint::of(self)
    }

    /// Returns the heap memory the vocabulary occupies, in bytes, without the allocator's own.
    pub fn heap_bytes(&self) -> usize {
        self.links.capacity() * size_of::<Link>()
            + self.node_ids.capacity() * size_of::<u32>()
            + self.weights.capacity() * size_of::<f64>()
            + self.descriptors.capacity() * size_of::<u64>()
    }

    /// Returns how many 64-bit words a descriptor has.
    fn descriptor_words(&self) -> usize {
        self.shape.descriptor_bytes / 8
    }

    /// Returns the same tree with other weights, by word.
    fn with_weights(mut self, weights: Vec<f64>) -> Self {
        debug_assert_eq!(weights.len(), self.weights.len(), "one weight for each word");
        self.weights = weights;
        self.fingerprint = Fingerprint::of(&self);
        self
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

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod golden;
#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod laws;
#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests;
