//! The letter: what is left when the redundant keyframes are gone.

use std::sync::Arc;

use proptest::prelude::*;

use super::*;
use crate::domain::bow::BowVector;
use crate::domain::keyframe::{Detection, NewKeyframe, Stamp};
use crate::geometry::{Point3, Pose};
use crate::recognition::anchors::ingest::ingest;
use crate::recognition::map::culling::cull_keyframe;

fn keyframe(number: usize, observes: BTreeSet<i64>, sees: &BTreeSet<u8>) -> NewKeyframe {
    let sign = |place: &u8| Detection {
        position_in_session: Some(Point3::new(f64::from(*place) * 10.0, 0.0, 2.0)),
        ..Detection::of("sign", 0.9, [0.0, 0.0, 9.0, 9.0])
    };
    let id = format!("kf-{number}").parse().unwrap();
    NewKeyframe {
        observes: observes.into_iter().collect(),
        detections: sees.iter().map(sign).collect(),
        ..NewKeyframe::at(id, Stamp { sec: number as i64, nanosec: 0 }, Pose::identity())
    }
}

fn map_of(keyframes: &[(BTreeSet<i64>, BTreeSet<u8>)]) -> MapIndex {
    let mut index = MapIndex::default();
    for (number, (points, signs)) in keyframes.iter().enumerate() {
        ingest(&mut index, &keyframe(number, points.clone(), signs));
    }
    index
}

/// All pages, each before the next is asked for.
fn pages(index: &mut MapIndex, most: usize) -> BTreeSet<KeyframeSeq> {
    let (mut all, mut from) = (BTreeSet::new(), Some(KeyframeSeq(0)));
    while let Some(first) = from {
        let found = find_redundant(index, first, most);
        assert!(found.keyframes.len() <= most);
        for keyframe in &found.keyframes {
            cull_keyframe(index, *keyframe, Arc::new(BowVector::default()));
        }
        all.extend(found.keyframes);
        from = found.next;
    }
    all
}

/// Whether a keyframe is redundant beside those that go, by comparing it with every other one.
fn by_the_letter(index: &MapIndex, of: &Keyframe, going: &[KeyframeSeq]) -> bool {
    let others: Vec<&Keyframe> =
        index.keyframes().filter(|other| other.seq != of.seq && !going.contains(&other.seq)).collect();
    let points: Vec<i64> = of.observes.iter().collect();
    let seen = points.iter().filter(|id| others.iter().any(|other| other.observes.iter().any(|o| o == **id)));
    let anchors = index.objects_seen_by(of.seq);
    let are_seen =
        anchors.iter().all(|root| others.iter().any(|o| index.objects_seen_by(o.seq).contains(root)));
    !points.is_empty() && seen.count() as f64 >= 0.9 * points.len() as f64 - 1e-9 && are_seen
}

type Drawn = (BTreeSet<i64>, BTreeSet<u8>);

fn any_keyframe() -> impl Strategy<Value = Drawn> {
    let most_of_all = prop::collection::btree_set(0..22_i64, 16..22);
    let few = prop::collection::btree_set(0..22_i64, 0..22);
    (prop_oneof![most_of_all, few], prop::collection::btree_set(0..3_u8, 0..3))
}

proptest! {
    #[test]
    fn a_page_names_what_is_redundant_in_its_turn(
        keyframes in prop::collection::vec(any_keyframe(), 1..LOOKED_AT_MAX + 1),
    ) {
        let index = map_of(&keyframes);
        let mut going = Vec::new();
        for keyframe in index.keyframes() {
            if by_the_letter(&index, keyframe, &going) {
                going.push(keyframe.seq);
            }
        }
        prop_assert_eq!(find_redundant(&index, KeyframeSeq(0), 100), Redundant { keyframes: going, next: None });
    }

    #[test]
    fn no_anchor_goes_with_them_if_each_page_is_deleted_before_the_next(
        keyframes in prop::collection::vec(any_keyframe(), 1..24),
        most in 1..5_usize,
    ) {
        let before = map_of(&keyframes);
        let mut index = before.clone();
        let redundant = pages(&mut index, most);
        prop_assert_eq!(index.keyframe_count() + redundant.len(), before.keyframe_count());
        prop_assert_eq!(index.objects().len(), before.objects().len(), "an anchor is lost");
    }
}

#[test]
fn of_two_alike_one_may_go_and_nine_points_in_ten_suffice() {
    let points = |range: std::ops::Range<i64>| range.collect::<BTreeSet<i64>>();
    let seen = |index: &MapIndex| find_redundant(index, KeyframeSeq(0), 100).keyframes;
    let none = BTreeSet::new();
    let twins = [(points(0..20), none.clone()), (points(0..20), none.clone())];
    assert_eq!(seen(&map_of(&twins)), [KeyframeSeq(0)]);
    let nine = [(points(0..20), none.clone()), (points(2..40), none.clone())];
    assert_eq!(seen(&map_of(&nine)), [KeyframeSeq(0)]);
    let fewer = [(points(0..20), none.clone()), (points(3..40), none.clone())];
    assert_eq!(seen(&map_of(&fewer)), []);
    // The sign that only it saw keeps it, and what sees nothing is not named.
    let sign = [(points(0..20), BTreeSet::from([1])), (points(0..40), none.clone()), (BTreeSet::new(), none)];
    assert_eq!(seen(&map_of(&sign)), []);
}
