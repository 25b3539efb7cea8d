//! Odometry against a transformation: a loop may not contradict the robot's own tracking (M15).
//!
//! Along an unbroken chain of keyframes that share map points the robot knew where it went, up to a drift that grows with
//! the way. A transformation that puts it somewhere else than the chain allows is a door taken for the next one. Right
//! transformations are off odometry by 2.6 % of the way at most, wrong ones by 19 % at the median.

use nalgebra::Vector3;

use super::way_by_loops::way_by_loops_um;
use crate::domain::ids::KeyframeSeq;
use crate::domain::settings::Settings;
use crate::geometry::{Pose, Sim3};
use crate::recognition::map::index::{MapIndex, UM_PER_M};

/// The turn that is allowed for each whole of the drift share s, in radians. A heading that scatters along a way of length L
/// is off by sqrt(3) s radians at its end where it has moved the place by s L.
pub(in crate::recognition) const TURN_PER_DRIFT_SHARE: f64 = 2.0;
/// And this much the heading may be off on any way, in radians: what a transformation between far views errs by.
pub(in crate::recognition) const TURN_SLACK_RAD: f64 = 0.35;

/// The unbroken way from the candidate to the query, and where odometry has the two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackedPath {
    /// Its length, in metres.
    pub length_m: f64,
    candidate_from_query: Pose,
}

/// By how much a transformation is off from odometry, beyond what drift explains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Discrepancy {
    /// In place, in metres.
    Metres {
        /// The deviation.
        off: f64,
        /// The deviation that drift explains.
        limit: f64,
    },
    /// In heading, in radians.
    Radians {
        /// The deviation.
        off: f64,
        /// The deviation that drift explains.
        limit: f64,
    },
}

/// A transformation may be off odometry by this on any way, in metres.
pub(in crate::recognition) const SLACK_M: f64 = 1.0;

/// Returns how far off odometry may be after a way, in metres; `at_rest_m` where nothing was driven.
pub fn drift_m(way_m: f64, at_rest_m: f64, settings: &Settings) -> f64 {
    settings.odometry_max_drift_share.mul_add(way_m, at_rest_m)
}

impl TrackedPath {
    /// Returns the way between two keyframes of one session, if tracking was not lost on it.
    pub fn between(index: &MapIndex, query: KeyframeSeq, candidate: KeyframeSeq) -> Option<Self> {
        let length_m = index.milestone(query)?.way_to_m(&index.milestone(candidate)?)?;
        let (query, candidate) = (index.keyframe(query)?, index.keyframe(candidate)?);
        let candidate_from_query = candidate.map_from_camera.inverse().after(&query.map_from_camera);
        Some(Self { length_m, candidate_from_query })
    }

    /// Returns the same for the shortest way along tracked steps and through confirmed loops, which correct the poses of their
    /// ends; none if on that way odometry may be off by more than `most_m`.
    pub fn by_loops(
        index: &MapIndex,
        query: KeyframeSeq,
        candidate: KeyframeSeq,
        most_m: f64,
    ) -> Option<Self> {
        let settings = &index.properties().settings;
        let metres = |way_um: u64| way_um as f64 / UM_PER_M;
        let is_short = |way_um| drift_m(metres(way_um), SLACK_M, settings) <= most_m;
        let length_m = metres(way_by_loops_um(index, query, candidate, is_short)?);
        let (query, candidate) = (index.keyframe(query)?, index.keyframe(candidate)?);
        let candidate_from_query = candidate.map_from_camera.inverse().after(&query.map_from_camera);
        Some(Self { length_m, candidate_from_query })
    }

    /// Returns what drift along the way does not explain; none if it explains everything.
    pub fn discrepancy(&self, candidate_from_query: &Sim3, settings: &Settings) -> Option<Discrepancy> {
        let odometry = self.candidate_from_query.isometry();
        let [x, y, z] = candidate_from_query.translation_m();
        let off = (Vector3::new(x, y, z) - odometry.translation.vector).norm();
        let limit = drift_m(self.length_m, SLACK_M, settings);
        if off > limit {
            return Some(Discrepancy::Metres { off, limit });
        }
        let off = candidate_from_query.rotation().angle_to(&odometry.rotation);
        let limit = TURN_PER_DRIFT_SHARE.mul_add(settings.odometry_max_drift_share, TURN_SLACK_RAD);
        (off > limit).then_some(Discrepancy::Radians { off, limit })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::UnitQuaternion;

    #[test]
    fn a_robot_off_by_a_twentieth_of_the_way_cannot_be_turned_round_however_long_it_is() {
        let settings = Settings::default();
        let turned = |rad: f64, length_m: f64| {
            let path = TrackedPath { length_m, candidate_from_query: Pose::identity() };
            let turn = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), rad);
            path.discrepancy(&Sim3::from_parts(1.0, turn, Vector3::zeros()), &settings)
        };
        // 0.35 + 2 * 0.05 rad.
        for length_m in [0.0, 50.0, 5_000.0] {
            assert_eq!(turned(0.44, length_m), None, "{length_m} m");
            assert!(matches!(turned(0.46, length_m), Some(Discrepancy::Radians { .. })), "{length_m} m");
            assert!(matches!(turned(2.1, length_m), Some(Discrepancy::Radians { .. })), "{length_m} m");
        }
    }
}
