//! TUM: trajectories as text for evo, `timestamp tx ty tz qx qy qz qw` per line.

use std::fmt::Write as _;

use crate::geometry::Pose;
use crate::hotel::robot::message::STEP_NS;

/// Returns the trajectory of `map_from_camera` poses; timestamps are those of the keyframes as sent.
pub fn trajectory<'a>(poses: impl IntoIterator<Item = &'a Pose>) -> String {
    let mut text = String::from("# timestamp tx ty tz qx qy qz qw\n");
    for (number, pose) in poses.into_iter().enumerate() {
        let ([x, y, z], [qx, qy, qz, qw]) = (pose.translation_m(), pose.rotation_xyzw());
        let seconds = number as f64 * STEP_NS as f64 / 1e9;
        let _ = writeln!(text, "{seconds:.3} {x:.6} {y:.6} {z:.6} {qx:.9} {qy:.9} {qz:.9} {qw:.9}");
    }
    text
}
