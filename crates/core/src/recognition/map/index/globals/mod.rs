//! Global descriptors of a map's keyframes, in blocks that a search reads from end to end.
//!
//! | file | concept |
//! |---|---|
//! | `block` | the descriptors of keyframes with neighbouring numbers |
//! | `search` | how alike one is to all of them |

mod block;
mod search;
#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests;

use std::collections::BTreeMap;

use self::block::Block;
use crate::domain::bow::Score;
use crate::domain::global_descriptor::{GlobalDescriptor, GlobalForm};
use crate::domain::ids::KeyframeSeq;

/// The global descriptors of a map, all of one form.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Globals {
    /// `None` while there are none.
    form: Option<GlobalForm>,
    /// By the keyframes' numbers divided by [`Block::KEYFRAMES`]; none is empty.
    blocks: BTreeMap<u32, Block>,
    count: usize,
}

impl Globals {
    /// Returns the form of the map's descriptors; `None` while there are none.
    pub fn form(&self) -> Option<&GlobalForm> {
        self.form.as_ref()
    }

    /// Whether a descriptor can be compared with those of the map.
    pub fn takes(&self, descriptor: &GlobalDescriptor) -> bool {
        self.form().is_none_or(|form| descriptor.is_of(form))
    }

    /// Returns the number of descriptors.
    pub fn len(&self) -> usize {
        self.count
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Returns a keyframe's descriptor, if it has one.
    pub fn get(&self, keyframe: KeyframeSeq) -> Option<GlobalDescriptor> {
        let data = self.blocks.get(&Block::number(keyframe))?.get(keyframe)?;
        let GlobalForm { model, encoding, .. } = self.form()?.clone();
        Some(GlobalDescriptor { model, encoding, data: data.into() })
    }

    /// Appends the likeness of every descriptor to one of the same form, ascending by keyframe: the cosine of the two vectors, 0
    /// where it is negative, bits counting as 1 and -1. Nothing is appended for one of another form.
    pub fn score_all(&self, sought: &GlobalDescriptor, scores: &mut Vec<(u32, Score)>) {
        if self.takes(sought) {
            scores.reserve(self.count);
            search::score_all(&self.blocks, sought, scores);
        }
    }

    /// Returns what they take in memory, in bytes, up to what growing lists leave free.
    pub(super) fn heap_bytes(&self) -> usize {
        self.form().map_or(0, |form| self.count * Block::row_bytes(form))
    }

    /// Adds the descriptor of a keyframe; one of another form is left out.
    pub(super) fn insert(&mut self, keyframe: KeyframeSeq, descriptor: &GlobalDescriptor) {
        if !self.takes(descriptor) {
            return;
        }
        self.form.get_or_insert_with(|| descriptor.form());
        let block = self.blocks.entry(Block::number(keyframe)).or_default();
        self.count += usize::from(block.insert(keyframe, descriptor));
    }

    /// Removes the descriptor of a keyframe, if it has one.
    pub(super) fn remove(&mut self, keyframe: KeyframeSeq) {
        let number = Block::number(keyframe);
        let Some(block) = self.blocks.get_mut(&number) else { return };
        self.count -= usize::from(block.remove(keyframe));
        if block.is_empty() {
            self.blocks.remove(&number);
        }
        if self.count == 0 {
            // The next one may be of any model.
            self.form = None;
        }
    }
}
