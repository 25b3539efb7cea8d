//! The alignment of a session to a plan, from the facts of its map.

use nalgebra::Isometry3;

use super::alignment::{Alignment, align};
use super::plan_texts::PlanTexts;
use super::session_signs::session_signs;
use crate::domain::ids::SessionSeq;
use crate::geometry::Pose;
use crate::recognition::map::index::MapIndex;

/// The alignment of a session to a plan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanAlignment {
    /// The session that stands for the plan's frame.
    pub frame: SessionSeq,
    /// Maps points of the session's frame into the plan's frame.
    pub plan_from_session: Pose,
    /// The signs of the plan that agree.
    pub inliers: usize,
    /// Of these, the signs whose text the plans show at one place.
    pub distinctive: usize,
    /// Standard deviation of the place where the signs were seen, in the plan's frame, in metres.
    pub position_sigma_m: f64,
    /// Standard deviation of the rotation about the vertical, in rad.
    pub yaw_sigma_rad: f64,
}

/// Aligns a session to the plans of its map; none where fewer than two distinctive signs agree, where another place explains
/// the signs nearly as well, or where the map is not metric.
pub fn plan_alignment(index: &MapIndex, texts: &PlanTexts, session: SessionSeq) -> Option<PlanAlignment> {
    if index.priors().is_empty() || !index.properties().metric || index.priors().is_frame(session) {
        return None;
    }
    let signs = session_signs(index, texts, session)?;
    let Alignment { frame, fit, inliers, distinctive, position_sigma_m, yaw_sigma_rad } =
        align(&signs.signs)?;
    let plan_from_level = Isometry3::from(fit.pose);
    let plan_from_session = Pose::from(plan_from_level * signs.level_from_session);
    let frame = *signs.frames.get(frame)?;
    Some(PlanAlignment { frame, plan_from_session, inliers, distinctive, position_sigma_m, yaw_sigma_rad })
}
