//! The tree: nodes in the order of a file, put into breadth-first arrays.

use super::arrays::{Arrays, set_node_id};
use super::fingerprint::Fingerprint;
use super::flat_tree::Vocabulary;
use super::link::Link;
use super::shape::{BRANCHING_MAX, LEVELS_MAX, NODES_MAX, Shape};
use super::tree_fault::TreeFault;

/// A tree that grows node by node, parents before their children.
pub(super) struct Tree {
    shape: Shape,
    /// These five run in parallel; the root is node 0.
    parents: Vec<u32>,
    depths: Vec<u8>,
    is_word: Vec<bool>,
    child_counts: Vec<u32>,
    weights: Vec<f64>,
    descriptors: Vec<u64>,
}

impl Tree {
    /// Returns a root without children.
    pub fn new(shape: Shape) -> Self {
        let root = vec![0; shape.descriptor_bytes / 8];
        Self {
            shape,
            parents: vec![0],
            depths: vec![0],
            is_word: vec![false],
            child_counts: vec![0],
            weights: vec![0.0],
            descriptors: root,
        }
    }

    /// Refuses a k or an L that no vocabulary has.
    pub fn check_shape(branching: u64, levels: u64) -> Result<(u32, u32), TreeFault> {
        if (1..=BRANCHING_MAX).contains(&branching) && (1..=LEVELS_MAX).contains(&levels) {
            Ok((branching as u32, levels as u32))
        } else {
            Err(TreeFault::Shape { branching, levels })
        }
    }

    /// Returns how many nodes there are, the root included: the number of the next one.
    pub fn node_count(&self) -> usize {
        self.parents.len()
    }

    /// Where the next node's descriptor goes: its words are pushed here before [`Tree::push`].
    pub fn descriptors(&mut self) -> &mut Vec<u64> {
        &mut self.descriptors
    }

    /// Adds a node whose descriptor has been pushed; returns its number.
    pub fn push(&mut self, parent: u64, is_word: bool, weight: f64) -> Result<u32, TreeFault> {
        if self.node_count() >= NODES_MAX {
            return Err(TreeFault::TooManyNodes);
        }
        let node = self.node_count() as u32;
        debug_assert_eq!(self.descriptors.len(), (node as usize + 1) * self.shape.descriptor_bytes / 8);
        if parent >= u64::from(node) {
            return Err(TreeFault::LateParent { node, parent });
        }
        let parent = parent as u32;
        if self.is_word[parent as usize] {
            return Err(TreeFault::ParentIsWord { node, parent });
        }
        let depth = self.depths[parent as usize] + 1;
        if u64::from(depth) > LEVELS_MAX {
            return Err(TreeFault::TooDeep { node });
        }
        check_weight(node, weight)?;
        self.child_counts[parent as usize] += 1;
        self.child_counts.push(0);
        self.parents.push(parent);
        self.depths.push(depth);
        self.is_word.push(is_word);
        // Adding zero turns -0 into 0: equal vocabularies shall have equal bytes.
        self.weights.push(if is_word { weight + 0.0 } else { 0.0 });
        Ok(node)
    }

    /// Puts the nodes into their final order.
    pub fn finish(self) -> Result<Vocabulary, TreeFault> {
        if self.node_count() == 1 {
            return Err(TreeFault::Empty);
        }
        let barren = |&node: &usize| !self.is_word[node] && self.child_counts[node] == 0;
        if let Some(node) = (1..self.node_count()).find(barren) {
            return Err(TreeFault::Barren { node: node as u32 });
        }
        let places = self.breadth_first();
        let each = self.shape.descriptor_bytes / 8;
        let word_count = self.is_word.iter().filter(|is_word| **is_word).count();
        let mut arrays = Arrays::zeroed(places.len(), word_count, each).ok_or(TreeFault::Memory)?;
        let [links, weights, node_ids, descriptors] = arrays.parts_mut();
        let mut word = 0;
        for (node, place) in places.iter().enumerate() {
            let at = place.at as usize;
            set_node_id(node_ids, place.at, node as u32);
            descriptors[at * each..(at + 1) * each]
                .copy_from_slice(&self.descriptors[node * each..(node + 1) * each]);
            let link = if self.is_word[node] {
                // Words are numbered in the order of the file.
                weights[word as usize] = self.weights[node].to_bits();
                word += 1;
                Link::word(word - 1)
            } else {
                Link::children(place.first_child, self.child_counts[node])
            };
            links[at] = link.bits();
        }
        let mut vocabulary = Vocabulary { shape: self.shape, arrays, fingerprint: Fingerprint::default() };
        vocabulary.fingerprint = vocabulary.content_fingerprint();
        Ok(vocabulary)
    }

    /// Where each node goes: by depth, then by its parent's place, then in the order of the file.
    fn breadth_first(&self) -> Vec<Place> {
        let depth_max = self.depths.iter().copied().max().unwrap_or_default();
        let mut by_depth = vec![Vec::new(); usize::from(depth_max) + 1];
        for (node, &depth) in self.depths.iter().enumerate() {
            by_depth[usize::from(depth)].push(node as u32);
        }
        let mut places = vec![Place::default(); self.node_count()];
        let mut next = 1;
        // Where the next child of each node goes; a level's nodes come in any order, their parents are placed.
        let mut next_child = vec![0; self.node_count()];
        for mut level in by_depth {
            for &node in &level {
                if node != 0 {
                    let slot = &mut next_child[self.parents[node as usize] as usize];
                    places[node as usize].at = *slot;
                    *slot += 1;
                }
            }
            level.sort_unstable_by_key(|&node| places[node as usize].at);
            for &node in &level {
                places[node as usize].first_child = next;
                next_child[node as usize] = next;
                next += self.child_counts[node as usize];
            }
        }
        places
    }
}

/// Refuses a weight that is no inverse document frequency.
pub(super) fn check_weight(node: u32, weight: f64) -> Result<(), TreeFault> {
    if weight.is_finite() && weight >= 0.0 { Ok(()) } else { Err(TreeFault::Weight { node, weight }) }
}

/// A node's place in breadth-first order, and its first child's.
#[derive(Clone, Copy, Default)]
struct Place {
    at: u32,
    first_child: u32,
}
