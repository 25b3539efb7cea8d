//! Constants of the frames of a fleet (M60).

use super::constant::{Constant, constants};
use crate::recognition::frames::{consensus, measurement, refinement};

/// Step by step.
pub(super) const FRAMES: &[Constant] = constants! {
    "frames.loop_slack_m" = measurement::LOOP_SLACK_M, "m",
        "ours: how far a verified transformation may be off where nothing was driven";
    "frames.loop_slack_rad" = measurement::LOOP_SLACK_RAD, "rad",
        "ours: the same in rotation";
    "frames.compared_max" = consensus::COMPARED_MAX as f64, "1",
        "ours: loops between two sessions that are compared each with each";
    "frames.weight_min" = refinement::WEIGHT_MIN, "1",
        "ours: the weight from which on the loops between two sessions count";
};
