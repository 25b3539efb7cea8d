//! Truth: which keyframes were taken at one place. It comes from the simulator alone, and no server receives it.

use serde::{Deserialize, Serialize};

use super::sight::Keyframe;
use crate::hotel::route::heading_difference_rad;

/// The most that two keyframes of one place are apart, in metres and radians.
const SAME_M: f64 = 2.5;
const SAME_RAD: f64 = std::f64::consts::FRAC_PI_4;
/// The most that two keyframes near each other are apart, in metres.
const NEAR_M: f64 = 10.0;
/// A keyframe of the same session is a return once the robot has driven so far, in metres.
const RETURN_M: f64 = 12.0;

/// The standing of two keyframes to each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Standing {
    /// One place, on two visits.
    Right,
    /// Neither right nor wrong: one floor and wing, one physical sign in view of both and 10 m apart at most, or one place that
    /// the robot has not left.
    Near,
    /// Two places.
    Wrong,
}

/// Returns how a keyframe stands to an earlier one.
pub fn standing(a: &Keyframe, b: &Keyframe) -> Standing {
    let apart_m = (a.stand.place() - b.stand.place()).norm();
    let is_one_floor = a.stand.space.is_beside(b.stand.space);
    let turned_rad = heading_difference_rad(a.stand.yaw_rad, b.stand.yaw_rad);
    let is_one_place = a.stand.space == b.stand.space && apart_m <= SAME_M && turned_rad <= SAME_RAD;
    let has_left = a.session != b.session || (a.driven_m - b.driven_m).abs() >= RETURN_M;
    let share_a_sign = !a.signs.is_disjoint(&b.signs);
    match () {
        () if is_one_place && has_left => Standing::Right,
        () if is_one_place || (is_one_floor && apart_m <= NEAR_M && share_a_sign) => Standing::Near,
        () => Standing::Wrong,
    }
}
