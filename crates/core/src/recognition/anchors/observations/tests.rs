//! The letter: keyframes sent anew, with what they observe in the end.

use std::collections::{BTreeMap, BTreeSet};

use proptest::prelude::*;

use super::*;
use crate::domain::anchor::AnchorState;
use crate::domain::event::EventKind;
use crate::domain::ids::KeyframeId;
use crate::domain::keyframe::{Detection, NewKeyframe, Stamp};
use crate::domain::map::MapProperties;
use crate::geometry::{Aabb, Point3, Pose};
use crate::recognition::anchors::ingest::ingest;

const SESSION: SessionSeq = SessionSeq(0);

fn id(number: usize) -> KeyframeId {
    format!("kf-{number}").parse().unwrap()
}

fn empty_map() -> MapIndex {
    let mut properties = MapProperties { metric: true, ..MapProperties::default() };
    properties.settings.covisibility_min_shared_points = 3;
    let mut index = MapIndex::default();
    index.apply(&[Change::MapSet(Box::new(properties))]);
    index
}

fn keyframe(number: usize, observes: BTreeSet<PointId>, position: impl Fn(PointId) -> Point3) -> NewKeyframe {
    let stamp = Stamp { sec: number as i64, nanosec: 0 };
    NewKeyframe {
        map_points: observes.iter().map(|id| (*id, position(*id))).collect(),
        observes: observes.into_iter().collect(),
        covisible: Some(Vec::new()),
        ..NewKeyframe::at(id(number), stamp, Pose::identity())
    }
}

/// The graph as a client reads it: of each keyframe what it observes, and whom it is covisible with.
type Graph = BTreeMap<KeyframeId, (Vec<PointId>, Vec<(KeyframeId, u32)>)>;

fn graph(index: &MapIndex) -> Graph {
    let name = |seq: KeyframeSeq| index.keyframe(seq).unwrap().id.clone();
    let of = |seq| index.covisibility().shared(seq).map(|(other, points)| (name(other), points)).collect();
    index.keyframes().map(|k| (k.id.clone(), (k.observes.to_vec(), of(k.seq)))).collect()
}

/// Returns the younger keyframe of each pair that is covisible in the second graph and not in the first.
fn younger_of_new_pairs(before: &Graph, now: &Graph) -> BTreeSet<KeyframeSeq> {
    let pairs = |graph: &Graph| -> BTreeSet<(KeyframeId, KeyframeId)> {
        let of = |(one, (_, others)): (&KeyframeId, &(_, Vec<(KeyframeId, u32)>))| {
            others.iter().map(|(other, _)| (one.clone(), other.clone())).collect::<Vec<_>>()
        };
        graph.iter().flat_map(of).collect()
    };
    let number = |id: &KeyframeId| -> u32 { id.as_str().trim_start_matches("kf-").parse().unwrap() };
    let (before, now) = (pairs(before), pairs(now));
    now.difference(&before).map(|(a, b)| KeyframeSeq(number(a).max(number(b)))).collect()
}

/// An object as a client reads it.
type Shown = (BTreeSet<(KeyframeId, u16)>, Option<String>, AnchorState, BTreeSet<PointId>, Option<Aabb>);

fn objects(index: &MapIndex) -> Vec<Shown> {
    let mut objects: Vec<Shown> = Vec::new();
    for (_, object) in index.objects().iter() {
        let observations =
            object.members.iter().flat_map(|member| index.anchor(*member).unwrap().observations.keys());
        let seen =
            observations.map(|(keyframe, n)| (index.keyframe(*keyframe).unwrap().id.clone(), *n)).collect();
        let shape = object.shapes.get(&SESSION).cloned().unwrap_or_default();
        let text = object.description.as_ref().map(|description| description.text.normalised().to_owned());
        objects.push((seen, text, object.state, shape.map_points, shape.aabb));
    }
    objects.sort_by(|a, b| a.0.cmp(&b.0));
    objects
}

/// A step of a robot and of its map.
#[derive(Clone, Debug)]
enum Step {
    Send(BTreeSet<PointId>),
    Fuse(PointId, PointId),
    Cull(PointId),
    /// A keyframe observes these and no others.
    Observe(usize, BTreeSet<PointId>),
    Declare(usize, usize, u32),
}

fn any_step() -> impl Strategy<Value = Step> {
    let points = || prop::collection::btree_set(0..14_i64, 0..9);
    prop_oneof![
        6 => points().prop_map(Step::Send),
        4 => (0..14_i64, 0..14_i64).prop_map(|(a, b)| Step::Fuse(a, b)),
        2 => (0..14_i64).prop_map(Step::Cull),
        2 => (0..9_usize, points()).prop_map(|(keyframe, points)| Step::Observe(keyframe, points)),
        1 => (0..9_usize, 0..9_usize, 1..60_u32).prop_map(|(a, b, shared)| Step::Declare(a, b, shared)),
    ]
}

/// The robot's own map, which the server is to follow.
#[derive(Default)]
struct Robot {
    keyframes: Vec<BTreeSet<PointId>>,
    positions: BTreeMap<PointId, Point3>,
    declared: BTreeMap<(usize, usize), u32>,
    /// Points that are gone for good.
    gone: BTreeSet<PointId>,
}

impl Robot {
    /// Points that are observed no more are culled.
    fn sweep(&mut self) {
        let observed: BTreeSet<PointId> = self.keyframes.iter().flatten().copied().collect();
        self.positions.retain(|id, _| observed.contains(id));
    }
}

fn at_first(id: PointId) -> Point3 {
    Point3::new(id as f64, 0.5, 2.0)
}

fn nothing() -> ObservationUpdate {
    ObservationUpdate { session: SESSION, replaced: Vec::new(), removed: Vec::new(), keyframes: Vec::new() }
}

/// Takes a step in the robot's map, and tells the server.
fn take(robot: &mut Robot, index: &mut MapIndex, step: &Step) {
    let seq = |number: usize| KeyframeSeq(number as u32);
    let update = match step {
        Step::Send(points) => {
            let points: BTreeSet<PointId> = points.difference(&robot.gone).copied().collect();
            robot.positions.extend(points.iter().map(|id| (*id, at_first(*id))));
            ingest(index, &keyframe(robot.keyframes.len(), points.clone(), at_first));
            robot.keyframes.push(points);
            return;
        }
        Step::Fuse(old, new) => {
            if old == new || robot.gone.contains(old) || robot.gone.contains(new) {
                return;
            }
            robot.gone.insert(*old);
            for observed in &mut robot.keyframes {
                if observed.remove(old) {
                    observed.insert(*new);
                }
            }
            if let Some(at) = robot.positions.remove(old) {
                robot.positions.entry(*new).or_insert(at);
            }
            ObservationUpdate { replaced: vec![(*old, *new)], ..nothing() }
        }
        Step::Cull(point) => {
            robot.gone.insert(*point);
            robot.positions.remove(point);
            robot.keyframes.iter_mut().for_each(|observed| observed.retain(|id| id != point));
            ObservationUpdate { removed: vec![*point], ..nothing() }
        }
        Step::Observe(number, points) if *number < robot.keyframes.len() => {
            let known = |id: &&PointId| robot.positions.contains_key(id);
            let points: BTreeSet<PointId> = points.iter().filter(known).copied().collect();
            robot.keyframes[*number].clone_from(&points);
            let observes = Some(points.into_iter().collect());
            let keyframe = KeyframeUpdate { keyframe: seq(*number), observes, covisible: Vec::new() };
            ObservationUpdate { keyframes: vec![keyframe], ..nothing() }
        }
        Step::Declare(a, b, shared) if a != b && (*a).max(*b) < robot.keyframes.len() => {
            robot.declared.insert((*a, *b), *shared);
            let keyframe =
                KeyframeUpdate { keyframe: seq(*a), observes: None, covisible: vec![(seq(*b), *shared)] };
            ObservationUpdate { keyframes: vec![keyframe], ..nothing() }
        }
        Step::Observe(..) | Step::Declare(..) => return,
    };
    robot.sweep();
    let changed: Vec<PointsOfKeyframe> = keyframes_of(index, &update)
        .into_iter()
        .filter_map(|seq| points_of_keyframe(index, seq, listed(&update, seq), &becomes(&update)))
        .collect();
    let (before, graph_before) = (CovisibleBefore::of(index, SESSION, &changed), graph(index));
    change_observations(index, update.clone()).unwrap();
    let mut found = BTreeSet::new();
    before.add_younger(index, &mut found);
    assert_eq!(found, younger_of_new_pairs(&graph_before, &graph(index)));
    let before = index.clone();
    let again = change_observations(index, update).unwrap();
    assert_eq!((again.keyframes, again.map_points, again.merged), (0, 0, 0), "{step:?}, said again");
    assert!(*index == before, "{step:?}, said again, changes something");
}

proptest! {
    #[test]
    fn points_and_edges_are_those_of_keyframes_sent_so_at_once(steps in prop::collection::vec(any_step(), 1..30)) {
        let (mut robot, mut index) = (Robot::default(), empty_map());
        for step in &steps {
            take(&mut robot, &mut index, step);
        }
        let mut at_once = empty_map();
        for (number, observes) in robot.keyframes.iter().enumerate() {
            let mut new = keyframe(number, observes.clone(), |id| robot.positions[&id]);
            // Only the younger of two can declare on arrival; declared from both sides, the larger number counts.
            let between = |other: usize| {
                let numbers = [(number, other), (other, number)].map(|pair| robot.declared.get(&pair).copied());
                numbers.into_iter().flatten().max()
            };
            new.covisible = Some((0..number).filter_map(|other| Some((id(other), between(other)?))).collect());
            ingest(&mut at_once, &new);
        }
        prop_assert_eq!(graph(&index), graph(&at_once));
        prop_assert_eq!(index.points(), at_once.points());
    }
}

/// Rooms that a robot returns to. Each has points and two signs, and each keyframe in it observes all of its points.
const ROOMS: usize = 2;
const SIGNS: usize = 2;
/// Points of a sign; the first is in every detection of it.
const POINTS: usize = 3;
/// The offset of a point's number until it is fused.
const ALIAS: PointId = 1_000;

fn point(room: usize, sign: usize, number: usize) -> PointId {
    (room * 100 + sign * 10 + number) as PointId
}

fn on_sign(id: PointId) -> Point3 {
    let id = id % ALIAS;
    let (sign, number) = ((id / 10) as f64, (id % 10) as f64);
    Point3::new(sign * 20.0, number * 0.1, (number - 1.0).abs() * 0.1)
}

/// A visit of a room: which of its points tracking takes for new ones, and what is detected of its signs.
#[derive(Clone, Debug)]
struct Visit {
    room: usize,
    lost: Vec<bool>,
    seen: Vec<Option<(bool, bool, bool)>>,
    reads: bool,
}

fn any_visit() -> impl Strategy<Value = Visit> {
    let lost = prop::collection::vec(any::<bool>(), SIGNS * POINTS);
    let seen = prop::collection::vec(prop::option::weighted(0.7, any::<(bool, bool, bool)>()), SIGNS);
    (0..ROOMS, lost, seen, any::<bool>()).prop_map(|(room, lost, seen, reads)| Visit {
        room,
        lost,
        seen,
        reads,
    })
}

fn sent(number: usize, visit: &Visit, is_fused: &BTreeSet<PointId>) -> NewKeyframe {
    let called = |sign: usize, n: usize| {
        let id = point(visit.room, sign, n);
        if visit.lost[sign * POINTS + n] && !is_fused.contains(&id) { id + ALIAS } else { id }
    };
    let observes = (0..SIGNS).flat_map(|sign| (0..POINTS).map(move |n| (sign, n)));
    let observes = observes.map(|(sign, n)| called(sign, n)).collect();
    let detection = |(sign, seen): (usize, &Option<(bool, bool, bool)>)| {
        let (second, third, read) = (*seen)?;
        let points = [(0, true), (1, second), (2, third)].into_iter().filter(|(_, is_seen)| *is_seen);
        let mut map_points: Vec<PointId> = points.map(|(n, _)| called(sign, n)).collect();
        map_points.sort_unstable();
        let text = (read && visit.reads).then(|| format!("{}", 700 + visit.room * 10 + sign));
        Some(Detection { map_points, text, ..Detection::of("sign", 0.9, [0.0, 0.0, 9.0, 9.0]) })
    };
    let detections = visit.seen.iter().enumerate().filter_map(detection).collect();
    NewKeyframe { detections, ..keyframe(number, observes, on_sign) }
}

proptest! {
    #[test]
    fn any_order_of_sending_and_fusing_ends_in_the_map_of_sending_what_is_fused(
        visits in prop::collection::vec(any_visit(), 1..9),
        mut order in Just((0..ROOMS * SIGNS * POINTS).collect::<Vec<usize>>()).prop_shuffle(),
        each in prop::collection::vec(0..9_usize, ROOMS * SIGNS * POINTS),
        at_a_time in 1..5_usize,
    ) {
        let all = |n: usize| point(n / (SIGNS * POINTS), n / POINTS % SIGNS, n % POINTS);
        let fused: BTreeSet<PointId> = (0..ROOMS * SIGNS * POINTS).map(all).collect();
        let (mut index, mut at_once, mut is_fused) = (empty_map(), empty_map(), BTreeSet::new());
        let fuse = |index: &mut MapIndex, points: Vec<usize>, is_fused: &mut BTreeSet<PointId>| {
            for some in points.chunks(at_a_time) {
                let replaced = some.iter().map(|n| (all(*n) + ALIAS, all(*n))).collect();
                is_fused.extend(some.iter().map(|n| all(*n)));
                change_observations(index, ObservationUpdate { replaced, ..nothing() }).unwrap();
            }
        };
        for (number, visit) in visits.iter().enumerate() {
            ingest(&mut index, &sent(number, visit, &is_fused));
            ingest(&mut at_once, &sent(number, visit, &fused));
            let (now, later) = order.into_iter().partition(|n| each[*n] == number);
            order = later;
            fuse(&mut index, now, &mut is_fused);
        }
        fuse(&mut index, order, &mut is_fused);
        prop_assert_eq!(graph(&index), graph(&at_once));
        prop_assert_eq!(index.points(), at_once.points());
        prop_assert_eq!(objects(&index), objects(&at_once));
    }
}

#[test]
fn more_pairs_than_one_request_may_change_are_refused_and_nothing_changes() {
    let mut index = empty_map();
    for number in 0..40 {
        ingest(&mut index, &keyframe(number, (0..40).collect(), at_first));
    }
    let before = index.clone();
    let fused = |points: PointId| (0..points).map(|id| (id, id + 100)).collect();
    // Each of the 40 observers of a point, and of the one that it becomes, with 40 others.
    let refused = change_observations(&mut index, ObservationUpdate { replaced: fused(40), ..nothing() });
    assert_eq!(refused.unwrap_err(), TooManyPairs(2 * 40 * 40 * 40));
    assert_eq!(index, before);
    change_observations(&mut index, ObservationUpdate { replaced: fused(10), ..nothing() }).unwrap();
}

#[test]
fn a_feature_observes_the_point_that_its_own_became() {
    let mut index = empty_map();
    ingest(&mut index, &keyframe(0, (0..6).collect(), at_first));
    change_observations(&mut index, ObservationUpdate { replaced: vec![(1, 9), (2, 1_000)], ..nothing() })
        .unwrap();
    change_observations(
        &mut index,
        ObservationUpdate { replaced: vec![(9, 8)], removed: vec![3], ..nothing() },
    )
    .unwrap();
    let points =
        crate::recognition::loops::points_now::PointsNow::of(index.keyframe(KeyframeSeq(0)).unwrap())
            .unwrap();
    let now: Vec<Option<PointId>> = (0..6).map(|sent| points.now(sent)).collect();
    assert_eq!(now, [Some(0), Some(8), Some(1_000), None, Some(4), Some(5)]);
    assert_eq!(index.points().position(SESSION, 8), Some(at_first(1)), "the position that it had");
}

#[test]
fn a_chain_of_fused_points_ends_at_its_last_and_a_culled_end_takes_all() {
    let mut index = empty_map();
    ingest(&mut index, &keyframe(0, (0..6).collect(), at_first));
    let update = ObservationUpdate { replaced: vec![(0, 1), (1, 2), (3, 4)], removed: vec![4], ..nothing() };
    let changed = change_observations(&mut index, update).unwrap();
    assert_eq!((changed.keyframes, changed.map_points), (1, 4));
    assert_eq!(index.keyframe(KeyframeSeq(0)).unwrap().observes.to_vec(), [2, 5]);
}

#[test]
fn a_sign_is_one_once_its_keyframes_are_covisible_though_its_own_points_stay() {
    let mut index = empty_map();
    for number in 0..2_usize {
        let first = 100 * number as PointId;
        let observes: BTreeSet<PointId> = (first..first + 4).chain([20, 21]).collect();
        let sign = Detection { map_points: vec![20, 21], ..Detection::of("sign", 0.9, [0.0, 0.0, 9.0, 9.0]) };
        ingest(&mut index, &NewKeyframe { detections: vec![sign], ..keyframe(number, observes, at_first) });
    }
    assert_eq!(index.objects().len(), 2, "two shared points are not enough");
    let changed =
        change_observations(&mut index, ObservationUpdate { replaced: vec![(100, 0)], ..nothing() }).unwrap();
    assert_eq!((changed.merged, index.objects().len()), (1, 1));
    let told = &changed.decided.events;
    assert_eq!(told.iter().map(|event| event.kind).collect::<Vec<_>>(), [EventKind::AnchorsMerged]);
}

#[test]
fn two_signs_that_one_keyframe_saw_stay_two() {
    let mut index = empty_map();
    let see = |number: usize, signs: &[&[PointId]], points: BTreeSet<PointId>| NewKeyframe {
        detections: signs
            .iter()
            .map(|points| Detection {
                map_points: points.to_vec(),
                ..Detection::of("sign", 0.9, [0.0, 0.0, 9.0, 9.0])
            })
            .collect(),
        ..keyframe(number, points, |id| Point3::new(id as f64 * 0.01, 0.0, 2.0))
    };
    ingest(&mut index, &see(0, &[&[1, 2]], (0..6).collect()));
    ingest(&mut index, &see(1, &[&[11, 12]], (10..16).collect()));
    // It tracks both, each through another neighbour.
    let both: BTreeSet<PointId> = (0..6).chain(10..16).collect();
    ingest(&mut index, &see(2, &[&[1, 2], &[11, 12]], both));
    assert_eq!(index.objects().len(), 2);
    let replaced = (10..16).map(|id| (id, id - 10)).collect();
    let changed = change_observations(&mut index, ObservationUpdate { replaced, ..nothing() }).unwrap();
    assert_eq!((changed.merged, index.objects().len()), (0, 2));
}
