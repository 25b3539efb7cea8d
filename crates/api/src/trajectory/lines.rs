//! Lines: one pose a line, as evo reads them.

use std::fmt::Write as _;

use revisit_core::domain::keyframe::Stamp;
use revisit_core::domain::trajectory::SessionTrack;

/// TUM's format: `seconds x y z qx qy qz qw` of `map_from_camera`, metres.
pub fn tum(track: &SessionTrack) -> String {
    let mut text = String::from("# timestamp tx ty tz qx qy qz qw\n");
    for at in &track.keyframes {
        let ([x, y, z], [qx, qy, qz, qw]) =
            (at.map_from_camera.translation_m(), at.map_from_camera.rotation_xyzw());
        let _ = writeln!(text, "{} {x} {y} {z} {qx} {qy} {qz} {qw}", seconds(at.stamp));
    }
    text
}

/// KITTI's format: the upper three rows of `map_from_camera`, row by row; no times.
pub fn kitti(track: &SessionTrack) -> String {
    let mut text = String::new();
    for at in &track.keyframes {
        let matrix = at.map_from_camera.isometry().to_homogeneous();
        let numbers: Vec<String> =
            (0..12).map(|place| (matrix[(place / 4, place % 4)] + 0.0).to_string()).collect();
        let _ = writeln!(text, "{}", numbers.join(" "));
    }
    text
}

/// Returns a stamp in decimal seconds, to the nanosecond; before the epoch with a minus sign.
fn seconds(stamp: Stamp) -> String {
    let nanoseconds = i128::from(stamp.sec) * 1_000_000_000 + i128::from(stamp.nanosec);
    let (sign, size) = (if nanoseconds < 0 { "-" } else { "" }, nanoseconds.unsigned_abs());
    format!("{sign}{}.{:09}", size / 1_000_000_000, size % 1_000_000_000)
}
