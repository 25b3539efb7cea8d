//! A keyframe's features, ready to be matched: descriptors packed, points by number.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::geometry_snapshot::GeometrySnapshot;
use crate::domain::change::Keyframe;
use crate::domain::ids::{KeyframeSeq, PointId};
use crate::domain::keyframe::{Features, Keypoint};
use crate::geometry::hamming::PackedDescriptors;

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

/// What became of the map points that a keyframe's features were sent with, at one version of its map.
#[derive(Clone, Debug)]
pub struct PointsNow {
    renamed: Box<[(PointId, PointId)]>,
    observes: Box<[PointId]>,
}

/// Keyframes whose features are wanted, ascending, each with what became of its map points since it was sent.
#[derive(Clone, Debug, Default)]
pub struct WantedFeatures {
    /// `None` for one whose features observe what they were sent with.
    pub keyframes: BTreeMap<KeyframeSeq, Option<Arc<PointsNow>>>,
}

/// The features that were read for a query.
#[derive(Clone, Debug, Default)]
pub struct FeatureSet {
    /// The query's own, if it is not stored.
    pub inline: Option<Arc<MatchableFeatures>>,
    /// Those of the map's keyframes.
    pub stored: BTreeMap<KeyframeSeq, Arc<MatchableFeatures>>,
}

impl PointsNow {
    /// Returns what became of a keyframe's map points; `None` if nothing did.
    pub fn of(keyframe: &Keyframe) -> Option<Arc<Self>> {
        let renamed = keyframe.renamed.clone()?;
        Some(Arc::new(Self { renamed, observes: keyframe.observes.iter().collect() }))
    }

    /// Returns the map point that a feature observes which was sent with this one, if it observes one still.
    pub fn now(&self, sent: PointId) -> Option<PointId> {
        let at = self.renamed.binary_search_by_key(&sent, |(sent, _)| *sent);
        let now = at.map_or(sent, |at| self.renamed[at].1);
        self.observes.binary_search(&now).is_ok().then_some(now)
    }
}

impl WantedFeatures {
    /// Adds a keyframe of which there is a snapshot, with those whose points join the guided search for it.
    pub(in crate::recognition) fn add(&mut self, keyframe: KeyframeSeq, snapshot: Option<&GeometrySnapshot>) {
        for wanted in snapshot.into_iter().flat_map(|snapshot| &snapshot.window) {
            self.add_alone(*wanted, snapshot);
        }
        self.add_alone(keyframe, snapshot);
    }

    /// Adds a keyframe that this snapshot shows, alone.
    pub(in crate::recognition) fn add_alone(
        &mut self,
        keyframe: KeyframeSeq,
        snapshot: Option<&GeometrySnapshot>,
    ) {
        let known = self.keyframes.entry(keyframe).or_default();
        if known.is_none() {
            *known = snapshot.and_then(|snapshot| snapshot.points_now.get(&keyframe).cloned());
        }
    }

    /// Returns those of one keyframe, with those whose points join the guided search for it.
    pub fn of(keyframe: KeyframeSeq, snapshot: &GeometrySnapshot) -> Self {
        let mut wanted = Self::default();
        wanted.add(keyframe, Some(snapshot));
        wanted
    }

    /// Returns those of one keyframe alone.
    pub fn alone(keyframe: KeyframeSeq, snapshot: &GeometrySnapshot) -> Self {
        let mut wanted = Self::default();
        wanted.add_alone(keyframe, Some(snapshot));
        wanted
    }

    /// Adds those of another list.
    pub fn extend(&mut self, other: Self) {
        self.keyframes.extend(other.keyframes);
    }
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

    /// Returns how much memory they take.
    pub fn heap_bytes(&self) -> usize {
        let count = self.keypoints.len();
        let nodes = self.nodes.as_ref().map_or(0, |nodes| nodes.len() * size_of::<u32>());
        count * (size_of::<Keypoint>() + size_of::<Option<PointId>>())
            + self.descriptors.len() * self.descriptors.words_each() * size_of::<u64>()
            + nodes
    }
}
