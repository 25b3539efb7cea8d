//! The binary form: the arrays of a vocabulary as they lie in memory, little endian.
//!
//! | bytes | what |
//! |---|---|
//! | 8 | `MAGIC` |
//! | 4 x 8 | `u32`: version, k, L, scoring (0), weighting (0), bytes of a descriptor, nodes, words |
//! | 32 | fingerprint |
//! | 8, 8 | checksum of the content; checksum of the header up to here |
//! | 8 x nodes | links: children `count << 32 | first`, or the word |
//! | 8 x words | weights, `f64` |
//! | 4 x nodes | numbers in the text form, filled up with zero to a multiple of 8 |
//! | nodes x descriptor | descriptors |
//!
//! The content is the last four, the nodes breadth first.

mod checksum;
mod header;
mod read;
mod write;

pub(super) use self::read::read;
pub(super) use self::write::{write, write_content};

use super::TreeFault;

/// How the form says what it is. The second byte is no text, so no text form starts like this.
pub(super) const MAGIC: [u8; 8] = *b"\x96RVOC\r\n\x1a";

/// The one version there is.
const VERSION: u32 = 1;

/// Content is summed up and read by blocks of so many 64-bit words, each section from a new block on.
const BLOCK_WORDS: usize = 16 * 1024;

/// What is wrong with a binary vocabulary.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BinaryFault {
    /// Another kind of file.
    #[error("it does not start as one")]
    Magic,
    /// Written by a later program.
    #[error(
        "version {0} is not known to this program, which reads version {VERSION}; convert the text form again"
    )]
    Version(u32),
    /// A bit is wrong somewhere in the header.
    #[error("the header is damaged")]
    HeaderChecksum,
    /// A bit is wrong somewhere in the content.
    #[error("the content is damaged: its checksum does not match")]
    Checksum,
    /// The file ends early.
    #[error("the file is cut short")]
    CutShort,
    /// There is more after the end.
    #[error("the file goes on after its end")]
    TooLong,
    /// A number of the header is nothing a vocabulary has.
    #[error("{what} is {got}")]
    Bounds {
        /// Which number.
        what: &'static str,
        /// What it is.
        got: u64,
    },
    /// A node whose children or word are out of order.
    #[error("the children or the word of node {0} are not where they belong")]
    Link(u32),
    /// The nodes do not make a vocabulary.
    #[error(transparent)]
    Tree(#[from] TreeFault),
    /// The memory for it is not to be had.
    #[error("there is no memory for {0} bytes")]
    Memory(usize),
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests;
#[cfg(test)]
pub(super) use self::tests::mend;
