//! What moves and what goes (M33): corrected poses and map points, and culled keyframes.

use revisit_core::Decision;
use revisit_core::domain::anchor::AnchorState;
use revisit_core::geometry::Pose;
use revisit_core::recognition::loops::anchor_map::{LocalAnchor, LocalName};

use super::scene::{
    NAMES, Scene, anchors, candidates, close_to, close_to_all, door, ids, keyframe, thing, turned,
};

/// A pose at a place, not turned.
fn pose(place: [f64; 3]) -> Pose {
    turned(place, [0.0, 0.0, 0.0, 1.0])
}

/// Which anchors a local map has, as they are called.
fn names(around: &[LocalAnchor]) -> Vec<(LocalName, &str, AnchorState, Option<&str>)> {
    let anchors = around.iter();
    anchors.map(|of| (of.name, &*of.class, of.state, of.description.as_deref())).collect()
}

#[test]
fn a_box_follows_its_map_points() {
    let mut scene = Scene::new();
    let points = [(1, [0.0, 0.0, 2.0]), (2, [1.0, 1.0, 2.0]), (3, [9.0, 9.0, 9.0])];
    scene.put("kf-1", keyframe().points(&points).sees([thing("door_number", "901").on([1, 2])]));
    scene.correct(&[], &[(2, [3.0, 1.0, 4.0])]);
    let anchor = scene.anchors().remove(0);
    close_to_all("min", anchor.aabb().min(), [0.0, 0.0, 2.0]);
    close_to_all("max", anchor.aabb().max(), [3.0, 1.0, 4.0]);
    close_to_all("center", anchor.centre(), [1.5, 0.5, 3.0]);
    // It shrinks too, and the keyframe's pose alone moves no point.
    scene.correct(&[("kf-1", pose([0.0, 0.0, 1.0]))], &[(2, [0.0, 0.0, 2.0])]);
    close_to("distance", scene.local_map("kf-1")[0].bearing.distance_m(), 1.0);
}

#[test]
fn points_that_a_later_keyframe_moves_or_triangulates_move_the_box_too() {
    let mut scene = Scene::new();
    let plate = thing("door_number", "901").on([1, 2]);
    scene.put("kf-1", keyframe().points(&[(1, [0.0, 0.0, 2.0])]).sees([plate]));
    close_to_all("one point", scene.anchors()[0].centre(), [0.0, 0.0, 2.0]);
    scene.put("kf-2", keyframe().points(&[(2, [4.0, 0.0, 2.0])]));
    close_to_all("two points", scene.anchors()[0].centre(), [2.0, 0.0, 2.0]);
    scene.put("kf-3", keyframe().points(&[(1, [2.0, 0.0, 2.0])]));
    close_to_all("one moved", scene.anchors()[0].centre(), [3.0, 0.0, 2.0]);
}

#[test]
fn an_anchor_known_by_position_alone_moves_with_its_keyframe() {
    let mut scene = Scene::new();
    let stored =
        scene.put("kf-1", keyframe().at([1.0, 0.0, 0.0]).sees([door("901", [1.0, 0.0, 2.0])])).keyframe;
    let before = scene.local_map("kf-1");
    // A quarter turn about y takes ahead (z) to x: 2 m ahead of (10, 5, 0) is (12, 5, 0).
    let half = std::f64::consts::FRAC_1_SQRT_2;
    scene.correct(&[("kf-1", turned([10.0, 5.0, 0.0], [0.0, half, 0.0, half]))], &[]);
    close_to_all("center", scene.anchors()[0].centre(), [12.0, 5.0, 0.0]);
    let after = scene.local_map("kf-1");
    let what = "what the camera sees has not changed";
    assert_eq!(names(&after), names(&before), "{what}");
    for (after, before) in after.iter().zip(&before) {
        close_to_all(what, after.bearing.direction_in_camera(), before.bearing.direction_in_camera());
        close_to(what, after.bearing.distance_m(), before.bearing.distance_m());
        close_to(what, after.weight, before.weight);
    }
    let moved = scene.map().keyframe(stored).expect("it is stored").map_from_camera;
    close_to_all("pose", moved.translation_m(), [10.0, 5.0, 0.0]);
}

#[test]
fn each_sight_by_position_moves_with_its_own_keyframe() {
    let mut scene = Scene::new();
    scene.put("kf-1", keyframe().sees([door("901", [0.0, 0.0, 2.0])]));
    scene.put("kf-2", keyframe().covisible(&["kf-1"]).sees([door("901", [0.5, 0.0, 2.0])]));
    scene.correct(&[("kf-2", pose([1.0, 0.0, 0.0]))], &[]);
    let anchor = scene.anchors().remove(0);
    close_to_all("min", anchor.aabb().min(), [0.0, 0.0, 2.0]);
    close_to_all("max", anchor.aabb().max(), [1.5, 0.0, 2.0]);
}

#[test]
fn corrected_poses_change_the_verdict() {
    let mut scene = Scene::new();
    // By points, so that only the keyframe moves: 901 is 2 m ahead, and then 5 m.
    let seen =
        |id: i64| keyframe().points(&[(id, [0.0, 0.0, 2.0])]).sees([thing("door_number", "901").on([id])]);
    scene.put("kf-1", seen(1));
    scene.put("kf-9", seen(2));
    close_to("S", anchors(&scene.compare("kf-9", "kf-1")).similarity, 1.0);
    scene.correct(&[("kf-9", pose([0.0, 0.0, -3.0]))], &[]);
    close_to("S", anchors(&scene.compare("kf-9", "kf-1")).similarity, 0.0);
}

#[test]
fn a_culled_keyframe_takes_its_covisibility_and_its_sights_with_it() {
    let mut scene = Scene::new();
    let chain = [("kf-0", 0.0, "901"), ("kf-1", 0.5, "907"), ("kf-2", 0.75, "907")];
    for (n, (id, x, text)) in chain.into_iter().enumerate() {
        let before = if n == 0 { vec![] } else { vec![chain[n - 1].0] };
        let plate = door(text, [x, 0.0, 2.0]).confidence(0.75);
        let own = door(NAMES[n], [n as f64 * 9.0, 9.0, 2.0]);
        scene.put(id, keyframe().covisible(&before).sees([plate, own]));
    }
    let [plate, own, lost, far] = scene.anchors().try_into().expect("four anchors");
    assert_eq!(plate.description(), "907");
    close_to_all("max", plate.aabb().max(), [0.75, 0.0, 2.0]);
    assert_eq!(scene.local_map("kf-0").len(), 4);

    scene.cull("kf-1");
    assert!(!scene.has("kf-1"));
    for id in ["kf-0", "kf-2"] {
        assert_eq!(scene.covisible(id), Vec::<String>::new(), "{id}");
    }
    assert!(scene.map().anchor(lost.id).is_none(), "it had been seen by no other keyframe");
    let plate = scene.anchor(plate.id);
    assert_eq!(plate.keyframes, ["kf-0", "kf-2"]);
    let readings: Vec<String> = plate.readings().into_iter().map(|(text, ..)| text).collect();
    assert_eq!(readings, ["907", "901"], "a tie goes to the newest");
    let around: Vec<LocalName> = scene.local_map("kf-0").iter().map(|anchor| anchor.name).collect();
    assert_eq!(around, [plate.id, own.id].map(LocalName::MergedAnchor));

    scene.cull("kf-2");
    let plate = scene.anchor(plate.id);
    assert_eq!(plate.description(), "901");
    close_to_all("max", plate.aabb().max(), [0.0, 0.0, 2.0]);
    assert_eq!(scene.anchors().len(), 2, "and {} is gone too", far.id.public());
}

#[test]
fn a_culled_keyframe_is_no_candidate_and_counts_for_nothing() {
    let mut scene = Scene::new();
    scene.put("kf-1", keyframe().sees([door("901", [0.0, 0.0, 2.0])]));
    scene.put("kf-2", keyframe().covisible(&["kf-1"]));
    scene.put("kf-9", keyframe().sees([door("901", [0.0, 0.0, 2.0])]));
    assert_eq!(ids(&scene.ask("kf-9").best), ["kf-1"]);
    scene.cull("kf-1");
    let verdict = scene.ask("kf-9");
    assert_eq!(candidates(&verdict), ["kf-2"]);
    assert_eq!(verdict.decision, Decision::Undecided);
    assert_eq!(scene.ask("kf-2").excluded_covisible, 0);
}

#[test]
fn a_map_point_goes_with_the_last_keyframe_that_observed_it() {
    let mut scene = Scene::new();
    let at = [0.0, 0.0, 2.0];
    let sent =
        keyframe().points(&[(1, at), (2, at), (3, at), (4, at)]).sees([thing("door_number", "901").on([1])]);
    scene.put("kf-1", sent.observes([1, 2, 3]));
    scene.put("kf-2", keyframe().observes([2]));
    scene.cull("kf-1");
    // Whoever sees them later has no place for them, but for the one that stayed observed and the one nobody has observed yet.
    for (point, placed) in [(1, false), (2, true), (3, false), (4, true)] {
        let id = format!("kf-later-{point}");
        scene.put(&id, keyframe().sees([thing("sign", &format!("sign {point}")).on([point])]));
        let anchor = scene.anchors().pop().expect("an anchor");
        assert_eq!(!anchor.frames.is_empty(), placed, "point {point}: {anchor:?}");
    }
}
