//! The descent: descriptors go down the tree, all of them level by level.
//!
//! A million words do not fit the caches near the processor. Going level by level, the next descriptor does not
//! wait for this one's way down, and the processor fetches the children of several at once.

use super::Vocabulary;
use super::nearest::{nearest_of, nearest_of_any};

/// Where a descriptor ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Landing {
    /// Its word.
    pub word: u32,
    /// The node it passed at the level asked for, breadth first.
    pub node: u32,
}

impl Vocabulary {
    /// Sends down descriptors, given as 64-bit words, and notes the node each passes at `group_level`: the root at
    /// level 0, and the word's own node where it lies above that level. (DBoW2 leaves that last case to chance.)
    pub(super) fn descend(&self, descriptors: &[u64], group_level: u32) -> Vec<Landing> {
        match self.descriptor_words() {
            4 => self.descend_by(descriptors, group_level, nearest_of::<4>),
            6 => self.descend_by(descriptors, group_level, nearest_of::<6>),
            8 => self.descend_by(descriptors, group_level, nearest_of::<8>),
            _ => self.descend_by(descriptors, group_level, nearest_of_any),
        }
    }

    fn descend_by(
        &self,
        descriptors: &[u64],
        group_level: u32,
        nearest: impl Fn(&[u64], &[u64]) -> usize,
    ) -> Vec<Landing> {
        let each = self.descriptor_words();
        let queries = descriptors.chunks_exact(each);
        let mut landings = vec![Landing { word: 0, node: 0 }; queries.len()];
        // The descriptors still on their way, each with the node it has come to.
        let mut open: Vec<(u32, u32)> = (0..queries.len() as u32).map(|descriptor| (descriptor, 0)).collect();
        let mut level = 0;
        while !open.is_empty() {
            level += 1;
            open.retain_mut(|(descriptor, node)| {
                let landing = &mut landings[*descriptor as usize];
                let link = self.links[*node as usize];
                let (target, count) = (link.target() as usize, link.count() as usize);
                if count == 0 {
                    landing.word = link.target();
                    return false;
                }
                let query = &descriptors[*descriptor as usize * each..][..each];
                let children = &self.descriptors[target * each..(target + count) * each];
                *node = (target + nearest(query, children)) as u32;
                if level <= group_level {
                    landing.node = *node;
                }
                true
            });
        }
        landings
    }
}
