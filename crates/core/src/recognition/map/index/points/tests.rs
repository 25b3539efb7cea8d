//! The letter: a table of points with sets of observers.

use std::collections::{BTreeMap, BTreeSet};

use proptest::prelude::*;

use super::*;

#[derive(Clone, Debug)]
enum Step {
    Place(u32, PointId, u8),
    Clear(u32, PointId),
    Observe(u32, Vec<PointId>, u32),
    Forget(u32, Vec<PointId>, u32),
}

fn id() -> impl Strategy<Value = PointId> {
    prop_oneof![6 => 0..200_i64, 1 => Just(i64::MAX), 1 => Just(i64::MIN), 1 => -70..0_i64]
}

fn step() -> impl Strategy<Value = Step> {
    let ids = || prop::collection::vec(id(), 0..12);
    // Some far off, so that both ways of counting are taken.
    let keyframe = || prop_oneof![8 => 0..300_u32, 1 => Just(u32::MAX)];
    prop_oneof![
        1 => (0..2_u32, id(), any::<u8>()).prop_map(|(session, id, x)| Step::Place(session, id, x)),
        1 => (0..2_u32, id()).prop_map(|(session, id)| Step::Clear(session, id)),
        3 => (0..2_u32, ids(), keyframe()).prop_map(|(session, ids, keyframe)| Step::Observe(session, ids, keyframe)),
        1 => (0..2_u32, ids(), keyframe()).prop_map(|(session, ids, keyframe)| Step::Forget(session, ids, keyframe)),
    ]
}

type Table = BTreeMap<(SessionSeq, PointId), (Option<Point3>, BTreeSet<KeyframeSeq>)>;

fn take(points: &mut Points, table: &mut Table, step: &Step) {
    match step {
        Step::Place(session, id, x) => {
            let at = Point3::new(f64::from(*x), 0.0, 1.0);
            points.set_position(SessionSeq(*session), *id, at);
            table.entry((SessionSeq(*session), *id)).or_default().0 = Some(at);
        }
        Step::Clear(session, id) => {
            points.clear_position(SessionSeq(*session), *id);
            table.entry((SessionSeq(*session), *id)).or_default().0 = None;
        }
        Step::Observe(session, ids, keyframe) => {
            points.observe(SessionSeq(*session), ids.iter().copied(), KeyframeSeq(*keyframe));
            for id in ids {
                table.entry((SessionSeq(*session), *id)).or_default().1.insert(KeyframeSeq(*keyframe));
            }
        }
        Step::Forget(session, ids, keyframe) => {
            points.forget(SessionSeq(*session), ids.iter().copied(), KeyframeSeq(*keyframe));
            for id in ids {
                table.entry((SessionSeq(*session), *id)).or_default().1.remove(&KeyframeSeq(*keyframe));
            }
        }
    }
    table.retain(|_, (position, observers)| position.is_some() || !observers.is_empty());
}

fn rebuilt(table: &Table) -> Points {
    let mut points = Points::default();
    for ((session, id), (position, observers)) in table.iter().rev() {
        observers.iter().rev().for_each(|keyframe| points.observe(*session, [*id], *keyframe));
        if let Some(position) = position {
            points.set_position(*session, *id, *position);
        }
    }
    points
}

proptest! {
    #[test]
    fn pages_answer_as_a_table_of_points_does(
        steps in prop::collection::vec(step(), 0..60),
        asked in prop::collection::vec(id(), 0..30),
    ) {
        let (mut points, mut table) = (Points::default(), Table::new());
        for step in &steps {
            take(&mut points, &mut table, step);
        }
        for session in [0, 1].map(SessionSeq) {
            let mut shared: BTreeMap<KeyframeSeq, u32> = BTreeMap::new();
            for id in &asked {
                let known = table.get(&(session, *id)).cloned().unwrap_or_default();
                prop_assert_eq!(points.position(session, *id), known.0);
                prop_assert_eq!(points.is_observed(session, *id), !known.1.is_empty());
            }
            for id in asked.iter().collect::<BTreeSet<_>>() {
                let (_, observers) = table.get(&(session, *id)).cloned().unwrap_or_default();
                for keyframe in observers {
                    *shared.entry(keyframe).or_default() += 1;
                }
            }
            let found = points.sharing(session, asked.iter().copied());
            prop_assert_eq!(found, shared.into_iter().collect::<Vec<_>>());
        }
        let placed = table.values().filter(|(position, _)| position.is_some()).count() as u64;
        prop_assert_eq!(points.bytes(), placed * POINT_BYTES);
        let rebuilt = rebuilt(&table);
        prop_assert_eq!(&rebuilt, &points);
        prop_assert_eq!(rebuilt.page_bytes, points.pages.values().map(Page::heap_bytes).sum::<usize>());
    }
}

#[test]
fn forgotten_points_take_no_page() {
    let mut points = Points::default();
    points.observe(SessionSeq(0), 0..1_000, KeyframeSeq(0));
    points.forget(SessionSeq(0), 0..1_000, KeyframeSeq(0));
    assert!(points.pages.is_empty() && points.page_bytes == 0);
}
