//! The derivatives held against differences, and the solution of a system against the system.

use proptest::prelude::*;

use super::*;

fn any_pose() -> impl Strategy<Value = Pose> {
    (prop::array::uniform3(-5.0..5.0f64), prop::array::uniform3(-1.2..1.2f64)).prop_map(|(at, turn)| {
        let rotation = UnitQuaternion::from_scaled_axis(Vector3::from(turn));
        Pose::from(Isometry3::from_parts(Vector3::from(at).into(), rotation))
    })
}

proptest! {
    #[test]
    fn the_derivatives_are_those_of_the_residual(
        [a, b, a_from_b] in prop::array::uniform3(any_pose()),
        at in prop::array::uniform3(-3.0..3.0f64),
        end in 0..2_usize,
        unknown in 0..6_usize,
    ) {
        let edge = Edge { a: 0, b: 1, a_from_b, at: Point3::from(at), unit_m: 1.5, unit_rad: 0.4 };
        let here = edge.residual(&[a, b]);
        // Near half a turn the rotation vector jumps.
        prop_assume!(here.turn_rad.norm() < 2.8);
        let column = edge.jacobians(&here)[end].column(unknown).into_owned();
        let h = 1e-6;
        let mut step = Vector6::zeros();
        step[unknown] = h;
        let shifted = |step: &Vector6<f64>| {
            let mut poses = [a, b];
            poses[end] = moved(&poses[end], step);
            edge.residual(&poses)
        };
        let (up, down) = (shifted(&step), shifted(&-step));
        let measured_place = (up.place - down.place) / (2.0 * h);
        let measured_turn = (up.turn - down.turn) / (2.0 * h);
        let (place, turn) = (column.fixed_rows::<3>(0), column.fixed_rows::<3>(3));
        prop_assert!((measured_place - place).norm() < 1e-5, "{} {}", measured_place, place);
        prop_assert!((measured_turn - turn).norm() < 1e-5, "{} {}", measured_turn, turn);
    }

    /// A chain of poses with loops between any of them.
    #[test]
    fn conjugate_gradients_solve_the_system(
        poses in prop::collection::vec(any_pose(), 3..12),
        loops in prop::collection::vec((any::<prop::sample::Index>(), any::<prop::sample::Index>(), any_pose()), 0..12),
        damping in prop_oneof![Just(0.0), Just(0.1)],
    ) {
        let edge = |a: usize, b: usize, a_from_b| Edge { a, b, a_from_b, at: Point3::origin(), unit_m: 0.1, unit_rad: 0.05 };
        let chain = (1..poses.len()).map(|number| {
            edge(number - 1, number, poses[number - 1].inverse().after(&poses[number]))
        });
        let loops = loops.iter().map(|(a, b, pose)| edge(a.index(poses.len()), b.index(poses.len()), *pose));
        let mut system = System::of(poses.len());
        for edge in chain.chain(loops.filter(|edge| edge.a != edge.b)) {
            let residual = edge.residual(&poses);
            system.add([edge.a, edge.b].map(Some), &edge.jacobians(&residual), &residual, 1.0);
        }
        // The first is held, as a graph's is.
        system.diagonal[0] += Matrix6::identity() * 1e6;
        system.damp(damping);
        let solution = system.solve();
        let length = |of: &[Vector6<f64>]| of.iter().map(Vector6::norm_squared).sum::<f64>().sqrt();
        let rest: Vec<Vector6<f64>> = system.times(&solution).iter().zip(&system.right).map(|(a, b)| a - b).collect();
        prop_assert!(length(&rest) <= 1e-6 * length(&system.right), "{} of {}", length(&rest), length(&system.right));
    }
}
