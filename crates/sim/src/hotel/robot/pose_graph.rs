//! Pose graph: reconciles the robot's odometry and loops.
//!
//! Poses are similarities: the scale of a camera's frame is the length of its unit in the map, 1 where depth is
//! measured. Scales are solved first, then poses with translations of those lengths. ORB-SLAM solves both at once
//! (H. Strasdat, J. M. M. Montiel and A. J. Davison, RSS 2010).
//!
//! The steps are the core's (`frames::pose_graph`), damped as Levenberg and Marquardt did: each is tried, and shortened
//! until the graph agrees better than before.

use nalgebra::{UnitQuaternion, Vector3};

use crate::geometry::{Point3, Pose, Sim3};
use crate::recognition::frames::pose_graph::{self, step};

/// The share that is added to the system's diagonal at first.
const DAMPING: f64 = 1e-5;
/// The factor by which it falls after a step that helped, and grows after one that did not.
const DAMPING_STEP: f64 = 10.0;
/// Above it a step moves nothing any more.
const DAMPING_MAX: f64 = 1e6;
/// The solver stops when an iteration reduces the cost by less than this share.
const MIN_RELATIVE_GAIN: f64 = 1e-4;
/// Maximum iterations. False loops contradict each other, and their optimum is useless.
const MAX_ITERATIONS: usize = 20;

/// A measured motion between two poses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edge {
    /// The number of the first pose.
    pub from: usize,
    /// The number of the second pose.
    pub to: usize,
    /// The pose of `to` in the frame of `from`, in the units of `from`.
    pub from_from_to: Sim3,
    /// Its error.
    pub sigma: Sigma,
}

/// The standard deviations of a measured motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sigma {
    /// Of its translation along each axis, in units of the map: metres where depth is measured.
    pub m: f64,
    /// Of its rotation about each axis, in radians.
    pub rad: f64,
    /// Of the logarithm of its scale.
    pub log_scale: f64,
}

/// An edge names a pose that does not exist.
#[derive(Debug, thiserror::Error)]
#[error("an edge leads from pose {from} to pose {to}, of {poses}")]
pub struct UnknownPose {
    /// The first pose it names.
    pub from: usize,
    /// The second pose.
    pub to: usize,
    /// The number of poses.
    pub poses: usize,
}

/// Moves the poses, `map_from_camera`, to agree best with the edges; the first stays.
pub fn optimise(poses: &mut [Sim3], edges: &[Edge]) -> Result<(), UnknownPose> {
    if let Some(edge) = edges.iter().find(|edge| edge.from.max(edge.to) >= poses.len()) {
        return Err(UnknownPose { from: edge.from, to: edge.to, poses: poses.len() });
    }
    let scales = scales(poses, edges);
    let measured = |edge: &Edge| {
        let length = Vector3::from(edge.from_from_to.translation_m()) * scales[edge.from];
        between(edge, *edge.from_from_to.rotation(), length, [edge.sigma.m, edge.sigma.rad])
    };
    let mut solved: Vec<Pose> = poses.iter().map(Sim3::without_scale).collect();
    fit(&mut solved, &edges.iter().map(measured).collect::<Vec<_>>());
    for ((pose, solved), scale) in poses.iter_mut().zip(solved).zip(scales) {
        *pose = Sim3::scaled(solved, scale);
    }
    Ok(())
}

/// Returns the scale of each pose that agrees best with the edges; unchanged if no edge has a different one.
///
/// In the logarithm of the scale this is linear least squares over a graph with one number per frame: a graph of poses along a line.
fn scales(poses: &[Sim3], edges: &[Edge]) -> Vec<f64> {
    if edges.iter().all(|edge| edge.from_from_to.scale() == 1.0) {
        return poses.iter().map(Sim3::scale).collect();
    }
    let along = |logarithm: f64| Vector3::new(logarithm, 0.0, 0.0);
    let at = |pose: &Sim3| {
        Pose::from(nalgebra::Isometry3::from_parts(
            along(pose.scale().ln()).into(),
            UnitQuaternion::identity(),
        ))
    };
    let ratio = |edge: &Edge| {
        let logarithm = along(edge.from_from_to.scale().ln());
        between(edge, UnitQuaternion::identity(), logarithm, [edge.sigma.log_scale, 1.0])
    };
    let mut solved: Vec<Pose> = poses.iter().map(at).collect();
    fit(&mut solved, &edges.iter().map(ratio).collect::<Vec<_>>());
    solved.iter().map(|pose| pose.translation_m()[0].exp()).collect()
}

fn between(
    edge: &Edge,
    rotation: UnitQuaternion<f64>,
    translation: Vector3<f64>,
    [m, rad]: [f64; 2],
) -> pose_graph::Edge {
    pose_graph::Edge {
        a: edge.from,
        b: edge.to,
        a_from_b: Pose::from(nalgebra::Isometry3::from_parts(translation.into(), rotation)),
        at: Point3::origin(),
        unit_m: m,
        unit_rad: rad,
    }
}

/// Steps until one gains little. The first pose is held.
fn fit(poses: &mut Vec<Pose>, edges: &[pose_graph::Edge]) {
    let cost = |poses: &[Pose]| edges.iter().map(|edge| edge.residual(poses).square()).sum::<f64>();
    let (mut best, mut damping) = (cost(poses), DAMPING);
    for _ in 0..MAX_ITERATIONS {
        let mut moved = poses.clone();
        step(&mut moved, |number| number == 0, edges.iter().map(|edge| (edge, 1.0)), damping);
        let reached = cost(&moved);
        if reached < best {
            *poses = moved;
            if best - reached < MIN_RELATIVE_GAIN * best {
                break;
            }
            best = reached;
            damping /= DAMPING_STEP;
        } else {
            damping *= DAMPING_STEP;
            if damping > DAMPING_MAX {
                break;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    type Poses = Vec<Sim3>;

    /// Returns a ring whose steps are too long and turned too far, and the edge that corrects it. Each step's unit is
    /// `grows` times that of the step before.
    fn ring(poses: usize, grows: f64) -> (Poses, Poses, Vec<Edge>, Edge) {
        let turn = |angle: f64| UnitQuaternion::from_euler_angles(0.0, 0.0, angle);
        let step = |length: f64, angle: f64| Sim3::from_parts(1.0, turn(angle), [length, 0.0, 0.0].into());
        let angle = std::f64::consts::TAU / poses as f64;
        let longer = |number: usize| grows.powi(number as i32);
        let (truth, drifted): (Poses, Poses) = {
            let chain = |motion: &dyn Fn(usize) -> Sim3| {
                let mut chain = vec![Sim3::identity()];
                for number in 1..poses {
                    chain.push(chain[number - 1].after(&motion(number)));
                }
                chain
            };
            (chain(&|_| step(0.5, angle)), chain(&|number| step(0.505 * longer(number), angle * 1.01)))
        };
        let edge = |from, to, from_from_to| Edge {
            from,
            to,
            from_from_to,
            sigma: Sigma { m: 0.01, rad: 0.01, log_scale: 0.01 },
        };
        let odometry = (1..poses).map(|to| edge(to - 1, to, step(0.505 * longer(to), angle * 1.01)));
        let last = truth[poses - 1];
        let scale = longer(poses - 1).recip();
        let closing =
            edge(0, poses - 1, Sim3::from_parts(scale, *last.rotation(), last.translation_m().into()));
        (truth, drifted, odometry.collect(), closing)
    }

    fn rmse_m(a: &[Sim3], b: &[Sim3]) -> f64 {
        let squared = a.iter().zip(b).map(|(a, b)| {
            let [a, b] = [a, b].map(|pose| Vector3::from(pose.translation_m()));
            (a - b).norm_squared()
        });
        (squared.sum::<f64>() / a.len() as f64).sqrt()
    }

    /// Returns the poses of a closed ring, whose error the loop has made smaller by more than a factor.
    fn closed(growth: f64, factor: f64) -> Vec<Sim3> {
        let (truth, mut poses, mut edges, closing) = ring(400, growth);
        let before_m = rmse_m(&truth, &poses);
        edges.push(closing);
        optimise(&mut poses, &edges).expect("a solution");
        assert!(rmse_m(&truth, &poses) < before_m / factor, "{before_m} -> {}", rmse_m(&truth, &poses));
        poses
    }

    #[test]
    fn a_true_loop_takes_most_of_the_drift_away_and_leaves_the_first_pose() {
        let poses = closed(1.0, 2.0);
        assert!(Vector3::from(poses[0].translation_m()).norm() < 1e-6);
        assert!(poses.iter().all(|pose| pose.scale() == 1.0), "metres stay metres");
    }

    #[test]
    fn a_true_loop_takes_most_of_the_drift_of_scale_away() {
        let poses = closed(1.001, 4.0);
        let last = poses[399].scale() * 1.001_f64.powi(399);
        assert!((last - 1.0).abs() < 0.01, "{last}");
    }

    #[test]
    fn a_loop_of_scales_is_shared_out_by_what_each_ratio_scatters_by() {
        // A chain with three unchanged ratios, one of them less certain, and a certain loop of 0.4 in total.
        let ratio = |from, to, log_ratio: f64, log_scale| Edge {
            from,
            to,
            from_from_to: Sim3::from_parts(log_ratio.exp(), UnitQuaternion::identity(), Vector3::zeros()),
            sigma: Sigma { m: 1.0, rad: 1.0, log_scale },
        };
        let edges = [
            ratio(0, 1, 0.0, 0.1),
            ratio(1, 2, 0.0, 0.1),
            ratio(2, 3, 0.0, 0.1 * 2.0_f64.sqrt()),
            ratio(0, 3, 0.4, 1e-4),
        ];
        let mut poses = [Sim3::identity(); 4];
        optimise(&mut poses, &edges).expect("a solution");
        for (pose, expected) in poses.iter().zip([0.0, 0.1, 0.2, 0.4]) {
            assert!(
                (pose.scale().ln() - expected).abs() < 1e-5,
                "{} instead of {expected}",
                pose.scale().ln()
            );
        }
    }

    #[test]
    fn without_a_loop_nothing_moves() {
        let (_, drifted, edges, _) = ring(50, 1.0);
        let mut poses = drifted.clone();
        optimise(&mut poses, &edges).expect("a solution");
        assert!(rmse_m(&drifted, &poses) < 1e-6);
    }

    #[test]
    fn the_same_graph_gives_the_same_bytes() {
        let (_, drifted, mut edges, closing) = ring(100, 1.0);
        edges.push(closing);
        let solve = || {
            let mut poses = drifted.clone();
            optimise(&mut poses, &edges).expect("a solution");
            poses
        };
        assert_eq!(solve(), solve());
    }

    #[test]
    fn an_edge_to_nowhere_is_refused() {
        let (_, mut poses, mut edges, mut closing) = ring(10, 1.0);
        closing.to = 10;
        edges.push(closing);
        assert!(matches!(optimise(&mut poses, &edges), Err(UnknownPose { to: 10, .. })));
    }
}
