//! Ways in which nodes do not make a tree of words.

use super::shape::{BRANCHING_MAX, LEVELS_MAX, NODES_MAX};

/// Why nodes do not make a vocabulary. Nodes are counted from 1, the root is 0.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum TreeFault {
    /// k or L is nothing a vocabulary has.
    #[error("k = {branching} and L = {levels}; k must lie in 1..={}, L in 1..={}", BRANCHING_MAX, LEVELS_MAX)]
    Shape {
        /// k.
        branching: u64,
        /// L.
        levels: u64,
    },
    /// A node hangs on itself or on one that comes later.
    #[error("node {node} hangs on node {parent}, which does not come before it")]
    LateParent {
        /// The node.
        node: u32,
        /// Its parent.
        parent: u64,
    },
    /// A word has a child.
    #[error("node {node} hangs on node {parent}, which is a word")]
    ParentIsWord {
        /// The node.
        node: u32,
        /// Its parent.
        parent: u32,
    },
    /// An inner node without children.
    #[error("node {node} is marked as inner, but has no children")]
    Barren {
        /// The node.
        node: u32,
    },
    /// The tree is deeper than any vocabulary.
    #[error("node {node} lies deeper than {} levels", LEVELS_MAX)]
    TooDeep {
        /// The node.
        node: u32,
    },
    /// A weight that is no inverse document frequency.
    #[error("the weight of node {node} is {weight}; it must be finite and not negative")]
    Weight {
        /// The node.
        node: u32,
        /// Its weight.
        weight: f64,
    },
    /// More nodes than a vocabulary may have.
    #[error("more than {} nodes", NODES_MAX)]
    TooManyNodes,
    /// Nothing but the root.
    #[error("it has no words")]
    Empty,
    /// The memory for the nodes is not to be had.
    #[error("there is no memory for the nodes")]
    Memory,
}
