//! Pose graph: reconciles the robot's odometry and loops.
//!
//! Poses are similarities: the scale of a camera's frame is the length of its unit in the map, 1 where depth is
//! measured. Scales are solved first ([`super::scale_graph`]), then poses with translations of those lengths. ORB-SLAM
//! solves both at once (H. Strasdat, J. M. M. Montiel and A. J. Davison, RSS 2010).
//!
//! The solver is factrs (Levenberg-Marquardt over SE(3) with sparse Cholesky). It is maintained, differentiates the
//! residuals automatically, and without its `rayon` feature gives the same bytes for the same graph. It uses its own
//! version of nalgebra, so poses are converted here and nowhere else.

use factrs::core::{BetweenResidual, GaussianNoise, Graph, LevenMarquardt, PriorResidual, SE3, SO3, Values};
use factrs::fac;
use factrs::linalg::Vector3;
use factrs::optimizers::{LevenParams, OptError};
use factrs::traits::Optimizer as _;
use nalgebra::{Quaternion, UnitQuaternion};

use super::scale_graph::{self, Ratio};
use crate::geometry::Sim3;

mod symbols {
    use factrs::assign_symbols;
    use factrs::core::SE3;
    assign_symbols!(X: SE3);
}
use symbols::X;

/// Standard deviation of the fixed first pose, in metres and radians.
const ANCHOR_SIGMA: f64 = 1e-6;
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

/// The reason why there is no solution.
#[derive(Debug, thiserror::Error)]
pub enum PoseGraphError {
    /// An edge names a pose that does not exist.
    #[error("an edge leads from pose {from} to pose {to}, of {poses}")]
    UnknownPose {
        /// The first pose it names.
        from: usize,
        /// The second pose.
        to: usize,
        /// The number of poses.
        poses: usize,
    },
    /// The linear system cannot be solved.
    #[error("the pose graph's equations cannot be solved")]
    Unsolvable,
}

/// Moves the poses, `map_from_camera`, to agree best with the edges; the first stays.
pub fn optimise(poses: &mut [Sim3], edges: &[Edge]) -> Result<(), PoseGraphError> {
    let Some(first) = poses.first().copied() else { return Ok(()) };
    if let Some(edge) = edges.iter().find(|edge| edge.from.max(edge.to) >= poses.len()) {
        return Err(PoseGraphError::UnknownPose { from: edge.from, to: edge.to, poses: poses.len() });
    }
    let scales = scales(poses, edges)?;
    let mut graph = Graph::new();
    let anchor = GaussianNoise::<6>::from_scalar_sigma(ANCHOR_SIGMA);
    graph.add_factor(fac![PriorResidual::new(to_factrs(&first)), X(0), anchor]);
    for edge in edges {
        let noise = GaussianNoise::<6>::from_split_sigma(edge.sigma.rad, edge.sigma.m);
        let measured = edge.from_from_to;
        let length = Vector3::from(measured.translation_m()) * scales[edge.from];
        let residual =
            BetweenResidual::new(SE3::from_rot_trans(rotation_to_factrs(measured.rotation()), length));
        graph.add_factor(fac![residual, (X(edge.from as u32), X(edge.to as u32)), noise]);
    }
    let mut values = Values::new();
    for (number, pose) in poses.iter().enumerate() {
        values.insert(X(number as u32), to_factrs(pose));
    }
    let mut params = LevenParams::default();
    params.base.max_iterations = MAX_ITERATIONS;
    params.base.error_tol_relative = MIN_RELATIVE_GAIN;
    let solved = match LevenMarquardt::new(params, graph).optimize(values) {
        // The best result after the maximum of iterations is the answer.
        Ok(solved) | Err(OptError::MaxIterations(solved)) => solved,
        // No step improves it, so it is already optimal.
        Err(OptError::FailedToStep) => return Ok(()),
        Err(OptError::InvalidSystem) => return Err(PoseGraphError::Unsolvable),
    };
    for (number, (pose, scale)) in poses.iter_mut().zip(scales).enumerate() {
        let solved: &SE3 = solved.get(X(number as u32)).ok_or(PoseGraphError::Unsolvable)?;
        *pose = from_factrs(solved, scale);
    }
    Ok(())
}

/// Returns the scale of each pose that agrees best with the edges; unchanged if no edge has a different one.
fn scales(poses: &[Sim3], edges: &[Edge]) -> Result<Vec<f64>, PoseGraphError> {
    if edges.iter().all(|edge| edge.from_from_to.scale() == 1.0) {
        return Ok(poses.iter().map(Sim3::scale).collect());
    }
    let ratio = |edge: &Edge| Ratio {
        from: edge.from,
        to: edge.to,
        log_ratio: edge.from_from_to.scale().ln(),
        sigma: edge.sigma.log_scale,
    };
    let ratios: Vec<Ratio> = edges.iter().map(ratio).collect();
    let log_scales: Vec<f64> = poses.iter().map(|pose| pose.scale().ln()).collect();
    let solved = scale_graph::solve(&log_scales, &ratios).ok_or(PoseGraphError::Unsolvable)?;
    Ok(solved.into_iter().map(f64::exp).collect())
}

fn to_factrs(pose: &Sim3) -> SE3 {
    SE3::from_rot_trans(rotation_to_factrs(pose.rotation()), Vector3::from(pose.translation_m()))
}

fn rotation_to_factrs(rotation: &UnitQuaternion<f64>) -> SO3 {
    let q = rotation.quaternion();
    SO3::from_xyzw(q.i, q.j, q.k, q.w)
}

fn from_factrs(pose: &SE3, scale: f64) -> Sim3 {
    let (q, t) = (pose.rot(), pose.xyz());
    let rotation = UnitQuaternion::from_quaternion(Quaternion::new(q.w(), q.x(), q.y(), q.z()));
    Sim3::from_parts(scale, rotation, [t[0], t[1], t[2]].into())
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
        assert!(matches!(optimise(&mut poses, &edges), Err(PoseGraphError::UnknownPose { to: 10, .. })));
    }
}
