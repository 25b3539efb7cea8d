//! A keyframe's features, ready to be matched: descriptors packed, points by number.

use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

use super::points_now::PointsNow;
use crate::domain::ids::{KeyframeSeq, PointId};
use crate::domain::keyframe::{Features, Keypoint};
use crate::geometry::hamming::PackedDescriptors;
use crate::recognition::verification::descriptor_matching::NO_NODE;

/// Features as the verification reads them; the lists run in parallel. Immutable, but for the map points: [`Self::observing`].
#[derive(Clone, Debug)]
pub struct MatchableFeatures {
    /// Where each was taken.
    pub keypoints: Vec<Keypoint>,
    /// The descriptors.
    pub descriptors: PackedDescriptors,
    /// The map point each observes, if any.
    pub map_points: Vec<Option<PointId>>,
    /// The vocabulary's node of each; `None` without a vocabulary.
    pub nodes: Option<Vec<u32>>,
}

/// The features that were read for a query.
#[derive(Clone, Debug, Default)]
pub struct FeatureSet {
    /// The query's own, if it is not stored.
    pub inline: Option<Arc<MatchableFeatures>>,
    /// Those of the map's keyframes.
    pub stored: BTreeMap<KeyframeSeq, Arc<MatchableFeatures>>,
}

impl MatchableFeatures {
    /// Returns the features with the map points that they observe now.
    pub fn observing(&self, points: &PointsNow) -> Self {
        let map_points = self.map_points.iter().map(|sent| points.now((*sent)?)).collect();
        Self { map_points, ..self.clone() }
    }

    /// Packs the features of a keyframe; `None` if their lists do not fit together.
    pub fn of(features: Features) -> Option<Self> {
        let descriptors = PackedDescriptors::from_bytes(features.descriptor_bytes, &features.descriptors)?;
        let count = descriptors.len();
        (features.keypoints.len() == count && features.map_points.len() == count).then_some(Self {
            keypoints: features.keypoints,
            descriptors,
            map_points: features.map_points,
            nodes: None,
        })
    }

    /// Returns how many pairs of descriptors a matching compares: all, or where both are grouped by a vocabulary's nodes, those of
    /// each node.
    pub fn comparisons(&self, other: &Self) -> u64 {
        let Some((own, theirs)) = self.nodes.as_ref().zip(other.nodes.as_ref()) else {
            return self.descriptors.len() as u64 * other.descriptors.len() as u64;
        };
        let mut of_node: HashMap<u32, u64> = HashMap::new();
        for node in own.iter().filter(|node| **node != NO_NODE) {
            *of_node.entry(*node).or_default() += 1;
        }
        theirs.iter().filter_map(|node| of_node.get(node)).sum()
    }

    /// Returns how much memory they take.
    pub fn heap_bytes(&self) -> usize {
        let count = self.keypoints.len();
        let nodes = self.nodes.as_ref().map_or(0, |nodes| nodes.len() * size_of::<u32>());
        count * (size_of::<Keypoint>() + size_of::<Option<PointId>>())
            + self.descriptors.len() * self.descriptors.words_each() * size_of::<u64>()
            + nodes
    }
}
