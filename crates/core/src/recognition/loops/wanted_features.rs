//! Which features a question needs, with the map points that they observe at its version of the map.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::geometry_snapshot::GeometrySnapshot;
use super::points_now::PointsNow;
use crate::domain::ids::KeyframeSeq;

/// Keyframes whose features are wanted, ascending, each with what became of its map points since it was sent.
#[derive(Clone, Debug, Default)]
pub struct WantedFeatures {
    /// `None` for one whose features observe what they were sent with.
    pub keyframes: BTreeMap<KeyframeSeq, Option<Arc<PointsNow>>>,
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
