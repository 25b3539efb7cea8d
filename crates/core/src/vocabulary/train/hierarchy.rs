//! The tree grown from the root: clusters are split until they are words, then weighed.

use std::collections::VecDeque;
use std::ops::Range;

use super::cluster::split;
use super::error::TrainError;
use super::set::TrainingSet;
use crate::geometry::sampling::SplitMix64;
use crate::vocabulary::flat_tree::Vocabulary;
use crate::vocabulary::shape::Shape;
use crate::vocabulary::tree::Tree;
use crate::vocabulary::tree_fault::TreeFault;

/// Settings of a training.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TrainSettings {
    /// k: into how many clusters a node is split.
    pub branching: u32,
    /// L: how many times.
    pub levels: u32,
    /// Draws the first centres of the clusters.
    pub seed: u64,
    /// Maximum rounds of a split.
    pub rounds_max: u32,
}

impl Default for TrainSettings {
    /// 9^4 words, as the recordings' own vocabularies have.
    fn default() -> Self {
        Self { branching: 9, levels: 4, seed: 0, rounds_max: 12 }
    }
}

/// Progress of a training.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// Descriptors that have come down a level, summed over the levels.
    pub done: u64,
    /// Its value at the end.
    pub total: u64,
}

/// A cluster whose node stands in the tree already.
struct Cluster {
    node: u64,
    level: u32,
    /// Its members, a range of the descriptors in their present order.
    members: Range<usize>,
}

/// Trains a vocabulary; a word is the rarer, and weighs the more, the fewer images have it: ln(N / N_i).
///
/// A cluster of at most k members, or of equal ones, is not split any more: it is a word above the last level.
pub fn train(
    set: &TrainingSet,
    settings: TrainSettings,
    mut progress: impl FnMut(Progress),
) -> Result<Vocabulary, TrainError> {
    let Some(descriptor_bytes) = set.descriptor_bytes() else { return Err(TrainError::NoDescriptors) };
    let TrainSettings { branching, levels, .. } = settings;
    if branching < 2 {
        return Err(TrainError::Branching(branching));
    }
    Tree::check_shape(branching.into(), levels.into())?;
    let tree = Tree::new(Shape { branching, levels, descriptor_bytes });
    let vocabulary = grow(tree, set, settings, &mut progress)?;
    let weights = inverse_document_frequencies(&vocabulary, set);
    Ok(with_weights(vocabulary, weights))
}

fn grow(
    mut tree: Tree,
    set: &TrainingSet,
    settings: TrainSettings,
    progress: &mut impl FnMut(Progress),
) -> Result<Vocabulary, TreeFault> {
    let mut random = SplitMix64::new(settings.seed);
    let mut order: Vec<u32> = (0..set.descriptor_count() as u32).collect();
    let mut open = VecDeque::from([Cluster { node: 0, level: 0, members: 0..order.len() }]);
    let total = order.len() as u64 * u64::from(settings.levels);
    let mut done = 0;
    while let Some(Cluster { node, level, members }) = open.pop_front() {
        let rounds = settings.rounds_max;
        let mut end = members.start;
        for (centre, size) in split(set, &mut order[members], settings.branching, rounds, &mut random) {
            let members = end..end + size;
            end += size;
            let level = level + 1;
            let is_word = level == settings.levels
                || size <= settings.branching as usize
                || set.all_equal(&order[members.clone()]);
            tree.descriptors().extend(centre);
            let node = u64::from(tree.push(node, is_word, 0.0)?);
            done += size as u64;
            if is_word {
                // It has come down the levels below, too.
                done += size as u64 * u64::from(settings.levels - level);
            } else {
                open.push_back(Cluster { node, level, members });
            }
        }
        progress(Progress { done, total });
    }
    tree.finish()
}

/// By word. A word that no image has, or every one, weighs nothing.
fn inverse_document_frequencies(vocabulary: &Vocabulary, set: &TrainingSet) -> Vec<f64> {
    let mut images_with = vec![0_u32; vocabulary.word_count()];
    for image in set.images() {
        let mut words: Vec<u32> = vocabulary.descend(image, 0).iter().map(|landing| landing.word).collect();
        words.sort_unstable();
        words.dedup();
        for word in words {
            images_with[word as usize] += 1;
        }
    }
    let images = f64::from(set.image_count() as u32);
    let weigh = |&with: &u32| if with == 0 { 0.0 } else { libm::log(images / f64::from(with)) };
    images_with.iter().map(weigh).collect()
}

/// Returns the same tree with other weights, by word.
fn with_weights(mut vocabulary: Vocabulary, weights: Vec<f64>) -> Vocabulary {
    debug_assert_eq!(weights.len(), vocabulary.word_count(), "one weight for each word");
    let [_, slots, ..] = vocabulary.arrays.parts_mut();
    for (slot, weight) in slots.iter_mut().zip(weights) {
        *slot = weight.to_bits();
    }
    vocabulary.fingerprint = vocabulary.content_fingerprint();
    vocabulary
}
