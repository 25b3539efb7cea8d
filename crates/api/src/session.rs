//! Session: one robot's run or a plan's frame, and its alignment to a plan (`openapi/openapi.yaml`).

use revisit_core::domain::report::{AlignmentReport, SessionReport};
use revisit_shapes::answer;

use super::space::{Time, Transform};

/// A session of a map.
#[answer(of = SessionReport)]
#[schema(as = Session)]
pub struct SessionView {
    /// Its id.
    #[from(of.id)]
    pub session: String,
    /// Number of its keyframes.
    pub keyframes: usize,
    /// The earliest stamp of its keyframes; left out without any.
    #[from(of.stamps.map(|(first, _)| first))]
    pub first: Option<Time>,
    /// The latest stamp of its keyframes; left out without any.
    #[from(of.stamps.map(|(_, last)| last))]
    pub last: Option<Time>,
    /// Number of prior anchors in its frame; left out unless it is the frame of a plan.
    #[is((of.priors > 0).then_some(of.priors))]
    pub priors: Option<usize>,
    /// The plan's frame that it is aligned to; left out, as are the next members, while it is not aligned.
    #[from(of.alignment.as_ref().map(|of| &of.frame))]
    pub frame: Option<String>,
    /// Maps points of the session's frame into the plan's frame.
    #[is(of.alignment.as_ref().map(|of| Transform::computed(&of.plan_from_session)))]
    pub plan_from_session: Option<Transform>,
    /// Number of signs of the plan that agree.
    #[is(of.alignment.as_ref().map(|of| of.inliers))]
    pub inliers: Option<usize>,
    /// Standard deviations of the alignment, where the signs were seen.
    #[from(of.alignment.as_ref())]
    pub uncertainty: Option<AlignmentUncertainty>,
}

/// Standard deviations of an alignment. They follow from the number of signs and how far these are apart.
#[answer(of = &AlignmentReport)]
#[derive(Copy)]
pub struct AlignmentUncertainty {
    /// Of the place, in metres.
    #[from(of.position_sigma_m)]
    #[rounded]
    pub translation_m: f64,
    /// Of the rotation about the vertical, in rad.
    #[from(of.yaw_sigma_rad)]
    #[rounded]
    pub rotation_rad: f64,
}
