//! The letter: every pair of keyframes is compared, point by point.

use crate::domain::observation_update::Renamed;
use std::collections::BTreeMap;
use std::sync::Arc;

use proptest::prelude::*;

use super::*;
use crate::domain::bow::BowVector;
use crate::domain::change::{Change, Keyframe, Loop, PointsOfKeyframe};
use crate::domain::ids::{KeyframeId, LoopId, PointId, SessionSeq};
use crate::domain::keyframe::{NewKeyframe, Stamp};
use crate::domain::map::MapProperties;
use crate::geometry::Pose;

#[derive(Clone, Debug)]
enum Step {
    /// `at` is the second, and the place in metres; `declared` has a list, and perhaps a keyframe in it.
    Add {
        session: u32,
        at: (u8, u8),
        observes: BTreeSet<PointId>,
        declared: Option<Vec<(u32, u32)>>,
    },
    Observe {
        seq: u32,
        observes: BTreeSet<PointId>,
        declared: Option<(u32, u32)>,
    },
    Remove(u32),
    Close(u32, u32, u32),
    Revoke(u32),
    Enough(u32),
}

fn step() -> impl Strategy<Value = Step> {
    let points = || prop_oneof![Just(BTreeSet::new()), prop::collection::btree_set(0..8_i64, 0..8)];
    let list = prop::option::of(prop::collection::vec((0..12_u32, 0..9_u32), 0..2));
    let add = (0..2_u32, (0..40_u8, 0..12_u8), points(), list);
    prop_oneof![
        8 => add.prop_map(|(session, at, observes, declared)| Step::Add { session, at, observes, declared }),
        3 => (0..20_u32, points(), prop::option::of((0..20_u32, 0..9_u32)))
            .prop_map(|(seq, observes, declared)| Step::Observe { seq, observes, declared }),
        2 => (0..20_u32).prop_map(Step::Remove),
        1 => (0..3_u32, 0..20_u32, 0..20_u32).prop_map(|(id, a, b)| Step::Close(id, a, b)),
        1 => (0..3_u32).prop_map(Step::Revoke),
        1 => (1..5_u32).prop_map(Step::Enough),
    ]
}

fn keyframe_id(seq: KeyframeSeq) -> KeyframeId {
    format!("kf-{}", seq.0).parse().unwrap()
}

fn loop_id(number: u32) -> LoopId {
    format!("loop-{number}").parse().unwrap()
}

fn no_words() -> Arc<BowVector> {
    Arc::new(BowVector::default())
}

fn enough(min: u32) -> Change {
    let mut properties = MapProperties::default();
    properties.settings.covisibility_min_shared_points = min;
    Change::MapSet(Box::new(properties))
}

fn change_of(index: &MapIndex, step: &Step) -> Option<Change> {
    match step {
        Step::Add { session, at: (second, metre), observes, declared } => {
            let list = |listed: &Vec<(u32, u32)>| {
                let listed = listed.iter().map(|(other, points)| (KeyframeSeq(*other), *points));
                listed.filter(|(other, _)| index.keyframe(*other).is_some()).collect()
            };
            let pose = Pose::new([f64::from(*metre), 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]).unwrap();
            let stamp = Stamp { sec: i64::from(*second), nanosec: 0 };
            let new = NewKeyframe {
                observes: observes.iter().copied().collect(),
                ..NewKeyframe::at(keyframe_id(index.next_keyframe()), stamp, pose)
            };
            let declared = declared.as_ref().map(list);
            let keyframe = Keyframe::arriving(index.next_keyframe(), SessionSeq(*session), &new, declared);
            Some(Change::KeyframeAdded(Box::new(keyframe), no_words()))
        }
        Step::Observe { seq, observes, declared } => {
            let keyframe = index.keyframe(KeyframeSeq(*seq))?;
            let mut all = keyframe.declared.clone().map(Vec::from);
            let is_other = |other: &KeyframeSeq| other.0 != *seq && index.keyframe(*other).is_some();
            let declared = declared.map(|(other, points)| (KeyframeSeq(other), points));
            if let Some((other, points)) = declared.filter(|(other, _)| is_other(other)) {
                let all = all.get_or_insert_default();
                all.retain(|(known, _)| *known != other);
                all.push((other, points));
            }
            let points = PointsOfKeyframe {
                keyframe: keyframe.seq,
                observes: observes.iter().copied().collect(),
                declared: all.map(Into::into),
                renamed: Renamed::default(),
                bytes: 1,
            };
            Some(Change::PointsOfKeyframeSet(Box::new(points)))
        }
        Step::Remove(seq) => Some(Change::KeyframeRemoved(KeyframeSeq(*seq), no_words())),
        Step::Close(id, a, b) => {
            let (keyframe, candidate) = (KeyframeSeq(*a), KeyframeSeq(*b));
            let both = a != b && index.keyframe(keyframe).is_some() && index.keyframe(candidate).is_some();
            let (keyframe_id, candidate_id) = (keyframe_id(keyframe), keyframe_id(candidate));
            let closed = Loop {
                id: loop_id(*id),
                keyframe,
                candidate,
                keyframe_id,
                candidate_id,
                query: None,
                candidate_from_query: None,
            };
            (both && !index.loops().contains_key(&closed.id)).then_some(Change::LoopAdded(closed))
        }
        Step::Revoke(id) => Some(Change::LoopRemoved(loop_id(*id))),
        Step::Enough(min) => Some(enough(*min)),
    }
}

/// Why two keyframes are covisible: shared points, if enough; the number declared; a loop; the drive.
type Reasons = (u32, Option<u32>, bool, bool);

fn by_the_letter(index: &MapIndex, a: &Keyframe, b: &Keyframe) -> Option<Reasons> {
    let of_b: BTreeSet<PointId> = b.observes.iter().collect();
    let common = a.observes.iter().filter(|id| of_b.contains(id)).count() as u32;
    let is_enough =
        a.session == b.session && common >= index.properties().settings.covisibility_min_shared_points;
    let told = |by: &Keyframe, of: &Keyframe| {
        by.declared().iter().find(|(other, _)| *other == of.seq).map(|(_, points)| *points)
    };
    let joined = index.loops().values().any(|closed| {
        [(closed.keyframe, closed.candidate), (closed.candidate, closed.keyframe)].contains(&(a.seq, b.seq))
    });
    let near = are_near(index, a, b);
    let reasons = (if is_enough { common } else { 0 }, told(a, b).max(told(b, a)), joined, near);
    (a.seq != b.seq && (reasons.0 > 0 || reasons.1.is_some() || joined || near)).then_some(reasons)
}

fn are_near(index: &MapIndex, a: &Keyframe, b: &Keyframe) -> bool {
    let order = |keyframe: &Keyframe| (keyframe.stamp, keyframe.id.clone());
    let (first, last) = (order(a).min(order(b)), order(a).max(order(b)));
    let mut drive: Vec<&Keyframe> =
        index.keyframes().filter(|keyframe| keyframe.session == a.session).collect();
    drive.retain(|keyframe| (first.clone()..=last.clone()).contains(&order(keyframe)));
    drive.sort_by_key(|keyframe| order(keyframe));
    let centre = |keyframe: &Keyframe| keyframe.map_from_camera.centre();
    let way_m: f64 = drive.windows(2).map(|pair| (centre(pair[1]) - centre(pair[0])).norm()).sum();
    let is_unlinked = |keyframe: &Keyframe| keyframe.observes.iter().next().is_none();
    a.session == b.session
        && a.declared.is_none()
        && b.declared.is_none()
        && (is_unlinked(a) || is_unlinked(b))
        && way_m <= 3.0
        && (a.stamp.sec - b.stamp.sec).abs() <= 20
}

fn check(index: &MapIndex, some: &BTreeSet<u32>) {
    let graph = index.covisibility();
    let mut around = BTreeMap::new();
    for a in index.keyframes() {
        let letter: Vec<(KeyframeSeq, Reasons)> =
            index.keyframes().filter_map(|b| Some((b.seq, by_the_letter(index, a, b)?))).collect();
        let neighbours: Vec<KeyframeSeq> = letter.iter().map(|(seq, _)| *seq).collect();
        assert_eq!(graph.neighbours(a.seq).collect::<Vec<_>>(), neighbours);
        assert_eq!(graph.degree(a.seq), letter.len());
        let shared: Vec<_> =
            letter.iter().map(|(seq, (points, told, ..))| (*seq, *points.max(&told.unwrap_or(0)))).collect();
        assert_eq!(graph.shared(a.seq).collect::<Vec<_>>(), shared);
        let sharing: Vec<_> =
            letter.iter().filter(|(_, reasons)| reasons.0 > 0).map(|(seq, _)| *seq).collect();
        assert_eq!(graph.sharing(a.seq).iter().map(|(other, _)| *other).collect::<Vec<_>>(), sharing);
        for b in index.keyframes() {
            let reasons = by_the_letter(index, a, b);
            assert_eq!(graph.joins(a.seq, b.seq), reasons.is_some());
            let by_sight =
                reasons.is_some_and(|(points, told, _, near)| points > 0 || told.is_some() || near);
            assert_eq!(graph.joins_by_sight(a.seq, b.seq), by_sight);
            let is_neighbour = graph.neighbours_by_sight(a.seq).any(|other| other == b.seq);
            assert_eq!(is_neighbour, by_sight);
        }
        around.insert(a.seq, neighbours);
    }
    let asked: BTreeSet<KeyframeSeq> = some.iter().map(|seq| KeyframeSeq(*seq)).collect();
    let mut expected = asked.clone();
    expected.extend(asked.iter().filter_map(|seq| around.get(seq)).flatten());
    assert_eq!(graph.around(&asked), expected.iter().copied().collect::<Vec<_>>());
    for other in index.keyframes() {
        let others = BTreeSet::from([other.seq, KeyframeSeq(other.seq.0 + 5)]);
        assert_eq!(graph.touches(&asked, &others), !expected.is_disjoint(&others));
    }
}

/// The same facts, the newest first.
fn rebuilt(index: &MapIndex) -> MapIndex {
    let mut other = MapIndex::default();
    other.apply(&[Change::MapSet(Box::new(index.properties().clone()))]);
    let mut keyframes: Vec<&Keyframe> = index.keyframes().collect();
    keyframes.reverse();
    for keyframe in keyframes {
        other.apply(&[Change::KeyframeAdded(Box::new(keyframe.clone()), no_words())]);
    }
    for closed in index.loops().values() {
        other.apply(&[Change::LoopAdded(closed.clone())]);
    }
    other
}

proptest! {
    #[test]
    fn lists_and_counts_answer_as_comparing_every_pair_does(
        steps in prop::collection::vec(step(), 0..40),
        some in prop::collection::btree_set(0..20_u32, 0..6),
    ) {
        let mut index = MapIndex::default();
        index.apply(&[enough(2)]);
        for step in &steps {
            if let Some(change) = change_of(&index, step) {
                index.apply(&[change]);
            }
        }
        check(&index, &some);
        let rebuilt = rebuilt(&index);
        check(&rebuilt, &some);
        prop_assert_eq!(rebuilt.covisibility_lists(), index.covisibility_lists());
        prop_assert_eq!(rebuilt.points(), index.points());
    }
}

#[test]
fn keyframes_of_one_place_are_not_listed() {
    let mut index = MapIndex::default();
    for _ in 0..50 {
        let step = Step::Add { session: 0, at: (0, 0), observes: (0..15).collect(), declared: None };
        let change = change_of(&index, &step).unwrap();
        index.apply(&[change]);
    }
    let all: Vec<KeyframeSeq> = (0..50).map(KeyframeSeq).collect();
    assert!(all.iter().all(|seq| index.covisibility_lists().listed(*seq).is_none()));
    assert_eq!(index.covisibility().degree(KeyframeSeq(7)), 49);
    assert_eq!(index.covisibility().around(&[KeyframeSeq(7)].into()), all);
}
