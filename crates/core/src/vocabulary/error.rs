//! Why a file is no vocabulary.

use std::io;

use super::binary::BinaryFault;
use super::text::TextFault;
use super::tree_fault::TreeFault;

/// Why a vocabulary cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum VocabularyError {
    /// The file cannot be read, or its compression is broken.
    #[error("the vocabulary cannot be read: {0}")]
    Unreadable(#[from] io::Error),
    /// A line of the text form is wrong.
    #[error("line {line} of the vocabulary: {fault}")]
    Text {
        /// Counted from 1.
        line: u64,
        /// What is wrong with it.
        fault: TextFault,
    },
    /// The binary form is damaged, or not one that this program knows.
    #[error("the binary vocabulary is not usable: {0}")]
    Binary(#[from] BinaryFault),
    /// The nodes do not make a tree.
    #[error("the vocabulary is no tree of words: {0}")]
    Tree(#[from] TreeFault),
}
