//! What can be wrong with a line of the text form.

use crate::vocabulary::shape::DESCRIPTOR_BYTES_MAX;
use crate::vocabulary::tree_fault::TreeFault;

/// What is wrong with a line.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TextFault {
    /// The first line is no header.
    #[error("expected the header `k L  scoring weighting`, four whole numbers")]
    Header,
    /// Another score than L1.
    #[error("scoring {0} ({name}) is not supported, only 0 (L1 norm)", name = scoring_name(*.0))]
    Scoring(u64),
    /// Other weights than TF-IDF.
    #[error("weighting {0} ({name}) is not supported, only 0 (TF-IDF)", name = weighting_name(*.0))]
    Weighting(u64),
    /// A line beyond all bounds.
    #[error("longer than {0} bytes")]
    TooLong(usize),
    /// A blank line with more lines after it: it would shift the numbers of all nodes below.
    #[error("blank, but not the last line")]
    Blank,
    /// Not a node.
    #[error("expected `parent isLeaf d0 ... dN  weight`; {0}")]
    Node(&'static str),
    /// A descriptor of a length that no descriptor has.
    #[error("a descriptor of {0} bytes; it must be a multiple of 8, at most {max}", max = DESCRIPTOR_BYTES_MAX)]
    DescriptorBytes(usize),
    /// A descriptor of another length than those before.
    #[error("a descriptor of {got} bytes, where the lines before have {expected}")]
    MixedDescriptors {
        /// Bytes on this line.
        got: usize,
        /// Bytes on the lines before.
        expected: usize,
    },
    /// The node does not fit the tree.
    #[error(transparent)]
    Tree(#[from] TreeFault),
}

fn scoring_name(code: u64) -> &'static str {
    match code {
        1 => "L2 norm",
        2 => "chi square",
        3 => "Kullback-Leibler",
        4 => "Bhattacharyya",
        5 => "dot product",
        _ => "unknown",
    }
}

fn weighting_name(code: u64) -> &'static str {
    match code {
        1 => "TF",
        2 => "IDF",
        3 => "binary",
        _ => "unknown",
    }
}
