//! The shortest way, held against a table of all ways.

use std::sync::Arc;

use proptest::prelude::*;

use super::*;
use crate::domain::bow::BowVector;
use crate::domain::change::{Change, Keyframe, Loop};
use crate::domain::ids::SessionSeq;
use crate::domain::keyframe::{NewKeyframe, Stamp};
use crate::domain::map::MapProperties;
use crate::geometry::Pose;

const UM: f64 = 1e6;

/// A keyframe at `x_m`, that shares a point with the one before it unless tracking was lost.
fn keyframe(seq: u32, session: u32, x_m: i32, is_lost: bool) -> Change {
    let points = if is_lost { vec![1000 + i64::from(seq)] } else { vec![i64::from(session)] };
    let pose = Pose::new([f64::from(x_m), 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]).unwrap();
    let stamp = Stamp { sec: i64::from(seq), nanosec: 0 };
    let new = NewKeyframe {
        observes: points,
        ..NewKeyframe::at(format!("kf-{seq}").parse().unwrap(), stamp, pose)
    };
    let keyframe = Keyframe::arriving(KeyframeSeq(seq), SessionSeq(session), &new, None);
    Change::KeyframeAdded(Box::new(keyframe), Arc::new(BowVector::default()))
}

fn closed(number: usize, a: u32, b: u32) -> Change {
    let name = |seq: u32| format!("kf-{seq}").parse().unwrap();
    Change::LoopAdded(Loop {
        id: format!("loop-{number}").parse().unwrap(),
        keyframe: KeyframeSeq(a),
        candidate: KeyframeSeq(b),
        keyframe_id: name(a),
        candidate_id: name(b),
        query: None,
        candidate_from_query: None,
    })
}

proptest! {
    #[test]
    fn the_way_by_loops_is_the_shortest_of_all_ways(
        keyframes in prop::collection::vec((0_u32..2, -9_i32..9, prop::bool::weighted(0.1)), 1..24),
        loops in prop::collection::vec((0_u32..24, 0_u32..24), 0..5),
    ) {
        let mut index = MapIndex::default();
        let mut properties = MapProperties::default();
        properties.settings.covisibility_min_shared_points = 1;
        index.apply(&[Change::MapSet(Box::new(properties))]);
        let count = keyframes.len();
        for (seq, (session, x_m, is_lost)) in keyframes.iter().enumerate() {
            index.apply(&[keyframe(seq as u32, *session, *x_m, *is_lost)]);
        }
        let mut way_um = vec![vec![None; count]; count];
        let mut last = [None; 2];
        for (seq, (session, x_m, is_lost)) in keyframes.iter().enumerate() {
            way_um[seq][seq] = Some(0);
            if let Some((before, its_x_m, was_lost)) = last[*session as usize].replace((seq, *x_m, *is_lost))
                && !is_lost && !was_lost
            {
                let step_um = (f64::from((x_m - its_x_m).abs()) * UM) as u64;
                (way_um[before][seq], way_um[seq][before]) = (Some(step_um), Some(step_um));
            }
        }
        for (number, (a, b)) in loops.iter().enumerate() {
            let ends = [*a as usize, *b as usize];
            if ends[0] != ends[1] && ends.iter().all(|end| *end < count) {
                index.apply(&[closed(number, *a, *b)]);
                (way_um[ends[0]][ends[1]], way_um[ends[1]][ends[0]]) = (Some(0), Some(0));
            }
        }
        for through in 0..count {
            for from in 0..count {
                for to in 0..count {
                    let ways = way_um[from][through].zip(way_um[through][to]);
                    let sum = ways.map(|(a, b)| a + b);
                    way_um[from][to] = way_um[from][to].into_iter().chain(sum).min();
                }
            }
        }
        let seq = |number: usize| KeyframeSeq(number as u32);
        for from in 0..count {
            for to in 0..count {
                let found = way_by_loops_um(&index, seq(from), seq(to), |_| true);
                prop_assert_eq!(found, way_um[from][to], "{} to {}", from, to);
                let short = way_by_loops_um(&index, seq(from), seq(to), |way_um| way_um <= 4_000_000);
                prop_assert_eq!(short, way_um[from][to].filter(|way_um| *way_um <= 4_000_000));
            }
            let session = keyframes[from].0;
            let back: Vec<KeyframeSeq> = index.way_back(seq(from)).collect();
            let of_session = |number: &usize| keyframes[*number].0 == session;
            let expected: Vec<KeyframeSeq> = (0..=from).rev().filter(of_session).map(seq).collect();
            prop_assert_eq!(back, expected);
            prop_assert_eq!(index.is_last_on_way(seq(from)), (from + 1..count).all(|other| !of_session(&other)));
        }
    }
}
