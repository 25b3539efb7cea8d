//! The arrays of a vocabulary, in one piece of memory.

use super::link::Link;
use super::memory::Words;

/// 64-bit words in a cache line.
const LINE_WORDS: usize = 8;

/// Four arrays of 64-bit words, in the order of the binary form.
#[derive(Clone, PartialEq)]
pub(super) struct Arrays {
    memory: Words,
    nodes: usize,
    words: usize,
    /// Start of the descriptors.
    descriptors: usize,
}

/// The arrays, to read.
#[derive(Clone, Copy)]
pub(super) struct Parts<'a> {
    /// By node: its children, or its word, as [`Link::bits`].
    pub links: &'a [u64],
    /// By word: its weight, as the bits of an `f64`.
    pub weights: &'a [u64],
    /// Two nodes a word, the first one below: their numbers in the file, by which groups are named.
    pub node_ids: &'a [u64],
    /// By node, `descriptor_bytes / 8` each, little endian; the root's are zero and never looked at.
    pub descriptors: &'a [u64],
}

impl Arrays {
    /// Returns arrays of zeros, for descriptors of `each` 64-bit words; `None` if there is no memory for them.
    pub fn zeroed(nodes: usize, words: usize, each: usize) -> Option<Self> {
        let before = nodes.checked_add(words)?.checked_add(nodes.div_ceil(2))?;
        // The first child of the root begins a cache line: ten descriptors of 32 bytes then lie in five lines, not in six.
        let descriptors = before.checked_add(each)?.checked_next_multiple_of(LINE_WORDS)? - each;
        let memory = Words::zeroed(descriptors.checked_add(nodes.checked_mul(each)?)?)?;
        Some(Self { memory, nodes, words, descriptors })
    }

    /// Returns the number of nodes, the root included.
    pub fn node_count(&self) -> usize {
        self.nodes
    }

    /// Returns the number of words.
    pub fn word_count(&self) -> usize {
        self.words
    }

    /// Returns the memory they occupy, in bytes.
    pub fn bytes(&self) -> usize {
        self.memory.len() * size_of::<u64>()
    }

    /// Returns the arrays.
    pub fn parts(&self) -> Parts<'_> {
        let (links, rest) = self.memory.split_at(self.nodes);
        let (weights, rest) = rest.split_at(self.words);
        let descriptors = &self.memory[self.descriptors..];
        Parts { links, weights, node_ids: &rest[..self.nodes.div_ceil(2)], descriptors }
    }

    /// Returns the arrays to be written: links, weights, numbers and descriptors.
    pub fn parts_mut(&mut self) -> [&mut [u64]; 4] {
        let (before, descriptors) = self.memory.split_at_mut(self.descriptors);
        let (links, rest) = before.split_at_mut(self.nodes);
        let (weights, rest) = rest.split_at_mut(self.words);
        [links, weights, &mut rest[..self.nodes.div_ceil(2)], descriptors]
    }
}

impl<'a> Parts<'a> {
    /// Returns the arrays in the order of the binary form.
    pub fn in_order(self) -> [&'a [u64]; 4] {
        [self.links, self.weights, self.node_ids, self.descriptors]
    }

    /// Returns a node's children, or its word.
    #[inline(always)]
    pub fn link(&self, node: u32) -> Link {
        Link::from_bits(self.links[node as usize])
    }

    /// Returns a word's weight.
    pub fn weight(&self, word: u32) -> f64 {
        f64::from_bits(self.weights[word as usize])
    }

    /// Returns a node's number in the file.
    pub fn node_id(&self, node: u32) -> u32 {
        (self.node_ids[node as usize / 2] >> (32 * (node % 2))) as u32
    }
}

/// Writes a node's number into the array of them.
pub(super) fn set_node_id(node_ids: &mut [u64], node: u32, id: u32) {
    let (pair, shift) = (&mut node_ids[node as usize / 2], 32 * (node % 2));
    *pair = *pair & !(u64::from(u32::MAX) << shift) | u64::from(id) << shift;
}
