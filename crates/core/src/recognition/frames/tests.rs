//! Frames held against a fleet whose truth is known, with false loops among the true ones.

use std::collections::BTreeSet;

use proptest::prelude::*;

use super::fleet;
use crate::domain::change::{Change, Loop};
use crate::domain::fleet_frames::FleetFrames;
use crate::domain::ids::{KeyframeId, LoopId, SessionSeq};
use crate::domain::keyframe::{NewKeyframe, Stamp};
use crate::domain::map::MapProperties;
use crate::geometry::{Pose, Sim3};
use crate::recognition::anchors::ingest::ingest;
use crate::recognition::map::index::MapIndex;

/// Metres between two keyframes of a robot.
const STEP_M: f64 = 1.0;
/// Keyframes of a robot: once round a square corridor.
const KEYFRAMES: usize = 48;

/// A fleet that drives one corridor, each robot in a frame of its own.
struct Fleet {
    index: MapIndex,
    world_from_session: Vec<Pose>,
    loops: usize,
    injected: BTreeSet<LoopId>,
}

fn yaw(rad: f64, at: [f64; 3]) -> Pose {
    Pose::new(at, [0.0, 0.0, (rad / 2.0).sin(), (rad / 2.0).cos()]).expect("a pose")
}

/// The place of a robot: a square of four sides, and it turns at each corner.
fn on_the_way(number: usize) -> Pose {
    let side = KEYFRAMES / 4;
    let (corner, along) = (number / side, (number % side) as f64 * STEP_M);
    let length = side as f64 * STEP_M;
    let (x, y) = match corner {
        0 => (along, 0.0),
        1 => (length, along),
        2 => (length - along, length),
        _ => (0.0, length - along),
    };
    yaw(corner as f64 * std::f64::consts::FRAC_PI_2, [x, y, 0.0])
}

fn id(session: usize, number: usize) -> KeyframeId {
    format!("r{session}-{number}").parse().unwrap()
}

impl Fleet {
    /// Robots whose tracking drifts by this share of the way.
    fn driving(robots: usize, drift: f64) -> Self {
        let mut index = MapIndex::default();
        let mut properties = MapProperties { metric: true, ..MapProperties::default() };
        properties.settings.covisibility_min_shared_points = 3;
        index.apply(&[Change::MapSet(Box::new(properties))]);
        let mut world_from_session = Vec::new();
        for robot in 0..robots {
            let truth = yaw(robot as f64 * 0.7, [robot as f64 * 31.0, -5.0 * robot as f64, 0.0]);
            for number in 0..KEYFRAMES {
                let in_session = truth.inverse().after(&on_the_way(number));
                let [x, y, z] = in_session.translation_m();
                let off = drift * number as f64 * STEP_M / (robot + 1) as f64;
                let pose = Pose::new([x + off, y, z], in_session.rotation_xyzw()).expect("a pose");
                let first = number as i64 * 4;
                ingest(
                    &mut index,
                    &NewKeyframe {
                        session: format!("robot-{robot}").parse().unwrap(),
                        observes: (first..first + 10).collect(),
                        ..NewKeyframe::at(id(robot, number), Stamp { sec: number as i64, nanosec: 0 }, pose)
                    },
                );
            }
            world_from_session.push(truth);
        }
        Self { index, world_from_session, loops: 0, injected: BTreeSet::new() }
    }

    /// Closes a loop between the keyframes of two robots, displaced by this in the candidate's camera frame.
    fn close(&mut self, (a, at_a): (usize, usize), (b, at_b): (usize, usize), displaced: [f64; 3]) -> LoopId {
        let true_one = on_the_way(at_a).inverse().after(&on_the_way(at_b));
        let measured = Pose::new(displaced, [0.0, 0.0, 0.0, 1.0]).unwrap().after(&true_one);
        self.loops += 1;
        let loop_id: LoopId = format!("loop-{:04}", self.loops).parse().unwrap();
        let seq = |robot, number| self.index.keyframe_seq(&id(robot, number)).unwrap();
        let closed = Loop {
            id: loop_id.clone(),
            keyframe: seq(b, at_b),
            candidate: seq(a, at_a),
            keyframe_id: id(b, at_b),
            candidate_id: id(a, at_a),
            query: None,
            candidate_from_query: Some(Sim3::from(measured)),
        };
        self.index.apply(&[Change::LoopAdded(closed)]);
        loop_id
    }

    fn inject(&mut self, a: (usize, usize), b: (usize, usize), displaced: [f64; 3]) {
        let loop_id = self.close(a, b, displaced);
        self.injected.insert(loop_id);
    }

    /// The largest error of a session's place, in metres at the middle of the corridor, and in radians.
    fn error(&self, frames: &FleetFrames) -> (f64, f64) {
        let mut worst: (f64, f64) = (0.0, 0.0);
        for of in &frames.sessions {
            let truth = |session: SessionSeq| self.world_from_session[session.index()];
            let root_from_session = truth(of.root).inverse().after(&truth(of.session));
            let middle = truth(of.session).inverse_transform(&crate::geometry::Point3::new(6.0, 6.0, 0.0));
            let off = of.root_from_session.transform(&middle) - root_from_session.transform(&middle);
            let turned =
                of.root_from_session.isometry().rotation.angle_to(&root_from_session.isometry().rotation);
            worst = (worst.0.max(off.norm()), worst.1.max(turned));
        }
        worst
    }
}

/// The frames of a map.
fn fleet_frames(index: &MapIndex) -> FleetFrames {
    fleet::fleet_frames(&fleet::measured(index))
}

fn suspected(frames: &FleetFrames) -> BTreeSet<LoopId> {
    frames.suspects.iter().map(|suspect| suspect.loop_id.clone()).collect()
}

#[test]
fn sessions_that_loops_join_lie_where_they_drove() {
    let mut fleet = Fleet::driving(4, 0.0);
    for (a, b) in [(0, 1), (1, 2), (0, 3)] {
        for place in [3, 20, 40] {
            fleet.close((a, place), (b, place + 1), [0.0; 3]);
        }
    }
    let frames = fleet_frames(&fleet.index);
    let (off_m, off_rad) = fleet.error(&frames);
    assert!(off_m < 1e-6 && off_rad < 1e-7, "{off_m} m, {off_rad} rad");
    assert!(frames.sessions.iter().all(|of| of.root == SessionSeq(0)));
    assert_eq!((frames.loops, frames.left_out, frames.suspects.len()), (9, 0, 0));
    let loops: Vec<usize> = frames.sessions.iter().map(|of| of.loops).collect();
    assert_eq!(loops, [6, 6, 3, 3]);
}

#[test]
fn a_session_without_loops_stands_alone_and_one_without_a_transformation_is_counted() {
    let mut fleet = Fleet::driving(3, 0.0);
    let known = fleet.close((0, 3), (1, 3), [0.0; 3]);
    let mut unknown = fleet.index.loops()[&known].clone();
    unknown.id = "unknown".parse().unwrap();
    unknown.candidate_from_query = None;
    fleet.index.apply(&[Change::LoopAdded(unknown)]);
    let frames = fleet_frames(&fleet.index);
    let roots: Vec<u32> = frames.sessions.iter().map(|of| of.root.0).collect();
    assert_eq!(roots, [0, 0, 2]);
    assert_eq!((frames.loops, frames.left_out), (1, 1));
    assert_eq!(frames.sessions[2].residual_m, None);
}

#[test]
fn a_false_loop_is_shown_by_the_cycle_that_it_breaks() {
    let mut fleet = Fleet::driving(3, 0.0);
    let first = fleet.close((0, 10), (1, 10), [0.0; 3]);
    fleet.close((0, 30), (1, 30), [0.0; 3]);
    let second = fleet.close((1, 10), (2, 10), [0.0; 3]);
    fleet.close((1, 30), (2, 30), [0.0; 3]);
    // One door on.
    fleet.inject((0, 10), (2, 10), [3.0, 0.0, 0.0]);
    let frames = fleet_frames(&fleet.index);
    assert_eq!(suspected(&frames), fleet.injected);
    let suspect = &frames.suspects[0];
    assert_eq!(suspect.cycle, [first, second]);
    assert!((suspect.off_m - 3.0).abs() < 1e-6 && suspect.off_rad < 1e-6, "{suspect:?}");
}

#[test]
fn of_two_loops_that_contradict_each_other_and_nothing_else_both_are_suspects() {
    let mut fleet = Fleet::driving(2, 0.0);
    let one = fleet.close((0, 10), (1, 10), [0.0; 3]);
    let other = fleet.close((0, 12), (1, 12), [4.0, 0.0, 0.0]);
    let frames = fleet_frames(&fleet.index);
    let cycles: Vec<_> = frames.suspects.iter().map(|s| (s.loop_id.clone(), s.cycle.clone())).collect();
    assert_eq!(cycles, [(one.clone(), vec![other.clone()]), (other, vec![one])]);
    assert!(frames.sessions.iter().all(|of| of.root == of.session), "nothing tells where the two lie");
}

#[test]
fn doors_that_all_look_alike_are_outvoted() {
    let mut fleet = Fleet::driving(4, 0.0);
    for (a, b) in [(0, 1), (1, 2), (2, 3), (0, 2)] {
        for place in [3, 13, 23, 33] {
            fleet.close((a, place), (b, place), [0.02, -0.03, 0.0]);
        }
        // Two that agree with each other, one door on.
        for place in [8, 10] {
            fleet.inject((a, place), (b, place), [3.0, 0.0, 0.0]);
        }
    }
    let frames = fleet_frames(&fleet.index);
    assert_eq!(suspected(&frames), fleet.injected);
    let (off_m, off_rad) = fleet.error(&frames);
    assert!(off_m < 0.1 && off_rad < 0.0175, "{off_m} m, {off_rad} rad");
}

#[test]
fn a_pair_whose_false_loops_agree_is_outvoted_by_the_cycles() {
    let mut fleet = Fleet::driving(3, 0.0);
    for (a, b) in [(0, 1), (1, 2)] {
        for place in [3, 13, 23, 33] {
            fleet.close((a, place), (b, place), [0.0; 3]);
        }
    }
    // Most loops between these two are false, and agree.
    for place in [8, 9, 10] {
        fleet.inject((0, place), (2, place), [3.0, 0.0, 0.0]);
    }
    fleet.close((0, 9), (2, 9), [0.0; 3]);
    let frames = fleet_frames(&fleet.index);
    assert_eq!(suspected(&frames), fleet.injected);
    assert!(fleet.error(&frames).0 < 0.02, "{:?}", fleet.error(&frames));
}

/// A loop between two robots, where, by how much it is off, and whether it is false.
type AnyLoop = ((usize, usize), usize, [f64; 3]);

fn any_loops(robots: usize) -> impl Strategy<Value = (Vec<AnyLoop>, Vec<AnyLoop>)> {
    let pair = (0..robots, 1..robots).prop_map(move |(a, by)| (a, (a + by) % robots));
    let noise = prop::array::uniform3(-0.05..0.05f64);
    let false_by =
        (3.0..20.0f64, 0.0..6.3f64).prop_map(|(by, towards)| [by * towards.cos(), by * towards.sin(), 0.0]);
    let true_ones = prop::collection::vec((pair.clone(), 0..KEYFRAMES, noise), 40..60);
    let false_ones = prop::collection::vec((pair, 0..KEYFRAMES, false_by), 0..20);
    (true_ones, false_ones)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    /// A third of the loops may be false, and tracking drifts by a hundredth of the way.
    #[test]
    fn true_loops_place_the_fleet_whatever_false_ones_are_among_them((true_ones, false_ones) in any_loops(4)) {
        let mut fleet = Fleet::driving(4, 0.01);
        for ((a, b), place, off) in true_ones {
            fleet.close((a, place), (b, place), off);
        }
        for ((a, b), place, off) in false_ones {
            fleet.inject((a, place), (b, place), off);
        }
        let frames = fleet_frames(&fleet.index);
        let (off_m, off_rad) = fleet.error(&frames);
        // Drift alone puts the frames half a metre off.
        prop_assert!(off_m < 1.0 && off_rad < 0.1, "{} m, {} rad", off_m, off_rad);
        let suspected = suspected(&frames);
        let innocent: Vec<_> = suspected.difference(&fleet.injected).collect();
        prop_assert!(innocent.is_empty(), "suspected, and true: {:?}", innocent);
        let missed = fleet.injected.difference(&suspected).count();
        prop_assert!(missed * 10 <= fleet.injected.len(), "{} of {} were missed", missed, fleet.injected.len());
    }

    /// The order in which loops were closed, and the names of sessions, say nothing but which of equals goes first.
    #[test]
    fn the_same_facts_give_the_same_frames((true_ones, _) in any_loops(3)) {
        let build = || {
            let mut fleet = Fleet::driving(3, 0.01);
            for ((a, b), place, off) in &true_ones {
                fleet.close((*a, *place), (*b, *place), *off);
            }
            fleet_frames(&fleet.index)
        };
        prop_assert_eq!(build(), build());
    }
}
