//! The vocabulary: a tree of binary descriptors that turns the descriptors of an image into a bag of words.
//!
//! It follows DBoW2 word for word: the same words, weights and scores come out, to the last bit of every double.
//!
//! | file | concept |
//! |---|---|
//! | `flat_tree` | the vocabulary: its tree in flat arrays |
//! | `shape`, `link` | what it declares of itself, and one node's children |
//! | `arrays`, `memory` | those arrays in one piece, on huge pages |
//! | `tree` | nodes in the order of a file become those arrays |
//! | `nearest` | which of a node's children is nearest to a descriptor |
//! | `descent` | descriptors go down the tree, all of them level by level |
//! | `transform` | descriptors -> words and groups |
//! | `words` | a bag of words in doubles, and its score |
//! | `groups` | features that share a node, for matching |
//! | `source` | plain, gzip or zstd, told by the first bytes |
//! | `text` | DBoW2's text form |
//! | `forms` | either form by one name |
//! | `content` | the arrays as bytes, and their fingerprint |
//! | `binary` | a form of our own that loads at once |
//! | `fingerprint` | the name of a vocabulary's content |
//! | `train` | recorded descriptors become a vocabulary |

mod arrays;
mod binary;
mod content;
mod descent;
mod error;
mod fingerprint;
mod flat_tree;
mod forms;
mod groups;
mod link;
mod memory;
mod nearest;
mod shape;
mod source;
mod text;
pub mod train;
mod transform;
mod tree;
mod tree_fault;
mod words;

pub use self::binary::BinaryFault;
pub use self::error::VocabularyError;
pub use self::fingerprint::Fingerprint;
pub use self::flat_tree::Vocabulary;
pub use self::groups::FeatureGroups;
pub use self::shape::Shape;
pub use self::source::decompressed;
pub use self::text::TextFault;
pub use self::transform::{DescriptorMismatch, LEVELS_UP, Transformed};
pub use self::tree_fault::TreeFault;
pub use self::words::WordVector;

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod golden;
#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod laws;
#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests;
