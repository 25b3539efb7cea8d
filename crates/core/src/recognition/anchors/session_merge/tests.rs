//! Merges held against keyframes that were sent in one frame, and revocations against what was before.

use proptest::prelude::*;

use super::*;
use crate::domain::change::{KeyframeUpdate, ObservationUpdate};
use crate::domain::ids::KeyframeId;
use crate::domain::keyframe::{Detection, NewKeyframe, Stamp};
use crate::domain::map::MapProperties;
use crate::geometry::{Aabb, Point3, Pose, Sim3};
use crate::recognition::anchors::ingest::ingest;
use crate::recognition::anchors::observations::change_observations;
use crate::recognition::loops::points_now::PointsNow;
use crate::recognition::map::correction::{Correction, correct};

fn session(number: u8) -> SessionId {
    format!("robot-{number}").parse().unwrap()
}

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

/// A keyframe as one of two robots sends it.
#[derive(Clone, Debug)]
struct Sent {
    robot: u8,
    points: BTreeSet<PointId>,
    sign: Option<(u8, i8)>,
}

fn any_sent() -> impl Strategy<Value = Vec<Sent>> {
    let points = prop::collection::btree_set(0..14_i64, 0..9);
    let sign = prop::option::of((0..3_u8, -4..4_i8));
    let one = (0..2_u8, points, sign).prop_map(|(robot, points, sign)| Sent { robot, points, sign });
    prop::collection::vec(one, 1..12)
}

fn any_numbers() -> impl Strategy<Value = Renumbering> {
    let listed = prop::collection::btree_map(0..14_i64, 0..20_i64, 0..6);
    prop_oneof![
        Just(Renumbering::Same),
        (0..9_i64).prop_map(Renumbering::Offset),
        listed.prop_map(|pairs| Renumbering::Listed(pairs.into_iter().collect())),
    ]
}

fn any_transform() -> impl Strategy<Value = Sim3> {
    let turned = Sim3::new(1.5, [3.0, -1.0, 0.5], [0.0, 0.0, 0.6, 0.8]).unwrap();
    prop_oneof![Just(Sim3::identity()), Just(turned)]
}

/// A keyframe in the frame of its robot, or as this transformation and these numbers have it.
fn keyframe(number: usize, sent: &Sent, moved: Option<(&Sim3, &Renumbering)>) -> NewKeyframe {
    let pose = Pose::new([number as f64, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]).unwrap();
    let stays = (Sim3::identity(), Renumbering::Same);
    let (transform, numbers) = moved.unwrap_or((&stays.0, &stays.1));
    let number_of = numbers.number();
    let place = |at: Point3| if moved.is_some() { transform.transform(&at) } else { at };
    let pose = if moved.is_some() { transform.after(&Sim3::from(pose)).without_scale() } else { pose };
    let points: BTreeMap<PointId, Point3> = sent
        .points
        .iter()
        .map(|id| (number_of(*id), place(Point3::new(*id as f64, f64::from(sent.robot), 2.0))))
        .collect();
    let detection = |(text, x): (u8, i8)| Detection {
        text: Some(format!("90{text}")),
        position_in_session: Some(place(Point3::new(f64::from(x), 0.0, 3.0))),
        ..Detection::of("door_number", 0.9, [1.0, 2.0, 30.0, 40.0])
    };
    NewKeyframe {
        session: session(if moved.is_some() { 0 } else { sent.robot }),
        observes: points.keys().copied().collect(),
        map_points: points.into_iter().collect(),
        detections: sent.sign.map(detection).into_iter().collect(),
        ..NewKeyframe::at(id(number), Stamp { sec: number as i64, nanosec: 0 }, pose)
    }
}

/// Keyframes as they are read: the session, the pose, the points, and whom it is covisible with.
type Graph = BTreeMap<KeyframeId, (SessionId, Pose, Vec<PointId>, Vec<(KeyframeId, u32)>)>;

fn graph(index: &MapIndex) -> Graph {
    let name = |seq: KeyframeSeq| index.keyframe(seq).unwrap().id.clone();
    let of = |seq| index.covisibility().shared(seq).map(|(other, points)| (name(other), points)).collect();
    let read = |k: &crate::domain::change::Keyframe| {
        let session = index.sessions()[k.session.index()].clone();
        (k.id.clone(), (session, k.map_from_camera, k.observes.to_vec(), of(k.seq)))
    };
    index.keyframes().map(read).collect()
}

fn points(index: &MapIndex) -> Vec<Vec<(PointId, Point3)>> {
    (0..index.sessions().len()).map(|number| index.points().placed(SessionSeq(number as u32))).collect()
}

/// An object as it is read: the detections, the text, and the box in each session's frame.
type Shown = (BTreeSet<(KeyframeId, u16)>, Option<String>, BTreeMap<SessionSeq, Option<Aabb>>);

fn objects(index: &MapIndex) -> Vec<Shown> {
    let mut objects: Vec<Shown> = Vec::new();
    for (_, object) in index.objects().iter() {
        let seen =
            object.members.iter().flat_map(|member| index.anchor(*member).unwrap().observations.keys());
        let seen = seen.map(|(keyframe, n)| (index.keyframe(*keyframe).unwrap().id.clone(), *n)).collect();
        let text = object.description.as_ref().map(|description| description.text.normalised().to_owned());
        let boxes = object.shapes.iter().map(|(session, shape)| (*session, shape.aabb)).collect();
        objects.push((seen, text, boxes));
    }
    objects.sort_by(|a, b| a.0.cmp(&b.0));
    objects
}

fn map_of(sent: &[Sent]) -> MapIndex {
    let mut index = empty_map();
    for (number, one) in sent.iter().enumerate() {
        ingest(&mut index, &keyframe(number, one, None));
    }
    index
}

fn request(into_from_session: Sim3, map_points: Renumbering) -> SessionMergeRequest {
    SessionMergeRequest { session: session(1), into: session(0), into_from_session, map_points }
}

/// Merges the second robot's session into the first one's, if it has one.
fn merge(index: &mut MapIndex, request: &SessionMergeRequest) -> Option<Decided> {
    let session = index.session(&request.session)?;
    Some(merge_sessions(index, session, request).decided)
}

/// The values that revoke a merge, as the store gives them back.
fn kept(decided: &Decided) -> (MergeUndo, FormerValues) {
    let undo = decided.changes.iter().find_map(|change| match change {
        Change::MergeKept(undo) => Some((**undo).clone()),
        _ => None,
    });
    (undo.expect("a merge"), decided.former.clone())
}

proptest! {
    #[test]
    fn a_revoked_merge_leaves_nothing(sent in any_sent(), numbers in any_numbers(), transform in any_transform()) {
        let mut index = map_of(&sent);
        let before = (graph(&index), points(&index), objects(&index), index.bytes());
        if let Some(decided) = merge(&mut index, &request(transform, numbers)) {
            let (undo, former) = kept(&decided);
            prop_assert!(is_open(&index, &undo));
            revoke_merge(&mut index, undo.clone(), &former);
            prop_assert!(!is_open(&index, &undo));
        }
        // The name of a session that the merge began stays.
        let mut after = (graph(&index), points(&index), objects(&index), index.bytes());
        after.1.truncate(before.1.len());
        let begun = after.3 - before.3;
        prop_assert!(begun == 0 || begun == session(0).as_str().len() as u64, "{begun} bytes are left");
        after.3 = before.3;
        prop_assert_eq!(after, before);
    }

    /// Poses, points and covisibility are those of keyframes that were sent in the one frame. Of points that became one the first
    /// session's position stays, so here each has its own number.
    #[test]
    fn a_merged_map_is_that_of_keyframes_sent_so(sent in any_sent(), transform in any_transform()) {
        let numbers = Renumbering::Offset(100);
        let mut index = map_of(&sent);
        merge(&mut index, &request(transform, numbers.clone()));
        let mut at_once = empty_map();
        for (number, one) in sent.iter().enumerate() {
            let moved = (one.robot == 1).then_some((&transform, &numbers));
            ingest(&mut at_once, &keyframe(number, one, moved));
        }
        prop_assert_eq!(graph(&index), graph(&at_once));
        prop_assert_eq!(
            points(&index).into_iter().flatten().collect::<BTreeMap<_, _>>().into_keys().collect::<Vec<_>>(),
            points(&at_once).into_iter().flatten().collect::<BTreeMap<_, _>>().into_keys().collect::<Vec<_>>()
        );
        let of_first = |index: &MapIndex| index.session(&session(0)).map(|session| index.points().placed(session));
        prop_assert_eq!(of_first(&index).unwrap_or_default(), of_first(&at_once).unwrap_or_default());
    }
}

fn sent(robot: u8, points: impl IntoIterator<Item = PointId>, sign: Option<(u8, i8)>) -> Sent {
    Sent { robot, points: points.into_iter().collect(), sign }
}

#[test]
fn keyframes_that_see_one_place_are_covisible_and_their_sign_is_one() {
    let mut index = map_of(&[sent(0, 0..6, Some((1, 0))), sent(1, 20..26, Some((1, 0)))]);
    assert_eq!(index.objects().len(), 2);
    let pairs = (0..6).map(|id| (20 + id, id)).collect();
    let merged =
        merge_sessions(&mut index, SessionSeq(1), &request(Sim3::identity(), Renumbering::Listed(pairs)));
    assert_eq!((merged.keyframes, merged.map_points, merged.merged), (1, 6, 1));
    assert_eq!(index.objects().len(), 1);
    assert!(index.covisibility().joins(KeyframeSeq(0), KeyframeSeq(1)));
    let told: Vec<EventKind> = merged.decided.events.iter().map(|event| event.kind).collect();
    assert_eq!(told[..2], [EventKind::SessionsMerged, EventKind::AnchorsMerged]);
}

#[test]
fn a_sign_moves_with_its_keyframe_through_corrections_and_the_scale_of_a_merge() {
    let mut index = map_of(&[sent(0, 0..6, None), sent(1, [], Some((1, 2)))]);
    let centre = |index: &MapIndex, session: u32| {
        let object = index.objects().iter().next().unwrap().1;
        object.shapes[&SessionSeq(session)].aabb.unwrap().centre()
    };
    let seen_from_camera = Point3::new(1.0, 0.0, 3.0);
    assert_eq!(centre(&index, 1), Point3::new(2.0, 0.0, 3.0));
    let turned = Sim3::new(1.5, [3.0, -1.0, 0.5], [0.0, 0.0, 0.6, 0.8]).unwrap();
    for round in [1.0, 2.0] {
        let pose = Pose::new([5.0 * round, 1.0, -2.0], [0.6, 0.0, 0.0, 0.8]).unwrap();
        let poses = vec![(KeyframeSeq(1), pose)];
        correct(&mut index, SessionSeq(1), &Correction { poses, map_points: Vec::new() });
        assert!((centre(&index, 1) - pose.transform(&seen_from_camera)).norm() < 1e-12);
    }
    let corrected = centre(&index, 1);
    merge(&mut index, &request(turned, Renumbering::Same));
    assert!((centre(&index, 0) - turned.transform(&corrected)).norm() < 1e-12);
    let pose = Pose::new([0.0; 3], [0.0, 0.0, 0.0, 1.0]).unwrap();
    let poses = vec![(KeyframeSeq(1), pose)];
    correct(&mut index, SessionSeq(0), &Correction { poses, map_points: Vec::new() });
    assert!((centre(&index, 0) - seen_from_camera * 1.5).norm() < 1e-12);
}

#[test]
fn a_culled_point_does_not_come_back_under_the_new_number_of_another() {
    let mut index = map_of(&[sent(1, [1, 5, 7], None)]);
    let culled = ObservationUpdate {
        session: SessionSeq(0),
        replaced: Vec::new(),
        removed: vec![5],
        keyframes: Vec::<KeyframeUpdate>::new(),
    };
    change_observations(&mut index, culled).unwrap();
    let session = index.session(&session(1)).unwrap();
    merge_sessions(&mut index, session, &request(Sim3::identity(), Renumbering::Offset(4)));
    let keyframe = index.keyframe(KeyframeSeq(0)).unwrap();
    assert_eq!(keyframe.observes.to_vec(), [5, 11]);
    let now = PointsNow::of(keyframe).unwrap();
    // The feature that was sent with 1 observes 5 by now; the one that was sent with 5 observes nothing.
    assert_eq!([1, 5, 7].map(|sent| now.now(sent)), [Some(5), None, Some(11)]);
}

#[test]
fn what_is_written_on_top_settles_a_merge() {
    type Write = fn(&mut MapIndex) -> Decided;
    let in_the_other: Write = |index| {
        let other = Sent { robot: 2, points: BTreeSet::new(), sign: None };
        ingest(index, &keyframe(8, &other, None)).decided
    };
    let in_the_session: Write = |index| ingest(index, &keyframe(9, &sent(0, 0..3, None), None)).decided;
    let anew: Write = |index| ingest(index, &keyframe(9, &sent(1, 0..3, None), None)).decided;
    for (write, is_settled) in [(in_the_other, false), (in_the_session, true), (anew, true)] {
        let mut index = map_of(&[sent(0, 0..6, None), sent(1, 20..26, None)]);
        let decided = merge(&mut index, &request(Sim3::identity(), Renumbering::Same)).unwrap();
        let (undo, _) = kept(&decided);
        let decided = write(&mut index);
        assert_eq!(!is_open(&index, &undo), is_settled);
        assert_eq!(decided.changes.contains(&Change::MergeSettled(SessionSeq(1))), is_settled);
    }
}

#[test]
fn faults_name_their_fields() {
    let index = map_of(&[sent(0, 0..6, None), sent(1, 20..26, None)]);
    let pointers = |request: &SessionMergeRequest| -> Vec<String> {
        merge_faults(&index, request).iter().map(|fault| fault.pointer.clone()).collect()
    };
    let offset = |offset: i64| request(Sim3::identity(), Renumbering::Offset(offset));
    assert_eq!(pointers(&offset(-20)), [""; 0]);
    assert_eq!(pointers(&offset(-21)), ["/map_points/offset"]);
    assert_eq!(pointers(&offset(i64::MAX)), ["/map_points/offset"]);
    assert_eq!(pointers(&SessionMergeRequest { into: session(1), ..offset(0) }), ["/into"]);
}
