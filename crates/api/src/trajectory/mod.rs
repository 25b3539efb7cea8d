//! Trajectory: poses as the field's own tools read them: TUM's and KITTI's lines, and g2o's graph.

mod g2o;
mod lines;
mod measured;

pub use measured::MeasuredLoop;

use std::fmt::Write as _;

use revisit_core::domain::invalid::FieldError;
use revisit_core::domain::trajectory::{SessionTrack, TrajectoryReport};

use self::g2o::g2o;
use self::lines::{kitti, tum};

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
    /// The formats by name.
    pub const NAMED: [(&str, Self); 3] = [("tum", Self::Tum), ("kitti", Self::Kitti), ("g2o", Self::G2o)];
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
        TrajectoryFormat::Tum => Ok(lines(report, tum)?),
        TrajectoryFormat::Kitti => Ok(lines(report, kitti)?),
        TrajectoryFormat::G2o => Ok(g2o(report, measured)),
    }
}

/// Writes the lines of one session, which say nothing of sessions. In the frame of a fleet several follow each other, each after a
/// comment with its name, and comments name those that are left out. evo passes over comments.
fn lines(report: &TrajectoryReport, write: fn(&SessionTrack) -> String) -> Result<String, FieldError> {
    if let (false, [_, _, ..]) = (report.is_in_one_frame, report.sessions.as_slice()) {
        let names: Vec<&str> = report.sessions.iter().take(10).map(|track| track.session.as_str()).collect();
        let detail =
            "the map has several sessions, each with a frame of its own: name one, or ask for `frame=fleet`";
        let got = format!("{} sessions: {}", report.sessions.len(), names.join(", "));
        return Err(FieldError::new("?session", detail).got(got));
    }
    let mut text = String::new();
    for session in &report.unjoined {
        let _ = writeln!(
            text,
            "# left out: {session}, which no loop with a transformation and no plan joins to the others"
        );
    }
    for track in &report.sessions {
        if report.is_in_one_frame {
            let _ = writeln!(text, "# session {}: {} poses", track.session, track.keyframes.len());
        }
        text += &write(track);
    }
    Ok(text)
}

#[cfg(test)]
mod tests;
