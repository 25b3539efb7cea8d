//! The descent: descriptors go down the tree, all of them level by level.
//!
//! A million words do not fit the caches near the processor. Level by level, it is known ahead which children the
//! next descriptors will be compared with: they are touched first, a batch at a time, so that the memory answers
//! for all of them at once. Measured with a million words, that takes 0.22 ms for 1,000 descriptors instead of 0.40.

use std::hint::black_box;

use super::arrays::Parts;
use super::flat_tree::Vocabulary;
use super::link::Link;
use super::nearest::{ANY, nearest_of};
use crate::geometry::instruction_set::{Kernel, dispatch};

/// Descriptors whose children are touched at once: enough to keep the memory busy, few enough that the
/// children of all (20 KB with ten each) are still in the nearest cache when their turn comes.
const BATCH: usize = 64;

/// 64-bit words in a cache line.
const LINE_WORDS: usize = 8;

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
    pub(super) fn descend(&self, queries: &[u64], group_level: u32) -> Vec<Landing> {
        let (parts, each) = (self.arrays.parts(), self.descriptor_words());
        match each {
            4 => dispatch(Descent::<4> { parts, each, queries, group_level }),
            6 => dispatch(Descent::<6> { parts, each, queries, group_level }),
            8 => dispatch(Descent::<8> { parts, each, queries, group_level }),
            _ => dispatch(Descent::<ANY> { parts, each, queries, group_level }),
        }
    }
}

/// Descriptors on their way down: `each` words long, which are `N` unless that is [`ANY`].
struct Descent<'a, const N: usize> {
    parts: Parts<'a>,
    each: usize,
    queries: &'a [u64],
    group_level: u32,
}

impl<const N: usize> Kernel for Descent<'_, N> {
    type Output = Vec<Landing>;

    #[inline(always)]
    fn run<const POPCNT: bool>(self) -> Vec<Landing> {
        let each = self.each();
        let count = self.queries.len() / each;
        let mut landings = vec![Landing { word: 0, node: 0 }; count];
        // The descriptors still on their way, each with the node it has come to.
        let mut open: Vec<(u32, u32)> = (0..count as u32).map(|descriptor| (descriptor, 0)).collect();
        let mut level = 0;
        while !open.is_empty() {
            level += 1;
            let mut still_open = 0;
            for batch in (0..open.len()).step_by(BATCH) {
                let batch = batch..(batch + BATCH).min(open.len());
                let mut links = [Link::word(0); BATCH];
                for (link, &(_, node)) in links.iter_mut().zip(&open[batch.clone()]) {
                    *link = self.parts.link(node);
                }
                self.touch_children(&links[..batch.len()]);
                for (at, link) in batch.zip(links) {
                    let (descriptor, _) = open[at];
                    let landing = &mut landings[descriptor as usize];
                    if link.count() == 0 {
                        landing.word = link.target();
                        continue;
                    }
                    let query = &self.queries[descriptor as usize * each..][..each];
                    let node = link.target() + nearest_of::<POPCNT, N>(query, self.children(link)) as u32;
                    if level <= self.group_level {
                        landing.node = node;
                    }
                    open[still_open] = (descriptor, node);
                    still_open += 1;
                }
            }
            open.truncate(still_open);
        }
        landings
    }
}

impl<const N: usize> Descent<'_, N> {
    #[inline(always)]
    fn each(&self) -> usize {
        if N == ANY { self.each } else { N }
    }

    /// Returns the children's descriptors, one after the other; none of a leaf.
    #[inline(always)]
    fn children(&self, link: Link) -> &[u64] {
        let (each, count) = (self.each(), link.count() as usize);
        let first = if count == 0 { 0 } else { link.target() as usize };
        &self.parts.descriptors[first * each..(first + count) * each]
    }

    /// Reads a word of each cache line: none of these reads waits for another.
    #[inline(always)]
    fn touch_children(&self, links: &[Link]) {
        let mut touched = 0;
        for &link in links {
            for word in self.children(link).iter().step_by(LINE_WORDS) {
                touched ^= word;
            }
        }
        black_box(touched);
    }
}
