//! A measurement: what a confirmed loop, or a plan, says of where two sessions lie to each other.

use crate::domain::change::Loop;
use crate::domain::ids::{LoopId, SessionSeq};
use crate::geometry::{Point3, Pose, Sim3};
use crate::recognition::extensions::tracked_path::TURN_PER_DRIFT_SHARE;
use crate::recognition::map::index::{MapIndex, Milestone};

/// The error that a verified transformation may have where nothing was driven, in metres: twice the median of EuRoC's (`proofs/frames`).
pub const LOOP_SLACK_M: f64 = 0.3;
/// And in rotation, in radians.
pub const LOOP_SLACK_RAD: f64 = 0.1;

/// The relation of two sessions by one loop, or by one alignment to a plan.
#[derive(Clone, Debug, PartialEq)]
pub struct Measurement {
    /// The loop; none for a plan.
    pub loop_id: Option<LoopId>,
    /// The session of the candidate, or the plan's frame.
    pub a: SessionSeq,
    /// The session of the keyframe.
    pub b: SessionSeq,
    /// Maps points of b's frame into a's.
    pub a_from_b: Pose,
    /// The place where it was measured, in the frame of a.
    pub at_a: Place,
    /// And in the frame of b.
    pub at_b: Place,
    /// The error that it may have where nothing was driven, in metres.
    pub slack_m: f64,
    /// The error that it may have in rotation, in radians.
    pub slack_rad: f64,
    /// The share of a way that tracking may drift on it.
    pub drift_share: f64,
}

/// A place in a session: the camera of a keyframe, or the middle of what a plan aligns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// The place, in the session's frame.
    pub at: Point3,
    /// The place on the session's way; none for a plan.
    pub milestone: Option<Milestone>,
}

impl Measurement {
    /// Returns what a loop between two sessions, or within one, says; none if a keyframe is gone.
    pub fn of_loop(index: &MapIndex, closed: &Loop, candidate_from_query: &Sim3) -> Option<Self> {
        let settings = &index.properties().settings;
        let (query, candidate) = (index.keyframe(closed.keyframe)?, index.keyframe(closed.candidate)?);
        let [a, b] = [candidate, query].map(|keyframe| keyframe.map_from_camera);
        let place = |pose: &Pose, seq| Place { at: pose.centre(), milestone: index.milestone(seq) };
        Some(Self {
            loop_id: Some(closed.id.clone()),
            a: candidate.session,
            b: query.session,
            a_from_b: a.after(&candidate_from_query.without_scale()).after(&b.inverse()),
            at_a: place(&a, candidate.seq),
            at_b: place(&b, query.seq),
            slack_m: LOOP_SLACK_M,
            slack_rad: TURN_PER_DRIFT_SHARE.mul_add(settings.odometry_max_drift_share, LOOP_SLACK_RAD),
            drift_share: settings.odometry_max_drift_share,
        })
    }

    /// Returns the same the other way round.
    pub fn reversed(&self) -> Self {
        Self {
            a: self.b,
            b: self.a,
            a_from_b: self.a_from_b.inverse(),
            at_a: self.at_b,
            at_b: self.at_a,
            ..self.clone()
        }
    }

    /// Returns how far another transformation between the two sessions has it elsewhere, in metres at the place where it was
    /// measured, and in radians.
    pub fn off(&self, a_from_b: &Pose) -> (f64, f64) {
        let off_m = (self.a_from_b.transform(&self.at_b.at) - a_from_b.transform(&self.at_b.at)).norm();
        (off_m, self.a_from_b.isometry().rotation.angle_to(&a_from_b.isometry().rotation))
    }

    /// Returns how far two of the same two sessions may be off from each other, in metres.
    pub fn allowed_m(&self, other: &Self) -> f64 {
        let way_m = self.at_a.way_to_m(&other.at_a) + self.at_b.way_to_m(&other.at_b);
        self.drift_share.mul_add(way_m, self.slack_m.max(other.slack_m))
    }

    /// Whether two of the same two sessions can both be right.
    pub fn agrees(&self, other: &Self) -> bool {
        let allowed_m = self.allowed_m(other);
        let (there, back) = (self.off(&other.a_from_b), other.off(&self.a_from_b));
        there.0.max(back.0) <= allowed_m && there.1 <= self.slack_rad.max(other.slack_rad)
    }
}

impl Place {
    /// Returns the way to another place of the session, in metres: as it was driven, or straight where tracking was lost on it.
    pub fn way_to_m(&self, other: &Self) -> f64 {
        let driven = self.milestone.zip(other.milestone).and_then(|(from, to)| from.way_to_m(&to));
        driven.unwrap_or_else(|| (self.at - other.at).norm())
    }
}
