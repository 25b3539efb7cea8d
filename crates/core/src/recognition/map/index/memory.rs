//! What an index takes in memory, estimated from counts that are at hand: the one place to calibrate it.
//!
//! The budget of maps in memory (`engine/maps/eviction.rs`) rests on this estimate, so it may not cost a walk over the map. Each
//! constant is the growth of a process per thing counted, with the allocator's own share. `proofs/evict` holds the sum
//! against the resident memory of a server and fails beyond a factor of two.

use super::map_index::MapIndex;
use super::tally::Tally;

/// An index that holds nothing, with the locks and queues of a map in memory.
const MAP: u64 = 6 * 1024;

/// A keyframe: its facts, its name twice, its slots in the tables by number, and its step in the odometer.
const KEYFRAME: u64 = 772;

/// A keyframe in another one's list of neighbours, with what growing lists leave free.
const NEIGHBOUR: u64 = 12;

/// An anchor and the object that it belongs to: a dozen trees with few entries, each with room for eleven.
const ANCHOR: u64 = 8_500;

/// An observation of an anchor, with its reading, which the list of readings alike keeps as well.
const OBSERVATION: u64 = 450;

/// A map point of an observation: in it, in the anchor's shape, in the object's, and among the holders of the point.
const ANCHOR_POINT: u64 = 170;

/// A distinct text, with its words and its matches.
const TEXT: u64 = 2_500;

/// A verdict of a model about texts.
const VERDICT: u64 = 400;

impl MapIndex {
    /// Returns about how much memory the index takes, in bytes. Its cost does not grow with the map.
    pub fn memory_bytes(&self) -> u64 {
        let Tally { observed_bytes, observations, anchor_points, .. } = self.tally;
        MAP + self.keyframe_count() as u64 * KEYFRAME
            + observed_bytes
            + self.points.heap_bytes() as u64
            + self.lists.entry_count() * NEIGHBOUR
            + self.objects.anchor_count() as u64 * ANCHOR
            + observations * OBSERVATION
            + anchor_points * ANCHOR_POINT
            + self.texts.len() as u64 * TEXT
            + self.texts.verdicts().len() as u64 * VERDICT
            + self.inverted_file.heap_bytes() as u64
            + self.globals.heap_bytes() as u64
    }
}
