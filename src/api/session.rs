//! Session: one robot's run or a plan's frame, and its alignment to a plan (`openapi/openapi.yaml`).

use revisit_shapes::answer;

use super::space::{Time, Transform, rounded};
use crate::domain::report::{AlignmentReport, SessionReport};
use crate::geometry::Pose;

/// A session of a map.
#[answer]
#[schema(as = Session)]
pub struct SessionView {
    /// Its id.
    pub session: String,
    /// Number of its keyframes.
    pub keyframes: usize,
    /// The earliest stamp of its keyframes; left out without any.
    pub first: Option<Time>,
    /// The latest stamp of its keyframes; left out without any.
    pub last: Option<Time>,
    /// Number of prior anchors in its frame; left out unless it is the frame of a plan.
    pub priors: Option<usize>,
    /// The plan's frame that it is aligned to; left out, as are the next members, while it is not aligned.
    pub frame: Option<String>,
    /// Maps points of the session's frame into the plan's frame.
    pub plan_from_session: Option<Transform>,
    /// Number of signs of the plan that agree.
    pub inliers: Option<usize>,
    /// Standard deviations of the alignment, where the signs were seen.
    pub uncertainty: Option<AlignmentUncertainty>,
}

/// Standard deviations of an alignment. They follow from the number of signs and how far these are apart.
#[answer]
#[derive(Copy)]
pub struct AlignmentUncertainty {
    /// Of the place, in metres.
    pub translation_m: f64,
    /// Of the rotation about the vertical, in rad.
    pub rotation_rad: f64,
}

impl From<SessionReport> for SessionView {
    fn from(session: SessionReport) -> Self {
        let SessionReport { id, keyframes, stamps, priors, alignment } = session;
        let view = Self {
            session: id.to_string(),
            keyframes,
            first: stamps.map(|(first, _)| first.into()),
            last: stamps.map(|(_, last)| last.into()),
            priors: (priors > 0).then_some(priors),
            frame: None,
            plan_from_session: None,
            inliers: None,
            uncertainty: None,
        };
        match alignment {
            Some(alignment) => view.aligned(&alignment),
            None => view,
        }
    }
}

impl SessionView {
    fn aligned(self, alignment: &AlignmentReport) -> Self {
        Self {
            frame: Some(alignment.frame.to_string()),
            plan_from_session: Some(shown(&alignment.plan_from_session)),
            inliers: Some(alignment.inliers),
            uncertainty: Some(AlignmentUncertainty {
                translation_m: rounded(alignment.position_sigma_m),
                rotation_rad: rounded(alignment.yaw_sigma_rad),
            }),
            ..self
        }
    }
}

/// Returns a computed pose as answers show it.
fn shown(pose: &Pose) -> Transform {
    Pose::from_stored(pose.translation_m().map(rounded), pose.rotation_xyzw().map(rounded)).into()
}
