//! Pose graph: what the robot knows of its way, odometry and loops, brought into agreement.
//!
//! The solver is factrs (Levenberg-Marquardt over SE(3) with sparse Cholesky): kept up, differentiates the residuals by
//! itself, and without its `rayon` feature gives the same bytes for the same graph. It brings its own version of nalgebra,
//! so poses are converted at this border and nowhere else.

use factrs::core::{BetweenResidual, GaussianNoise, Graph, LevenMarquardt, PriorResidual, SE3, SO3, Values};
use factrs::fac;
use factrs::linalg::Vector3;
use factrs::optimizers::{LevenParams, OptError};
use factrs::traits::Optimizer as _;
use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};

mod symbols {
    use factrs::assign_symbols;
    use factrs::core::SE3;
    assign_symbols!(X: SE3);
}
use symbols::X;

/// The first pose is held where it is, in metres and radians.
const ANCHOR_SIGMA: f64 = 1e-6;
/// The solver ends when an iteration gains less than this share of the cost.
const MIN_RELATIVE_GAIN: f64 = 1e-4;
/// Or after so many iterations: false loops contradict each other, and their optimum is of no use to anybody.
const MAX_ITERATIONS: usize = 20;

/// A measured motion between two poses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edge {
    /// The number of the first pose.
    pub from: usize,
    /// And of the second.
    pub to: usize,
    /// The pose of `to` in the frame of `from`.
    pub from_from_to: Isometry3<f64>,
    /// What its translation scatters by along each axis, in metres.
    pub sigma_m: f64,
    /// What its rotation scatters by about each axis, in radians.
    pub sigma_rad: f64,
}

/// Why there is no solution.
#[derive(Debug, thiserror::Error)]
pub enum PoseGraphError {
    /// An edge names a pose that is not there.
    #[error("an edge leads from pose {from} to pose {to}, of {poses}")]
    UnknownPose {
        /// The first pose it names.
        from: usize,
        /// And the second.
        to: usize,
        /// How many there are.
        poses: usize,
    },
    /// The linear system cannot be solved.
    #[error("the pose graph's equations cannot be solved")]
    Unsolvable,
}

/// Moves the poses, `map_from_camera`, to where they agree best with the edges; the first stays.
pub fn optimise(poses: &mut [Isometry3<f64>], edges: &[Edge]) -> Result<(), PoseGraphError> {
    let Some(first) = poses.first() else { return Ok(()) };
    let mut graph = Graph::new();
    let anchor = GaussianNoise::<6>::from_scalar_sigma(ANCHOR_SIGMA);
    graph.add_factor(fac![PriorResidual::new(to_factrs(first)), X(0), anchor]);
    for edge in edges {
        let Edge { from, to, from_from_to, sigma_m, sigma_rad } = edge;
        if (*from).max(*to) >= poses.len() {
            return Err(PoseGraphError::UnknownPose { from: *from, to: *to, poses: poses.len() });
        }
        let noise = GaussianNoise::<6>::from_split_sigma(*sigma_rad, *sigma_m);
        let residual = BetweenResidual::new(to_factrs(from_from_to));
        graph.add_factor(fac![residual, (X(*from as u32), X(*to as u32)), noise]);
    }
    let mut values = Values::new();
    for (number, pose) in poses.iter().enumerate() {
        values.insert(X(number as u32), to_factrs(pose));
    }
    let mut params = LevenParams::default();
    params.base.max_iterations = MAX_ITERATIONS;
    params.base.error_tol_relative = MIN_RELATIVE_GAIN;
    let solved = match LevenMarquardt::new(params, graph).optimize(values) {
        // What is best after so many iterations is the answer.
        Ok(solved) | Err(OptError::MaxIterations(solved)) => solved,
        // No step makes it better: it is as good as it gets.
        Err(OptError::FailedToStep) => return Ok(()),
        Err(OptError::InvalidSystem) => return Err(PoseGraphError::Unsolvable),
    };
    for (number, pose) in poses.iter_mut().enumerate() {
        let solved: &SE3 = solved.get(X(number as u32)).ok_or(PoseGraphError::Unsolvable)?;
        *pose = from_factrs(solved);
    }
    Ok(())
}

fn to_factrs(pose: &Isometry3<f64>) -> SE3 {
    let (q, t) = (pose.rotation.quaternion(), &pose.translation.vector);
    SE3::from_rot_trans(SO3::from_xyzw(q.i, q.j, q.k, q.w), Vector3::new(t.x, t.y, t.z))
}

fn from_factrs(pose: &SE3) -> Isometry3<f64> {
    let (q, t) = (pose.rot(), pose.xyz());
    let rotation = UnitQuaternion::from_quaternion(Quaternion::new(q.w(), q.x(), q.y(), q.z()));
    Isometry3::from_parts(Translation3::new(t[0], t[1], t[2]), rotation)
}

#[cfg(test)]
mod tests {
    use super::*;

    type Poses = Vec<Isometry3<f64>>;

    /// Around a ring, each step too long and turned too far; and the edge that knows better.
    fn ring(poses: usize) -> (Poses, Poses, Vec<Edge>, Edge) {
        let turn = |angle: f64| UnitQuaternion::from_euler_angles(0.0, 0.0, angle);
        let step =
            |length: f64, angle: f64| Isometry3::from_parts(Translation3::new(length, 0.0, 0.0), turn(angle));
        let angle = std::f64::consts::TAU / poses as f64;
        let (right, wrong) = (step(0.5, angle), step(0.505, angle * 1.01));
        let chain = |motion: &Isometry3<f64>| {
            std::iter::successors(Some(Isometry3::identity()), |pose| Some(pose * motion))
                .take(poses)
                .collect()
        };
        let edge = |from, to, from_from_to| Edge { from, to, from_from_to, sigma_m: 0.01, sigma_rad: 0.01 };
        let (truth, drifted): (Vec<_>, Vec<_>) = (chain(&right), chain(&wrong));
        let odometry = (1..poses).map(|to| edge(to - 1, to, wrong)).collect();
        let closing = edge(0, poses - 1, truth[poses - 1]);
        (truth, drifted, odometry, closing)
    }

    fn rmse_m(a: &[Isometry3<f64>], b: &[Isometry3<f64>]) -> f64 {
        let squared =
            a.iter().zip(b).map(|(a, b)| (a.translation.vector - b.translation.vector).norm_squared());
        (squared.sum::<f64>() / a.len() as f64).sqrt()
    }

    #[test]
    fn a_true_loop_takes_most_of_the_drift_away_and_leaves_the_first_pose() {
        let (truth, mut poses, mut edges, closing) = ring(400);
        let before_m = rmse_m(&truth, &poses);
        edges.push(closing);
        optimise(&mut poses, &edges).expect("a solution");
        assert!(rmse_m(&truth, &poses) < before_m / 2.0, "{before_m} -> {}", rmse_m(&truth, &poses));
        assert!((poses[0].translation.vector).norm() < 1e-6);
    }

    #[test]
    fn without_a_loop_nothing_moves() {
        let (_, drifted, edges, _) = ring(50);
        let mut poses = drifted.clone();
        optimise(&mut poses, &edges).expect("a solution");
        assert!(rmse_m(&drifted, &poses) < 1e-6);
    }

    #[test]
    fn the_same_graph_gives_the_same_bytes() {
        let (_, drifted, mut edges, closing) = ring(100);
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
        let (_, mut poses, mut edges, mut closing) = ring(10);
        closing.to = 10;
        edges.push(closing);
        assert!(matches!(optimise(&mut poses, &edges), Err(PoseGraphError::UnknownPose { to: 10, .. })));
    }
}
