//! The three formats, number by number.

use revisit_core::domain::change::Loop;
use revisit_core::domain::ids::KeyframeSeq;
use revisit_core::domain::keyframe::Stamp;
use revisit_core::domain::trajectory::{SessionTrack, TrackedPose, TrajectoryReport};
use revisit_core::geometry::Pose;

use super::{MeasuredLoop, TrajectoryFormat, g2o, kitti, lines, tum, write_trajectory};

/// A quarter turn about z.
const QUARTER: [f64; 4] = [0.0, 0.0, std::f64::consts::FRAC_1_SQRT_2, std::f64::consts::FRAC_1_SQRT_2];

fn at(keyframe: &str, sec: i64, translation: [f64; 3], rotation: [f64; 4]) -> TrackedPose {
    let map_from_camera = Pose::new(translation, rotation).unwrap();
    TrackedPose {
        keyframe: keyframe.parse().unwrap(),
        stamp: Stamp { sec, nanosec: 500_000_000 },
        map_from_camera,
    }
}

fn track(session: &str, keyframes: Vec<TrackedPose>) -> SessionTrack {
    SessionTrack { session: session.parse().unwrap(), keyframes }
}

fn straight() -> [f64; 4] {
    [0.0, 0.0, 0.0, 1.0]
}

fn closed(id: &str, keyframe: &str, candidate: &str) -> Loop {
    Loop {
        id: id.parse().unwrap(),
        keyframe: KeyframeSeq(2),
        candidate: KeyframeSeq(0),
        keyframe_id: keyframe.parse().unwrap(),
        candidate_id: candidate.parse().unwrap(),
        query: None,
        candidate_from_query: None,
    }
}

fn two_sessions() -> TrajectoryReport {
    TrajectoryReport {
        map_version: 7,
        sessions: vec![
            track("s-1", vec![at("a", 1, [0.0; 3], straight()), at("b", 2, [2.0, 0.0, 0.0], QUARTER)]),
            track("s-2", vec![at("c", 9, [5.0, 0.0, 0.0], straight())]),
        ],
        loops: vec![closed("l-1", "c", "b"), closed("l-2", "c", "a")],
        is_in_one_frame: false,
        unjoined: Vec::new(),
    }
}

#[test]
fn a_line_has_the_time_to_the_nanosecond_also_before_the_epoch() {
    let text = tum(&track(
        "s",
        vec![at("a", -1, [1.0, 2.0, 3.0], straight()), at("b", 1_700_000_000, [0.0; 3], straight())],
    ));
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines[1..], ["-0.500000000 1 2 3 0 0 0 1", "1700000000.500000000 0 0 0 0 0 0 1"]);
}

#[test]
fn twelve_numbers_are_the_rows_of_the_pose() {
    let text = kitti(&track("s", vec![at("a", 0, [1.0, 2.0, 3.0], QUARTER)]));
    let numbers: Vec<f64> = text.split_whitespace().map(|number| number.parse().unwrap()).collect();
    let expected = [0.0, -1.0, 0.0, 1.0, 1.0, 0.0, 0.0, 2.0, 0.0, 0.0, 1.0, 3.0];
    assert!(
        numbers.len() == 12 && numbers.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12),
        "{numbers:?}"
    );
}

#[test]
fn lines_say_nothing_of_sessions_so_one_must_be_named_or_each_follows_its_name() {
    let error = lines(&two_sessions(), tum).unwrap_err();
    assert_eq!(error.pointer, "?session");
    let one = TrajectoryReport { sessions: two_sessions().sessions[..1].to_vec(), ..two_sessions() };
    assert_eq!(lines(&one, tum).unwrap().lines().count(), 3);
    let unjoined = vec!["s-3".parse().unwrap()];
    let in_one = TrajectoryReport { is_in_one_frame: true, unjoined, ..two_sessions() };
    let text = lines(&in_one, tum).unwrap();
    let starts: Vec<&str> = text.lines().map(|line| line.split([',', '.', ':']).next().unwrap()).collect();
    let title = "# timestamp tx ty tz qx qy qz qw";
    assert_eq!(
        starts,
        ["# left out", "# session s-1", title, "1", "2", "# session s-2", title, "9"],
        "{text}"
    );
    assert!(text.starts_with("# left out: s-3, which no loop"), "{text}");
    let nothing = TrajectoryReport { sessions: Vec::new(), ..one };
    assert_eq!(write_trajectory(&nothing, &[], TrajectoryFormat::Tum), Ok(String::new()));
}

#[test]
fn a_graph_joins_neighbours_and_the_loops_whose_transformation_is_known() {
    // A metre of doubt along the candidate's x, a decimetre along its y and z, a tenth of a radian about all axes.
    let mut covariance = [0.0; 36];
    for (axis, variance) in [1.0, 0.01, 0.01, 0.01, 0.01, 0.01].into_iter().enumerate() {
        covariance[7 * axis] = variance;
    }
    let measured = MeasuredLoop {
        candidate_from_query: Pose::new([1.0, 0.0, 0.0], QUARTER).unwrap(),
        scale: 1.0,
        covariance: Some(covariance),
    };
    let text = g2o(&two_sessions(), &[Some(measured), None]);
    let edges: Vec<Vec<f64>> = text
        .lines()
        .filter_map(|line| line.strip_prefix("EDGE_SE3:QUAT "))
        .map(|line| line.split(' ').map(|number| number.parse().unwrap()).collect())
        .collect();
    assert_eq!(text.lines().filter(|line| line.starts_with("VERTEX_SE3:QUAT ")).count(), 3, "{text}");
    assert_eq!(edges.len(), 2, "{text}");
    assert!(text.contains("# loop l-2 from a to c: no transformation is kept of it"), "{text}");

    // Neighbours: from a to b; 2 % of 2 m is more than a centimetre.
    assert_eq!(edges[0][..5], [0.0, 1.0, 2.0, 0.0, 0.0]);
    assert!((edges[0][9] - 625.0).abs() < 1e-9);
    // The loop: from b to c, and what is unsure along the candidate's x is unsure along the query's y.
    assert_eq!(edges[1][..5], [1.0, 2.0, 1.0, 0.0, 0.0]);
    let diagonal: Vec<f64> = [9, 15, 20, 24, 27, 29].into_iter().map(|place| edges[1][place]).collect();
    for (found, expected) in diagonal.iter().zip([100.0, 1.0, 100.0, 100.0, 100.0, 100.0]) {
        assert!((found - expected).abs() < 1e-9, "{diagonal:?}");
    }
    assert!(edges.iter().all(|edge| edge.len() == 2 + 7 + 21));
}

#[test]
fn only_a_verified_full_transformation_is_taken_from_an_answer() {
    let answer = |status: &str, model: &str| {
        format!(
            r#"{{"candidates": [{{"keyframe": "other"}}, {{"keyframe": "a", "geometry": {{"status": "{status}", "model": "{model}",
            "candidate_from_query": {{"scale": 1.0, "translation": {{"x": 1.0, "y": 2.0, "z": 3.0}},
            "rotation": {{"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}}}}}}}}]}}"#
        )
    };
    let found = MeasuredLoop::of(answer("verified", "se3").as_bytes(), "a").unwrap();
    assert_eq!(found.candidate_from_query.translation_m(), [1.0, 2.0, 3.0]);
    for (status, model) in [("failed", "se3"), ("verified", "essential"), ("verified", "rotation")] {
        assert_eq!(MeasuredLoop::of(answer(status, model).as_bytes(), "a"), None, "{status} {model}");
    }
    assert_eq!(MeasuredLoop::of(answer("verified", "se3").as_bytes(), "other"), None);
    assert_eq!(MeasuredLoop::of(b"no answer", "a"), None);
}
