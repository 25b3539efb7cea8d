//! Laws of large changes: deferred and folded in slices, they leave what writing them at once leaves; and a deletion in slices
//! leaves nothing of its map and everything of the others. Jobs that share a transaction leave what each of them leaves alone.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use proptest::prelude::*;
use revisit_core::domain::anchor::Outcome;
use revisit_core::domain::bow::BowVector;
use revisit_core::domain::change::{Change, Keyframe, PointsOfKeyframe, Renamed};
use revisit_core::domain::event::{Event, EventKind};
use revisit_core::domain::former::FormerValues;
use revisit_core::domain::ids::{AnchorSeq, KeyframeSeq, SessionSeq};
use revisit_core::domain::keyframe::{Detection, NewKeyframe, Stamp};
use revisit_core::domain::map::{Learned, MapFigures, MapProperties};
use revisit_core::geometry::{Point3, Pose, Sim3};
use revisit_core::recognition::map::index::MapIndex;

use super::commit::staging;
use super::facts::Order;
use super::loading::deferred;
use super::loading::load::load;
use super::slices::{deletion, fold};
use super::test_database::{a_line, database};
use crate::commit::write;
use crate::jobs::job::{Batch, Job, NewKeyframeRows};
use crate::map_key::MapKey;
use crate::sql::{self, Connection, Pool};

const KEYFRAMES: u32 = 6;

fn batch(map: MapKey, version: u64, changes: Vec<Change>) -> Batch {
    Batch {
        map,
        version,
        next_keyframe: KeyframeSeq(KEYFRAMES),
        next_anchor: AnchorSeq(KEYFRAMES),
        next_event: 1,
        figures: MapFigures::default(),
        learned: Learned::default(),
        memory_bytes: 0,
        changes,
        former: FormerValues::default(),
        new_keyframe: None,
        events: Vec::new(),
        is_followed: false,
    }
}

async fn execute(db: &mut Connection, job: &Job) {
    write::execute(db, std::iter::once(job)).await.unwrap();
}

async fn make_map(db: &mut Connection, map: MapKey) {
    for job in map_jobs(map) {
        execute(db, &job).await;
    }
}

/// Returns the jobs that make the map that gets this key, with keyframes of two sessions, each of which sees an anchor of its own at a position.
fn map_jobs(map: MapKey) -> Vec<Job> {
    let properties = Box::new(MapProperties::default());
    let id = format!("map-{map}").parse().unwrap();
    let mut jobs = vec![Job::CreateMap { id, properties, digest: [0; 32], owner: None }];
    for seq in 0..KEYFRAMES {
        let session = SessionSeq(seq % 2);
        let pose = Pose::new([f64::from(seq), 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]).unwrap();
        let new = NewKeyframe {
            session: format!("robot-{}", session.0).parse().unwrap(),
            bow: BowVector::normalised(vec![(seq, 1.0)]).unwrap(),
            detections: vec![Detection {
                position_in_session: Some(Point3::new(f64::from(seq), 1.0, 1.0)),
                text: Some(format!("room {seq}")),
                ..Detection::of("sign", 0.5, [0.0, 0.0, 9.0, 9.0])
            }],
            ..NewKeyframe::at(format!("kf-{seq}").parse().unwrap(), Stamp { sec: 1, nanosec: 0 }, pose)
        };
        let keyframe = Keyframe::arriving(KeyframeSeq(seq), session, &new, None);
        let mut changes = Vec::new();
        if seq < 2 {
            changes.push(Change::SessionAdded(session, new.session.clone()));
        }
        changes.push(Change::KeyframeAdded(Box::new(keyframe), Arc::new(new.bow.clone())));
        changes.push(Change::AnchorAdded(AnchorSeq(seq), "sign".into()));
        changes.push(Change::OutcomeSet(KeyframeSeq(seq), 0, Outcome::Created(AnchorSeq(seq))));
        changes.push(Change::PointSet(session, i64::from(seq), Point3::new(0.5, 0.5, f64::from(seq))));
        let rows = NewKeyframeRows { keyframe: Arc::new(new), digest: [seq as u8; 32] };
        let made = Batch { new_keyframe: Some(rows), ..batch(map, 2, changes) };
        jobs.push(Job::Change(Box::new(made)));
    }
    let first = KeyframeSeq(0);
    let points = PointsOfKeyframe {
        keyframe: first,
        // Points that no step forgets.
        observes: vec![43, 45].into(),
        declared: None,
        renamed: Renamed { pairs: [(44, 45)].into(), is_complete: false },
        bytes: 100,
    };
    let changes = vec![
        Change::PointsOfKeyframeSet(Box::new(points)),
        Change::PointsOfDetectionSet(AnchorSeq(0), first, 0, [45].into()),
    ];
    jobs.push(Job::Change(Box::new(batch(map, 2, changes))));
    jobs
}

#[derive(Clone, Debug)]
enum Step {
    Correct {
        poses: Vec<(u32, i8)>,
        points: Vec<(u32, i64, i8)>,
        touched: Vec<u32>,
    },
    Forget {
        session: u32,
        points: Vec<i64>,
    },
    Cull(u32),
    /// Folds this many entries.
    Fold(usize),
}

fn any_step() -> impl Strategy<Value = Step> {
    let poses = prop::collection::vec((0..KEYFRAMES, any::<i8>()), 0..8);
    let points = prop::collection::vec((0u32..2, 0i64..40, any::<i8>()), 0..30);
    let touched = prop::collection::vec(0..KEYFRAMES, 0..4);
    prop_oneof![
        4 => (poses, points, touched)
            .prop_map(|(poses, points, touched)| Step::Correct { poses, points, touched }),
        2 => (0u32..2, prop::collection::vec(0i64..40, 1..30))
            .prop_map(|(session, points)| Step::Forget { session, points }),
        1 => (0..KEYFRAMES).prop_map(Step::Cull),
        5 => (1usize..20).prop_map(Step::Fold),
    ]
}

fn changes_of(step: &Step, version: u64) -> Vec<Change> {
    match step {
        Step::Correct { poses, points, touched } => {
            let mut changes = Vec::new();
            for (keyframe, x) in poses {
                let (seq, x) = (KeyframeSeq(*keyframe), f64::from(*x));
                let pose = Sim3::new(2.0, [x, 0.0, 1.0], [0.0, 0.0, 0.0, 1.0]).unwrap();
                changes.push(Change::PoseSet(seq, pose));
            }
            let set = |(session, id, x): &(u32, i64, i8)| {
                Change::PointSet(SessionSeq(*session), *id, Point3::new(f64::from(*x), 0.0, 0.0))
            };
            changes.extend(points.iter().map(set));
            changes.extend(touched.iter().map(|anchor| Change::AnchorTouched(AnchorSeq(*anchor), version)));
            changes
        }
        Step::Forget { session, points } => {
            vec![Change::PointsForgotten(SessionSeq(*session), points.clone().into())]
        }
        Step::Cull(keyframe) => vec![
            Change::KeyframeRemoved(
                KeyframeSeq(*keyframe),
                Arc::new(BowVector::normalised(vec![(*keyframe, 1.0)]).unwrap()),
            ),
            Change::AnchorRemoved(AnchorSeq(*keyframe)),
        ],
        Step::Fold(_) => Vec::new(),
    }
}

async fn index_of(db: &mut Connection, order: Order) -> MapIndex {
    let mut index = MapIndex::default();
    let id = "map-1".parse().unwrap();
    let facts = load(db, &id, order, |changes| index.apply(&changes)).await.unwrap().unwrap();
    index.reserve(facts.next_keyframe.0, facts.next_anchor.0);
    index
}

/// Returns every row that a deferred change may touch, as text.
async fn rows_of(pool: &Pool) -> Vec<String> {
    let select = "select 'pose ' || keyframe || ' ' || hex(pose) || ' ' || scale from keyframes
        union all select 'anchor ' || anchor || ' ' || version from anchors
        union all select 'points ' || session || ' ' || block || ' ' || hex(points) from point_blocks
        union all select 'waits ' || map_key from maps where waits_version is not null
        union all select 'left ' || version || ' ' || part from versions where kind = 'passing'
        order by 1";
    sql::query_scalar(select).fetch_all(pool).await.unwrap()
}

async fn holds_after(steps: Vec<Step>) {
    let ((_a, at_once), (_b, in_slices)) = (database().await, database().await);
    let mut plain = at_once.acquire().await.unwrap();
    let mut sliced = in_slices.acquire().await.unwrap();
    make_map(&mut plain, 1).await;
    make_map(&mut sliced, 1).await;
    for (version, step) in (3..).zip(steps) {
        if let Step::Fold(entries) = step {
            fold::fold(&mut sliced, None, entries).await.unwrap();
        }
        let changes = changes_of(&step, version);
        let direct = Job::Change(Box::new(batch(1, version, changes.clone())));
        execute(&mut plain, &direct).await;
        for job in staging::staged(Job::Change(Box::new(batch(1, version, changes)))) {
            execute(&mut sliced, &job).await;
        }
        let expected = index_of(&mut plain, Order::Forwards).await;
        assert!(index_of(&mut sliced, Order::Forwards).await == expected, "after {step:?}");
        assert!(index_of(&mut sliced, Order::Backwards).await == expected, "backwards, after {step:?}");
    }
    while fold::fold(&mut sliced, None, 7).await.unwrap() {}
    drop((plain, sliced));
    assert_eq!(rows_of(&in_slices).await, rows_of(&at_once).await);
}

/// Returns the jobs of a fleet on two maps; each step is a few of them.
fn jobs_of(steps: &[(bool, Step)]) -> Vec<Job> {
    let mut jobs = map_jobs(1);
    jobs.extend(map_jobs(2));
    for (number, (is_second, step)) in (3..).zip(steps) {
        let map = if *is_second { 2 } else { 1 };
        let event = |seq: u64| Event {
            seq,
            kind: EventKind::AnchorsMerged,
            map_version: number,
            told: None,
            anchor: Some(AnchorSeq(seq as u32)),
            other: None,
            keyframe: Some("kf-1".parse().unwrap()),
            candidate: None,
            loop_id: None,
            query: None,
            session: None,
            into: None,
            detail: None,
        };
        let query = |kept: i64| Job::KeepQuery {
            map,
            id: format!("q-{}", kept % 40),
            kept,
            line: a_line(),
            body: vec![kept as u8; 3].into(),
        };
        match step {
            Step::Fold(1) => jobs.push(Job::DeleteMap(map)),
            Step::Fold(2..8) => {
                let events = vec![event(number * 10), event(number * 10 + 1)];
                jobs.push(Job::AppendEvents(map, number * 10 + 2, events));
            }
            Step::Fold(queries) => {
                jobs.extend((0..*queries as i64).map(|n| query(number as i64 * 20 + n)));
            }
            step => {
                let events = vec![event(number * 10)];
                let batch = Batch { events, ..batch(map, number, changes_of(step, number)) };
                jobs.extend(staging::staged(Job::Change(Box::new(batch))));
            }
        }
    }
    jobs
}

/// Every row of every table that has rows of maps, but for when it was written.
async fn dump(db: &mut Connection) -> Vec<String> {
    let select = r#"select 'select ' || group_concat('quote(' || c.name || ')', ' || " " || ') || ' from ' || m.name
        from sqlite_schema m join pragma_table_info(m.name) c
        where m.type = 'table' and c.name not in ('stored_sec', 'asked_us', 'told_us') and exists (select 1 from pragma_table_info(m.name) k where k.name = 'map_key')
        group by m.name order by m.name"#;
    let selects: Vec<String> = sql::query_scalar(select).fetch_all(&mut *db).await.unwrap();
    let mut rows = Vec::new();
    for select in selects {
        let select = sqlx::AssertSqlSafe(select.replace('"', "'"));
        let mut of_table: Vec<String> = sql::query_scalar(select).fetch_all(&mut *db).await.unwrap();
        of_table.sort();
        rows.extend(of_table);
    }
    rows
}

/// Returns the tens of steps that SQLite takes to read what waits after so many corrections of every keyframe.
async fn steps_to_read(corrections: u64) -> u64 {
    let (_folder, pool) = database().await;
    let mut db = pool.acquire().await.unwrap();
    make_map(&mut db, 1).await;
    for version in 3..3 + corrections {
        let poses = (0..KEYFRAMES).map(|keyframe| (keyframe, version as i8)).collect();
        let step = Step::Correct { poses, points: Vec::new(), touched: Vec::new() };
        for job in staging::staged(Job::Change(Box::new(batch(1, version, changes_of(&step, version))))) {
            execute(&mut db, &job).await;
        }
    }
    let (steps, mut read) = (Arc::new(AtomicU64::new(0)), 0);
    let Connection::PooledSqlite(sqlite) = &mut db else { panic!("a pool of SQLite") };
    let counted = Arc::clone(&steps);
    sqlite.lock_handle().await.unwrap().set_progress_handler(10, move || {
        counted.fetch_add(1, Ordering::Relaxed);
        true
    });
    deferred::for_each(&mut db, 1, |changes| read += changes.len() as u64).await.unwrap();
    assert_eq!(read, corrections * u64::from(KEYFRAMES));
    steps.load(Ordering::Relaxed)
}

#[test]
fn what_waits_is_read_in_steps_that_grow_with_it() {
    let (of_few, of_many) = wait(async { (steps_to_read(200).await, steps_to_read(800).await) });
    assert!(of_few > 0 && of_many < 5 * of_few, "{of_few} and {of_many}");
}

fn wait<T>(future: impl Future<Output = T>) -> T {
    tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap().block_on(future)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn folding_in_slices_leaves_what_writing_at_once_leaves(steps in prop::collection::vec(any_step(), 1..25)) {
        wait(holds_after(steps));
    }

    #[test]
    fn jobs_in_one_group_leave_what_they_leave_one_by_one(
        steps in prop::collection::vec((any::<bool>(), any_step()), 1..25),
        group in 2usize..60,
    ) {
        wait(async {
            let ((_a, alone), (_b, together)) = (database().await, database().await);
            let mut alone = alone.acquire().await.unwrap();
            let mut together = together.acquire().await.unwrap();
            for job in jobs_of(&steps) {
                execute(&mut alone, &job).await;
            }
            for jobs in jobs_of(&steps).chunks(group) {
                write::execute(&mut together, jobs.iter()).await.unwrap();
            }
            let expected = dump(&mut alone).await;
            assert!(expected.len() > 30, "{expected:#?}");
            assert_eq!(dump(&mut together).await, expected);
        });
    }

    #[test]
    fn a_deletion_in_slices_of_any_size_leaves_nothing_of_its_map_and_all_of_the_others(
        rows in 1u32..40,
        stops_after in 0usize..8,
    ) {
        wait(async {
            let (_folder, pool) = database().await;
            let mut db = pool.acquire().await.unwrap();
            make_map(&mut db, 1).await;
            let (kept, before) = (index_of(&mut db, Order::Forwards).await, dump(&mut db).await);
            make_map(&mut db, 2).await;
            let changes = changes_of(&Step::Forget { session: 0, points: (0..40).collect() }, 3);
            for job in staging::staged(Job::Change(Box::new(batch(2, 3, changes)))) {
                execute(&mut db, &job).await;
            }
            deletion::mark_deleted(&mut db, 2).await.unwrap();
            for _ in 0..stops_after {
                deletion::remove_rows(&mut db, rows).await.unwrap();
            }
            // Its name is free at once.
            let id = "map-2".parse().unwrap();
            assert!(load(&mut db, &id, Order::Forwards, |_| {}).await.unwrap().is_none());
            let create = Job::CreateMap { id, properties: Box::default(), digest: [1; 32], owner: None };
            execute(&mut db, &create).await;
            // Its deferred changes reach no rows any more.
            assert!(!fold::fold(&mut db, None, 1).await.unwrap());
            while deletion::remove_rows(&mut db, rows).await.unwrap() {}
            sql::query("delete from maps where map_key = 3").execute(&mut db).await.unwrap();
            assert_eq!(dump(&mut db).await, before);
            assert!(index_of(&mut db, Order::Forwards).await == kept);
        });
    }
}
