//! Ways in which a binary vocabulary is not usable.

use crate::vocabulary::content::VERSION;
use crate::vocabulary::tree_fault::TreeFault;

/// Reasons why a binary vocabulary is not usable.
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
        /// Its value.
        got: u64,
    },
    /// A node whose children or word are out of order.
    #[error("the children or the word of node {0} are not where they belong")]
    Link(u32),
    /// The nodes do not make a vocabulary.
    #[error(transparent)]
    Tree(#[from] TreeFault),
    /// The memory for it is not to be had.
    #[error("there is no memory for {nodes} nodes with descriptors of {descriptor_bytes} bytes")]
    Memory {
        /// The nodes.
        nodes: usize,
        /// Bytes of each one's descriptor.
        descriptor_bytes: usize,
    },
}
