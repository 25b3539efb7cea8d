//! Matching the binary descriptors of two keyframes: by the vocabulary's nodes where both have them, else all with all.

use super::descriptor_match::Match;
use super::group_matching::{Acceptance, GroupMatching};
use super::limits::MatchingLimits;
use super::orientation::keep_consistent_rotations;
use crate::domain::keyframe::Keypoint;
use crate::geometry::hamming::PackedDescriptors;
use crate::geometry::instruction_set::dispatch;
use crate::vocabulary::FeatureGroups;

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
    let sides = sides.map(|(a, b)| [by_node(query.features, a), by_node(candidate.features, b)]);
    let groups = match &sides {
        Some([of_query, of_candidate]) => of_query.common(of_candidate).collect(),
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

/// Groups the features that have a node. Only those of one node are compared, as ORB-SLAM's `SearchByBoW` does.
fn by_node(features: &[u32], nodes: &[u32]) -> FeatureGroups {
    let node_of = |feature: &u32| nodes[*feature as usize];
    let placed = features.iter().filter(|feature| node_of(feature) != NO_NODE);
    FeatureGroups::of(placed.map(|feature| u64::from(node_of(feature)) << 32 | u64::from(*feature)).collect())
}

#[cfg(test)]
mod tests;
