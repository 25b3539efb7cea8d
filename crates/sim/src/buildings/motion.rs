//! Odometry: the poses that a robot believes, in the frame of its session.

use super::kind::Client;
use super::route::Stand;
use super::world::World;
use crate::geometry::Pose;
use crate::hotel::rng::SeededRng;

/// Returns `session_from_camera` of each stand. The frame is the first camera's. A lift moves the robot, and odometry does not
/// see it. Photographs have a heading and no position.
pub fn believed(world: &World, number: usize, stands: &[Stand]) -> Vec<Pose> {
    let mut rng = SeededRng::new(world.seed, &format!("odometry {number}"));
    let bias_rad_per_m = rng.normal(0.002);
    let scale = 1.0 + rng.normal(0.005);
    let stretch = world.traits.stretch * if rng.happens(0.5) { 1.0 } else { -1.0 };
    let mut poses: Vec<Pose> = Vec::with_capacity(stands.len());
    let mut own = Pose::identity();
    for (at, stand) in stands.iter().enumerate() {
        if let Some(before) = at.checked_sub(1).map(|before| &stands[before]) {
            // In the lift nothing moves; between a room and its corridor the robot drives.
            let step = if before.space.is_beside(stand.space) {
                before.corridor_from_camera().inverse().after(&stand.corridor_from_camera())
            } else {
                Pose::identity()
            };
            let [x, y, z] = step.translation_m();
            let driven_m = x.hypot(z);
            let length = scale * (1.0 + stretch * at as f64 / stands.len() as f64);
            let turned_rad = bias_rad_per_m * driven_m + rng.normal(0.002 * driven_m.sqrt());
            let half = 0.5 * turned_rad;
            let turn = Pose::new([x * length, y, z * length], step.rotation_xyzw()).unwrap_or(step);
            let drift =
                Pose::new([0.0; 3], [0.0, half.sin(), 0.0, half.cos()]).unwrap_or_else(Pose::identity);
            own = own.after(&turn).after(&drift);
        }
        poses.push(own);
    }
    if world.traits.client == Client::Photographs {
        let heading = |pose: &Pose| Pose::new([0.0; 3], pose.rotation_xyzw()).unwrap_or_else(Pose::identity);
        poses = poses.iter().map(heading).collect();
    }
    poses
}
