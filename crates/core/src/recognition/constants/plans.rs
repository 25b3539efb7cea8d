//! Constants of the alignment to plans (M55).

use super::constant::{Constant, constants};
use crate::recognition::plans::{alignment, plan_texts, proposals, session_signs, support};

/// Step by step.
pub(super) const PLANS: &[Constant] = constants! {
    "plans.sighting_sigma_m" = session_signs::SIGHTING_SIGMA_M, "m",
        "ours: standard deviation of one sighting of a sign along each axis, at no distance";
    "plans.sighting_sigma_per_m" = session_signs::SIGHTING_SIGMA_PER_M, "m/m",
        "ours: what each metre of distance adds to it";
    "plans.shared_sigma_m" = session_signs::SHARED_SIGMA_M, "m",
        "ours: standard deviation of what all sightings of a sign share";
    "plans.same_sign_m" = session_signs::SAME_SIGN_M, "m",
        "ours: sightings of one text nearer than this are of one sign";
    "plans.same_spot_m" = session_signs::SAME_SPOT_M, "m",
        "ours: a text read half as often as another one this near to it, or less, is a misreading of that one";
    "plans.similar_chars_max" = plan_texts::SIMILAR_CHARS_MAX as f64, "1",
        "ours: texts up to this length may be one character's misreading of a drawn one";
    "plans.drawn_variance_m2" = support::DRAWN_VARIANCE_M2, "m2",
        "ours: variance of a drawn sign's place along each axis of the floor";
    "plans.height_variance_m2" = support::HEIGHT_VARIANCE_M2, "m2",
        "ours: variance of a sign's height against the plan";
    "plans.gate" = support::GATE, "1",
        "ours: largest squared distance, in variances, of a seen sign from a drawn one that explains it";
    "plans.drift_share" = support::DRIFT_SHARE, "1",
        "ours: drift of a session's frame, as a share of the distance from the signs' centre";
    "plans.separation_min_m" = proposals::SEPARATION_MIN_M, "m",
        "ours: two signs closer than this determine no rotation";
    "plans.distinctive_min" = alignment::DISTINCTIVE_MIN as f64, "1",
        "ours: distinctive signs that must agree";
    "plans.general_min" = alignment::GENERAL_MIN as f64, "1",
        "ours: the same where some of them bear words that hang in every building";
    "plans.rival_margin" = alignment::RIVAL_MARGIN, "1",
        "ours: logarithm of the ratio of likelihoods by which another place must explain the signs worse";
    "plans.position_sigma_max_m" = alignment::POSITION_SIGMA_MAX_M, "m",
        "ours: a less certain place is not announced";
    "plans.yaw_sigma_max_rad" = alignment::YAW_SIGMA_MAX_RAD, "rad",
        "ours: a less certain rotation is not announced";
    "plans.agreeing_share_min" = alignment::AGREEING_SHARE_MIN, "1",
        "ours: share of the distinctive signs that must agree";
};
