//! The way between keyframes, held against a walk over all of them.

use proptest::prelude::*;

use super::*;
use crate::domain::keyframe::{NewKeyframe, Stamp};
use crate::geometry::Pose;

fn keyframe(seq: u32, session: u32, sec: i64, x_m: f64) -> Keyframe {
    let pose = Pose::new([x_m, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]).unwrap();
    let new = NewKeyframe::at(format!("kf-{}", 99 - seq).parse().unwrap(), Stamp { sec, nanosec: 0 }, pose);
    Keyframe::arriving(KeyframeSeq(seq), SessionSeq(session), &new, None)
}

/// By the letter: the keyframes of the session in order, and the steps between the two.
fn naive_m(
    all: &DenseMap<Keyframe>,
    (from, to): (&Keyframe, &Keyframe),
    measure: Measure<'_>,
) -> Option<f64> {
    if from.session != to.session {
        return None;
    }
    let mut session: Vec<&Keyframe> = all.values().filter(|k| k.session == from.session).collect();
    session.sort_by(|a, b| (a.stamp, &a.id).cmp(&(b.stamp, &b.id)));
    let at = |keyframe: &Keyframe| session.iter().position(|k| k.seq == keyframe.seq).unwrap();
    let (first, last) = (at(from).min(at(to)), at(from).max(at(to)));
    let mut way_um = 0;
    for pair in session[first..=last].windows(2) {
        way_um += measure(pair[0].seq, pair[1].seq)?;
    }
    Some(way_um as f64 / UM_PER_M)
}

proptest! {
    #[test]
    fn the_way_is_the_sum_of_the_steps_whatever_came_and_went(
        requests in prop::collection::vec((0_u8..4, 0_u32..40, 0_u32..2, 0_i64..12, -9_i32..9), 1..80),
        broken in 2_u32..9,
    ) {
        let mut all: DenseMap<Keyframe> = DenseMap::default();
        let mut odometer = Odometer::default();
        for (kind, seq, session, sec, x_m) in requests {
            let known = all.get(seq as usize).cloned();
            let moved = keyframe(seq, session, sec, f64::from(x_m));
            match (kind, known) {
                (0 | 1, None) => {
                    all.insert(seq as usize, moved.clone());
                    odometer.add(&moved, &all, &|a, b| step(&all, a, b, broken));
                }
                (2, Some(known)) => {
                    odometer.remove(&known, &all, &|a, b| step(&all, a, b, broken));
                    all.remove(seq as usize);
                }
                (_, Some(known)) => {
                    let known = Keyframe { map_from_camera: moved.map_from_camera, ..known };
                    all.insert(seq as usize, known.clone());
                    odometer.moved(&known, &all, &|a, b| step(&all, a, b, broken));
                }
                _ => {}
            }
        }
        for from in all.values() {
            for to in all.values() {
                let milestone = |keyframe| odometer.milestone(keyframe, &all).unwrap();
                let found = milestone(from).way_to_m(&milestone(to));
                prop_assert_eq!(found, naive_m(&all, (from, to), &|a, b| step(&all, a, b, broken)));
            }
        }
    }
}

fn step(all: &DenseMap<Keyframe>, from: KeyframeSeq, to: KeyframeSeq, broken: u32) -> Option<u64> {
    let x_m = |seq: KeyframeSeq| all.get(seq.index()).map(|k| k.map_from_camera.translation_m()[0]);
    let length_um = ((x_m(from)? - x_m(to)?).abs() * UM_PER_M) as u64;
    (!(from.0 + to.0).is_multiple_of(broken)).then_some(length_um)
}
