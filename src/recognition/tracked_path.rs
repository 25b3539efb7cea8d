//! How far the robot drove between two keyframes without losing track: what odometry has to say about a loop.
//!
//! Along a chain of keyframes that share map points the robot knew where it went, up to a drift that grows with the way. A
//! transformation that puts it somewhere else than a short chain allows is a door taken for the next one. The paper has
//! nothing of the kind; it counts as part of "the anchors must agree with the transformation" (`aligned_anchors`), because
//! the anchors stand where odometry put them. Only shared map points make a chain: a confirmed loop joins keyframes whose
//! poses its client may not have corrected yet.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashMap};

use nalgebra::Vector3;

use super::index::MapIndex;
use crate::geometry::{Pose, Sim3};
use crate::model::ids::KeyframeSeq;

/// Chains longer than this are not looked for: drift explains anything at their end.
const LONGEST_M: f64 = 50.0;
/// No tracked way drifts by more than this share of its length; visual odometry that works at all drifts by 1 to 5 %.
const MAX_DRIFT_SHARE: f64 = 0.25;
/// And this much may be off on any way: what a transformation between far views errs by, in metres.
const MARGIN_M: f64 = 1.0;
/// Nor does its heading drift by more than this, in radians a metre.
const MAX_TURN_RAD_PER_M: f64 = 0.05;
/// And this much it may be off on any way, in radians.
const MARGIN_RAD: f64 = 0.35;

/// A chain of keyframes from the candidate to the query, and where odometry has the two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackedPath {
    /// How long the shortest chain is, in metres.
    pub length_m: f64,
    candidate_from_query: Pose,
}

/// By how much a transformation is off from odometry, beyond what drift explains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Discrepancy {
    /// In place, in metres.
    Metres {
        /// How far off.
        off: f64,
        /// How far drift may have brought it.
        limit: f64,
    },
    /// In heading, in radians.
    Radians {
        /// How far off.
        off: f64,
        /// How far drift may have turned it.
        limit: f64,
    },
}

impl TrackedPath {
    /// What drift along the way does not explain; none if it explains everything.
    pub fn discrepancy(&self, candidate_from_query: &Sim3) -> Option<Discrepancy> {
        let odometry = self.candidate_from_query.isometry();
        let [x, y, z] = candidate_from_query.translation_m();
        let off = (Vector3::new(x, y, z) - odometry.translation.vector).norm();
        let limit = MAX_DRIFT_SHARE.mul_add(self.length_m, MARGIN_M);
        if off > limit {
            return Some(Discrepancy::Metres { off, limit });
        }
        let off = candidate_from_query.rotation().angle_to(&odometry.rotation);
        let limit = MAX_TURN_RAD_PER_M.mul_add(self.length_m, MARGIN_RAD);
        (off > limit).then_some(Discrepancy::Radians { off, limit })
    }
}

/// The keyframes that chains from the query reach, each with its shortest.
#[derive(Clone, Debug, Default)]
pub struct TrackedPaths {
    lengths_m: HashMap<KeyframeSeq, f64>,
}

impl TrackedPaths {
    /// Looks for chains from a stored keyframe (E. W. Dijkstra, 1959).
    pub fn from(index: &MapIndex, query: KeyframeSeq) -> Self {
        let mut lengths_m = HashMap::from([(query, 0.0)]);
        // Lengths are not negative, so their bits sort as they do.
        let mut open = BinaryHeap::from([Reverse((0_u64, query))]);
        while let Some(Reverse((bits, keyframe))) = open.pop() {
            let length_m = f64::from_bits(bits);
            let Some(from) = index.keyframe(keyframe) else { continue };
            if lengths_m.get(&keyframe).is_some_and(|known| *known < length_m) {
                continue;
            }
            for next in index.covisibility().sharing_points(keyframe) {
                let Some(to) = index.keyframe(next) else { continue };
                let step_m = (to.map_from_camera.centre() - from.map_from_camera.centre()).norm();
                let reached_m = length_m + step_m;
                let is_shorter = lengths_m.get(&next).is_none_or(|known| reached_m < *known);
                if reached_m <= LONGEST_M && is_shorter {
                    lengths_m.insert(next, reached_m);
                    open.push(Reverse((reached_m.to_bits(), next)));
                }
            }
        }
        Self { lengths_m }
    }

    /// The chain to a candidate, if there is one.
    pub fn to(&self, index: &MapIndex, query: KeyframeSeq, candidate: KeyframeSeq) -> Option<TrackedPath> {
        let length_m = *self.lengths_m.get(&candidate)?;
        let (query, candidate) = (index.keyframe(query)?, index.keyframe(candidate)?);
        let candidate_from_query = candidate.map_from_camera.inverse().after(&query.map_from_camera);
        Some(TrackedPath { length_m, candidate_from_query })
    }
}
