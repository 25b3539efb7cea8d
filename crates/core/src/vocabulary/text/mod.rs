//! DBoW2's text form: `k L  scoring weighting`, then one node a line, `parent isLeaf d0 ... dN  weight`.
//!
//! Nodes are numbered from 1 in the order of the lines, words from 0 in the order of the leaf lines.

mod fault;
mod line;
mod read;
mod write;

pub use self::fault::TextFault;
pub(super) use self::read::read;
pub(super) use self::write::write;
