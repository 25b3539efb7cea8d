//! Matching the binary descriptors of two keyframes: by the vocabulary's nodes where both have them, else all with all.

use std::ops::Range;

use super::descriptor_match::Match;
use super::group_matching::{Acceptance, GroupMatching};
use super::limits::MatchingLimits;
use super::orientation::keep_consistent_rotations;
use crate::domain::keyframe::Keypoint;
use crate::geometry::hamming::PackedDescriptors;
use crate::geometry::instruction_set::dispatch;

/// The node of a feature that has none, such as one whose word has weight 0.
pub const NO_NODE: u32 = u32::MAX;

/// One side of a matching: some features of a keyframe.
#[derive(Clone, Copy, Debug)]
pub struct Side<'a> {
    /// The descriptors of all features.
    pub descriptors: &'a PackedDescriptors,
    /// The keypoints of all features.
    pub keypoints: &'a [Keypoint],
    /// The vocabulary's node of each feature, or [`NO_NODE`].
    pub nodes: Option<&'a [u32]>,
    /// The features that take part, ascending.
    pub features: &'a [u32],
}

/// Returns the matches, ascending by the query's feature. Ties in distance go to the first feature, and fail the ratio
/// test.
pub fn match_descriptors(query: &Side, candidate: &Side, limits: &MatchingLimits) -> Vec<Match> {
    if query.descriptors.words_each() != candidate.descriptors.words_each() {
        return Vec::new();
    }
    let acceptance = Acceptance::new(limits, query.descriptors.bits());
    let sides = query.nodes.zip(candidate.nodes);
    let sides = sides.map(|(a, b)| [ByNode::of(query.features, a), ByNode::of(candidate.features, b)]);
    let groups = match &sides {
        Some([of_query, of_candidate]) => by_nodes(of_query, of_candidate),
        None => vec![(query.features, candidate.features)],
    };
    let mut matches = dispatch(GroupMatching {
        query: query.descriptors,
        candidate: candidate.descriptors,
        groups: &groups,
        acceptance,
    });
    matches.sort_unstable_by_key(|found| (found.query, found.candidate));
    if limits.orientation {
        keep_consistent_rotations(&mut matches, query.keypoints, candidate.keypoints);
    }
    matches
}

/// Only features of one node are compared, as ORB-SLAM's `SearchByBoW` does.
fn by_nodes<'a>(of_query: &'a ByNode, of_candidate: &'a ByNode) -> Vec<(&'a [u32], &'a [u32])> {
    let mut groups = Vec::with_capacity(of_query.groups.len());
    let mut others = of_candidate.groups.iter().peekable();
    for (node, features) in &of_query.groups {
        while others.next_if(|(other, _)| other < node).is_some() {}
        if let Some((_, same)) = others.next_if(|(other, _)| other == node) {
            groups.push((&of_query.features[features.clone()], &of_candidate.features[same.clone()]));
        }
    }
    groups
}

/// The features of one side, node by node.
struct ByNode {
    features: Vec<u32>,
    /// Each node and where its features are; the nodes ascend.
    groups: Vec<(u32, Range<usize>)>,
}

impl ByNode {
    fn of(features: &[u32], nodes: &[u32]) -> Self {
        let node_of = |&feature: &u32| nodes[feature as usize];
        let placed = features.iter().filter(|feature| node_of(feature) != NO_NODE);
        // The node above, the feature below: one comparison of integers orders both.
        let mut sorted: Vec<u64> =
            placed.map(|feature| u64::from(node_of(feature)) << 32 | u64::from(*feature)).collect();
        sorted.sort_unstable();
        let mut groups: Vec<(u32, Range<usize>)> = Vec::new();
        for (at, pair) in sorted.iter().enumerate() {
            let node = (pair >> 32) as u32;
            match groups.last_mut() {
                Some((last, range)) if *last == node => range.end = at + 1,
                _ => groups.push((node, at..at + 1)),
            }
        }
        Self { features: sorted.iter().map(|&pair| pair as u32).collect(), groups }
    }
}

#[cfg(test)]
mod tests;
