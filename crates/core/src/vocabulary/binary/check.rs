//! Checks the arrays as they are read: whatever the bytes are, a descent ends at a word.
//!
//! Eight numbers at a time are held against a bound first, by arithmetic that needs no branches; only where one of them may
//! be beyond it they are looked at one by one.

use super::fault::BinaryFault;
use crate::vocabulary::link::Link;
use crate::vocabulary::tree;

/// Numbers that are looked at together.
const TOGETHER: usize = 8;

/// Findings about the arrays so far, and the first faults. They are told at the end: a damaged file is told by its checksum.
#[derive(Default)]
pub(super) struct Check {
    nodes: u64,
    words: u64,
    /// Nodes, weights and numbers of nodes so far.
    seen: [u64; 3],
    /// Place of the next node's children.
    next_child: u64,
    words_seen: u64,
    root_is_word: bool,
    /// The first node that is out of order, in links and in numbers.
    bad_nodes: [Option<u64>; 2],
    bad_weight: Option<(u64, f64)>,
}

impl Check {
    pub(super) fn new(nodes: usize, words: usize) -> Self {
        Self { nodes: nodes as u64, words: words as u64, next_child: 1, ..Self::default() }
    }

    /// Breadth first means: the children of each node begin where those of the node before it ended. With every child after
    /// its parent there is no cycle, and every descent ends at a word.
    pub(super) fn links(&mut self, block: &[u64]) {
        for links in block.chunks(TOGETHER) {
            if self.bad_nodes[0].is_some() {
                return;
            }
            // Words: links without children are below their number.
            if all_below(links, self.words) && self.seen[0] > 0 {
                self.words_seen += links.len() as u64;
                self.seen[0] += links.len() as u64;
                continue;
            }
            for &bits in links {
                let node = self.seen[0];
                let link = Link::from_bits(bits);
                let (target, count) = (u64::from(link.target()), u64::from(link.count()));
                let in_place = if count == 0 {
                    self.words_seen += 1;
                    self.root_is_word |= node == 0;
                    target < self.words
                } else {
                    target == self.next_child && self.next_child > node
                };
                self.next_child += count;
                if !in_place || self.next_child > self.nodes {
                    self.bad_nodes[0] = Some(node);
                    return;
                }
                self.seen[0] += 1;
            }
        }
    }

    /// Weights are finite and not negative.
    pub(super) fn weights(&mut self, block: &[u64]) {
        for weights in block.chunks(TOGETHER) {
            if self.bad_weight.is_none() && !all_below(weights, f64::INFINITY.to_bits()) {
                let weights = (self.seen[1]..).zip(weights.iter().map(|bits| f64::from_bits(*bits)));
                let is_bad = |(_, weight): &(u64, f64)| tree::check_weight(0, *weight).is_err();
                self.bad_weight = weights.into_iter().find(is_bad);
            }
            self.seen[1] += weights.len() as u64;
        }
    }

    /// Numbers in the file are below that of the nodes. An odd one leaves half of the last pair open.
    pub(super) fn node_ids(&mut self, block: &[u64]) {
        for pairs in block.chunks(TOGETHER) {
            let halves = |pair: &u64| [u64::from(*pair as u32), pair >> 32];
            let beyond = pairs
                .iter()
                .map(halves)
                .fold(0, |all, [first, second]| all | beyond(first, self.nodes) | beyond(second, self.nodes));
            if self.bad_nodes[1].is_none() && is_any(beyond) {
                let mut nodes = (self.seen[2]..self.nodes).zip(pairs.iter().flat_map(halves));
                self.bad_nodes[1] = nodes.find(|(_, id)| *id >= self.nodes).map(|(node, _)| node);
            }
            self.seen[2] += 2 * pairs.len() as u64;
        }
    }

    /// Returns the first fault.
    pub(super) fn finish(self) -> Result<(), BinaryFault> {
        if let Some(node) = self.bad_nodes.into_iter().flatten().min() {
            return Err(BinaryFault::Link(node as u32));
        }
        if self.next_child != self.nodes || self.words_seen != self.words || self.root_is_word {
            return Err(BinaryFault::Link(0));
        }
        match self.bad_weight {
            Some((word, weight)) => Ok(tree::check_weight(word as u32, weight)?),
            None => Ok(()),
        }
    }
}

/// Whether all numbers are below a bound.
#[inline]
fn all_below(numbers: &[u64], bound: u64) -> bool {
    !is_any(numbers.iter().fold(0, |all, number| all | beyond(*number, bound)))
}

/// Returns a number whose top bit is set where the given one is not below a bound of at most 2^63. Such numbers are joined by
/// `|`, so that many comparisons take one branch.
#[inline]
fn beyond(number: u64, bound: u64) -> u64 {
    number | (bound - 1).wrapping_sub(number)
}

/// Whether any of the numbers that were joined was beyond its bound.
#[inline]
fn is_any(beyond: u64) -> bool {
    beyond >> 63 != 0
}
