//! Trajectory: poses as the field's own tools read them: TUM's and KITTI's lines, and g2o's graph.

mod g2o;
mod lines;
mod measured;

pub use measured::MeasuredLoop;

use std::borrow::Cow;

use self::g2o::g2o;
use self::lines::{kitti, tum};
use crate::domain::invalid::FieldError;
use crate::domain::trajectory::{SessionTrack, TrackedPose, TrajectoryReport};

/// A format of trajectories.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TrajectoryFormat {
    /// Lines of `seconds x y z qx qy qz qw`.
    Tum,
    /// Lines of twelve numbers, the upper three rows of the pose.
    Kitti,
    /// A pose graph: every session, and loops between them.
    G2o,
}

impl TrajectoryFormat {
    /// The formats' names.
    pub const NAMES: [&str; 3] = ["tum", "kitti", "g2o"];

    /// Returns the format of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        [Self::Tum, Self::Kitti, Self::G2o]
            .into_iter()
            .zip(Self::NAMES)
            .find_map(|(it, its)| (its == name).then_some(it))
    }
}

/// Writes a trajectory; `measured` are the transformations of its loops, which only g2o takes.
///
/// # Errors
///
/// A format of lines, several sessions, and none chosen.
pub fn write_trajectory(
    report: &TrajectoryReport,
    measured: &[Option<MeasuredLoop>],
    format: TrajectoryFormat,
) -> Result<String, FieldError> {
    match format {
        TrajectoryFormat::Tum => Ok(one_track(report)?.map(|track| tum(&track)).unwrap_or_default()),
        TrajectoryFormat::Kitti => Ok(one_track(report)?.map(|track| kitti(&track)).unwrap_or_default()),
        TrajectoryFormat::G2o => Ok(g2o(report, measured)),
    }
}

/// Returns the one session of a trajectory: its lines say nothing of sessions, and each of these has a frame of its
/// own; or all of them by stamp, where they are in one frame.
fn one_track(report: &TrajectoryReport) -> Result<Option<Cow<'_, SessionTrack>>, FieldError> {
    match report.sessions.as_slice() {
        [] => Ok(None),
        [one] => Ok(Some(Cow::Borrowed(one))),
        [first, ..] if report.is_in_one_frame => {
            let all = report.sessions.iter().flat_map(|track| track.keyframes.iter().cloned());
            let mut keyframes: Vec<TrackedPose> = all.collect();
            keyframes.sort_by_key(|pose| (pose.stamp.sec, pose.stamp.nanosec));
            Ok(Some(Cow::Owned(SessionTrack { session: first.session.clone(), keyframes })))
        }
        several => {
            let names: Vec<&str> = several.iter().take(10).map(|track| track.session.as_str()).collect();
            let detail = "the map has several sessions, each with a frame of its own: name one";
            Err(FieldError::new("?session", detail).got(format!(
                "{} sessions: {}",
                several.len(),
                names.join(", ")
            )))
        }
    }
}

#[cfg(test)]
mod tests;
