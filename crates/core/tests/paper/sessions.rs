//! Sessions: each has its own frame and its own numbers of map points; a loop joins them (M32).

use revisit_core::{CandidateDecision, Decision};

use super::scene::{
    Keyframe, Scene, Sign, anchors, candidates, close_to, close_to_all, descriptions, door, keyframe, named,
    thing,
};

/// Ahead of where each session's first keyframe stands.
const OLD_DOOR: [f64; 3] = [0.0, 0.0, 2.0];
const NEW_DOOR: [f64; 3] = [100.0, 50.0, 2.5];

fn old_day() -> Keyframe {
    keyframe().session("monday").sees([door("901", OLD_DOOR)])
}

/// Another frame: the same door is 2.5 m ahead of (100, 50, 0).
fn new_day() -> Keyframe {
    keyframe().session("tuesday").at([100.0, 50.0, 0.0])
}

/// The same door, seen on both days.
fn both_days() -> Scene {
    let mut scene = Scene::new();
    scene.put("monday-1", old_day());
    scene.put("tuesday-1", new_day().sees([door("901", NEW_DOOR)]));
    scene
}

/// The sessions in whose frames an anchor has a box.
fn sessions(anchor: &Sign) -> Vec<&str> {
    anchor.frames.iter().map(|(session, _)| session.as_str()).collect()
}

/// Whether each match of an anchor is a revisit.
fn revisits(anchor: &Sign) -> Vec<bool> {
    anchor.matches.iter().map(|found| found.revisit).collect()
}

#[test]
fn the_numbers_of_map_points_are_each_sessions_own() {
    let mut scene = Scene::new();
    let points = [(1, [0.0, 0.0, 2.0]), (2, [1.0, 1.0, 2.0])];
    let elsewhere = [(1, [70.0, 0.0, 2.0]), (2, [71.0, 1.0, 2.0])];
    let sight = || [thing("door_number", "901").on([1, 2])];
    scene.put("monday-1", keyframe().session("monday").observes(1..=40).points(&points).sees(sight()));
    let other = keyframe().session("tuesday").observes(1..=40).points(&elsewhere).sees(sight());
    let stored = scene.put("tuesday-1", other);
    assert_eq!(scene.covisible("tuesday-1"), Vec::<String>::new());
    assert_eq!(named(stored.outcomes[0]), "created");
    let [monday, tuesday] = scene.anchors().try_into().expect("two anchors");
    close_to_all("monday", monday.centre(), [0.5, 0.5, 2.0]);
    close_to_all("tuesday", tuesday.centre(), [70.5, 0.5, 2.0]);
    assert_eq!(revisits(&monday), [true]);
}

#[test]
fn a_loop_between_sessions_is_found_by_relative_places() {
    let scene = both_days();
    let found = scene.compare("tuesday-1", "monday-1");
    assert_eq!(found.decision, CandidateDecision::Loop, "{found:#?}");
    close_to("S", anchors(&found).similarity, 1.0);
    close_to("distance", anchors(&found).matches[0].distance_difference_m, 0.5);
    // 1/2 + 1/2.5.
    close_to("weight", anchors(&found).matches[0].weight, 0.9);
}

#[test]
fn an_anchor_merged_across_sessions_keeps_its_place_in_each_frame() {
    let mut scene = both_days();
    scene.close("l-1", "tuesday-1", "monday-1");

    let anchor = scene.anchors().remove(0);
    assert_eq!(anchor.keyframes, ["monday-1", "tuesday-1"]);
    assert_eq!(sessions(&anchor), ["monday", "tuesday"]);
    for ((_, aabb), place) in anchor.frames.iter().zip([OLD_DOOR, NEW_DOOR]) {
        close_to_all("center", aabb.centre(), place);
        close_to_all("min", aabb.min(), place);
        close_to_all("max", aabb.max(), place);
    }
    close_to_all("the oldest session's", anchor.centre(), OLD_DOOR);
    for (id, distance_m) in [("monday-1", 2.0), ("tuesday-1", 2.5)] {
        let around = scene.local_map(id);
        assert_eq!(around.len(), 1, "{id}");
        close_to_all(id, around[0].bearing.direction_in_camera(), [0.0, 0.0, 1.0]);
        close_to(id, around[0].bearing.distance_m(), distance_m);
    }
}

#[test]
fn an_anchor_merged_across_sessions_proposes_the_other_sessions_keyframes() {
    let mut scene = Scene::new();
    scene.put("monday-1", old_day().words(&[(1, 1.0)]));
    scene.put("tuesday-1", new_day().words(&[(2, 1.0)]).sees([door("901", NEW_DOOR)]));
    scene.close("l-1", "tuesday-1", "monday-1");
    let next = new_day().words(&[(3, 1.0)]).covisible(&["tuesday-1"]).sees([door("901", NEW_DOOR)]);
    scene.put("tuesday-2", next);
    assert_eq!(scene.anchors().len(), 1);
    let verdict = scene.ask_again("tuesday-2");
    assert_eq!(candidates(&verdict), ["monday-1"]);
    assert_eq!(verdict.decision, Decision::Loop);
}

#[test]
fn an_anchor_known_only_in_another_sessions_frame_has_no_place_in_a_local_map() {
    let mut scene = Scene::new();
    scene.put("monday-1", old_day());
    let other = new_day().covisible(&["monday-1"]).sees([door("902", [101.0, 50.0, 2.0])]);
    scene.put("tuesday-1", other);
    assert_eq!(descriptions(&scene.local_map("monday-1")), ["901"]);
    assert_eq!(descriptions(&scene.local_map("tuesday-1")), ["902"]);
}

#[test]
fn boxes_of_two_sessions_are_in_two_frames_and_never_close() {
    let mut scene = Scene::new();
    scene.put("monday-1", old_day());
    // Declared covisible, the same text, and by its numbers the same place: but of another frame.
    let other = keyframe().session("tuesday").covisible(&["monday-1"]).sees([door("901", OLD_DOOR)]);
    let stored = scene.put("tuesday-1", other);
    assert_eq!(named(stored.outcomes[0]), "created");
    let [monday, tuesday] = scene.anchors().try_into().expect("two anchors");
    for anchor in [monday, tuesday] {
        assert_eq!(revisits(&anchor), [false], "a covisible match");
    }
}

#[test]
fn a_revoked_loop_between_sessions_takes_each_frame_back() {
    let mut scene = both_days();
    scene.close("l-1", "tuesday-1", "monday-1");
    scene.revoke("l-1");
    let [monday, tuesday] = scene.anchors().try_into().expect("two anchors");
    assert_eq!(sessions(&monday), ["monday"]);
    assert_eq!(sessions(&tuesday), ["tuesday"]);
    close_to_all("tuesday", tuesday.centre(), NEW_DOOR);
}
