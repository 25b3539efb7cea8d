//! The derivatives held against differences.

use proptest::prelude::*;

use super::*;
use crate::geometry::Point3;
use crate::recognition::frames::measurement::Place;

const SESSIONS: [SessionSeq; 2] = [SessionSeq(0), SessionSeq(1)];

fn any_pose() -> impl Strategy<Value = Pose> {
    (prop::array::uniform3(-5.0..5.0f64), prop::array::uniform3(-1.2..1.2f64)).prop_map(|(at, turn)| {
        let rotation = UnitQuaternion::from_scaled_axis(Vector3::from(turn));
        Pose::from(nalgebra::Isometry3::from_parts(Vector3::from(at).into(), rotation))
    })
}

fn moved(pose: &Pose, by: &Vector6<f64>) -> Pose {
    let turn = UnitQuaternion::from_scaled_axis(by.fixed_rows::<3>(3).into_owned());
    let before = pose.isometry();
    let at = turn * before.translation.vector + by.fixed_rows::<3>(0);
    Pose::from(nalgebra::Isometry3::from_parts(at.into(), turn * before.rotation))
}

proptest! {
    #[test]
    fn the_derivatives_are_those_of_the_residual(
        [a, b, a_from_b] in prop::array::uniform3(any_pose()),
        at in prop::array::uniform3(-3.0..3.0f64),
        end in 0..2_usize,
        unknown in 0..6_usize,
    ) {
        let place = Place { at: Point3::from(at), milestone: None };
        let [first, second] = SESSIONS;
        let measurement = Measurement {
            loop_id: None, a: first, b: second, a_from_b, at_a: place, at_b: place, slack_m: 1.0, slack_rad: 0.4, drift_share: 0.05,
        };
        let joint = Joint { measurements: vec![&measurement], allowed_m: 1.5, allowed_rad: 0.4 };
        let residual_of = |poses: [Pose; 2]| {
            let placed: BTreeMap<SessionSeq, Placed> = SESSIONS
                .into_iter()
                .zip(poses)
                .map(|(session, root_from_session)| (session, Placed { root: first, root_from_session }))
                .collect();
            residual(&placed, &measurement, &joint)
        };
        let here = residual_of([a, b]);
        // Near half a turn the rotation vector jumps.
        prop_assume!(here.turn_rad.norm() < 2.8);
        let column = jacobians(&here, &joint)[end].column(unknown).into_owned();
        let h = 1e-6;
        let mut step = Vector6::zeros();
        step[unknown] = h;
        let shifted = |step: &Vector6<f64>| {
            let mut poses = [a, b];
            poses[end] = moved(&poses[end], step);
            residual_of(poses)
        };
        let (up, down) = (shifted(&step), shifted(&-step));
        let measured_place = (up.place - down.place) / (2.0 * h);
        let measured_turn = (up.turn - down.turn) / (2.0 * h);
        let (place, turn) = (column.fixed_rows::<3>(0), column.fixed_rows::<3>(3));
        prop_assert!((measured_place - place).norm() < 1e-5, "{} {}", measured_place, place);
        prop_assert!((measured_turn - turn).norm() < 1e-5, "{} {}", measured_turn, turn);
    }
}
