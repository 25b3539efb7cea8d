//! Counts that the estimate of memory and the size on disk rest on.

use crate::domain::anchor::Observation;
use crate::domain::change::Keyframe;

/// Counts that no structure of the index keeps by itself.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Tally {
    /// Of the lists of points that keyframes observe.
    pub observed_bytes: u64,
    /// Of the keyframes, on disk.
    pub keyframe_bytes: u64,
    pub observations: u64,
    pub anchor_points: u64,
}

impl Tally {
    /// Counts a keyframe that arrived.
    pub fn add_keyframe(&mut self, keyframe: &Keyframe) {
        self.observed_bytes += observed_bytes(keyframe);
        self.keyframe_bytes += keyframe.bytes;
    }

    /// Forgets a keyframe that is gone.
    pub fn remove_keyframe(&mut self, keyframe: &Keyframe) {
        self.observed_bytes -= observed_bytes(keyframe);
        self.keyframe_bytes -= keyframe.bytes;
    }

    /// Counts an observation of an anchor.
    pub fn add_observation(&mut self, observation: &Observation) {
        self.observations += 1;
        self.anchor_points += observation.map_points.len() as u64;
    }

    /// Forgets an observation that is gone.
    pub fn remove_observation(&mut self, observation: &Observation) {
        self.observations -= 1;
        self.anchor_points -= observation.map_points.len() as u64;
    }
}

fn observed_bytes(keyframe: &Keyframe) -> u64 {
    let renamed = keyframe.renamed.as_ref().map_or(0, |renamed| size_of_val(&*renamed.pairs));
    (keyframe.observes.heap_bytes() + renamed) as u64
}
