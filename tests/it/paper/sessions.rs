//! Sessions: each has its own frame and its own numbers of map points; a loop joins them (M32).

use serde_json::{Value, json};

use super::scene::{Keyframe, Scene, close_to, close_to_all, door, keyframe, list, texts, thing};

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

#[tokio::test]
async fn the_numbers_of_map_points_are_each_sessions_own() {
    let scene = Scene::new().await;
    let points = [(1, [0.0, 0.0, 2.0]), (2, [1.0, 1.0, 2.0])];
    let elsewhere = [(1, [70.0, 0.0, 2.0]), (2, [71.0, 1.0, 2.0])];
    let sight = || [thing("door_number", "901").on([1, 2])];
    scene.put("monday-1", keyframe().session("monday").observes(1..=40).points(&points).sees(sight())).await;
    let other = keyframe().session("tuesday").observes(1..=40).points(&elsewhere).sees(sight());
    let answer = scene.put("tuesday-1", other).await;
    assert_eq!(answer["covisible"], 0);
    assert_eq!(answer["detections"][0]["outcome"], "created");
    let [monday, tuesday] = scene.anchors().await.try_into().expect("two anchors");
    close_to_all("monday", &monday["center"], [0.5, 0.5, 2.0]);
    close_to_all("tuesday", &tuesday["center"], [70.5, 0.5, 2.0]);
    assert_eq!(texts(&monday["matches"], "kind"), ["revisit"]);
}

#[tokio::test]
async fn a_loop_between_sessions_is_found_by_relative_places() {
    let scene = Scene::new().await;
    scene.put("monday-1", old_day()).await;
    scene.put("tuesday-1", new_day().sees([door("901", NEW_DOOR)])).await;
    let found = scene.compare("tuesday-1", "monday-1").await;
    assert_eq!(found["verdict"], "loop", "{found:#}");
    close_to("S", &found["anchors"]["similarity"], 1.0);
    close_to("distance", &found["anchors"]["matches"][0]["distance_difference_m"], 0.5);
    // 1/2 + 1/2.5.
    close_to("weight", &found["anchors"]["matches"][0]["weight"], 0.9);
}

#[tokio::test]
async fn an_anchor_merged_across_sessions_keeps_its_place_in_each_frame() {
    let scene = Scene::new().await;
    scene.put("monday-1", old_day()).await;
    scene.put("tuesday-1", new_day().sees([door("901", NEW_DOOR)])).await;
    scene.close("l-1", "tuesday-1", "monday-1").await;

    let anchor = scene.anchors().await.remove(0);
    assert_eq!(anchor["keyframes"], json!(["monday-1", "tuesday-1"]));
    assert_eq!(texts(&anchor["frames"], "session"), ["monday", "tuesday"]);
    for (frame, place) in list(&anchor["frames"]).iter().zip([OLD_DOOR, NEW_DOOR]) {
        close_to_all("center", &frame["center"], place);
        close_to_all("min", &frame["box"]["min"], place);
        close_to_all("max", &frame["box"]["max"], place);
    }
    close_to_all("the oldest session's", &anchor["center"], OLD_DOOR);
    for (id, distance_m) in [("monday-1", 2.0), ("tuesday-1", 2.5)] {
        let around = scene.local_map(id).await;
        assert_eq!(around.len(), 1, "{id}");
        close_to_all(id, &around[0]["bearing"], [0.0, 0.0, 1.0]);
        close_to(id, &around[0]["distance_m"], distance_m);
    }
}

#[tokio::test]
async fn an_anchor_merged_across_sessions_proposes_the_other_sessions_keyframes() {
    let scene = Scene::new().await;
    scene.put("monday-1", old_day().words(&[(1, 1.0)])).await;
    scene.put("tuesday-1", new_day().words(&[(2, 1.0)]).sees([door("901", NEW_DOOR)])).await;
    scene.close("l-1", "tuesday-1", "monday-1").await;
    let next = new_day().words(&[(3, 1.0)]).covisible(&["tuesday-1"]).sees([door("901", NEW_DOOR)]);
    scene.put("tuesday-2", next).await;
    assert_eq!(scene.anchors().await.len(), 1);
    let answer = scene.ask("tuesday-2").await;
    assert_eq!(texts(&answer["candidates"], "keyframe"), ["monday-1"]);
    assert_eq!(answer["verdict"], "loop");
}

#[tokio::test]
async fn what_only_another_sessions_frame_knows_has_no_place_in_a_local_map() {
    let scene = Scene::new().await;
    scene.put("monday-1", old_day()).await;
    let other = new_day().covisible(&["monday-1"]).sees([door("902", [101.0, 50.0, 2.0])]);
    scene.put("tuesday-1", other).await;
    let described = async |id: &str| texts(&Value::from(scene.local_map(id).await), "description");
    assert_eq!(described("monday-1").await, ["901"]);
    assert_eq!(described("tuesday-1").await, ["902"]);
}

#[tokio::test]
async fn boxes_of_two_sessions_are_in_two_frames_and_never_close() {
    let scene = Scene::new().await;
    scene.put("monday-1", old_day()).await;
    // Declared covisible, the same text, and by its numbers the same place: but of another frame.
    let other = keyframe().session("tuesday").covisible(&["monday-1"]).sees([door("901", OLD_DOOR)]);
    let answer = scene.put("tuesday-1", other).await;
    assert_eq!(answer["detections"][0]["outcome"], "created");
    let [monday, tuesday] = scene.anchors().await.try_into().expect("two anchors");
    for anchor in [monday, tuesday] {
        assert_eq!(texts(&anchor["matches"], "kind"), ["covisible"]);
    }
}

#[tokio::test]
async fn a_revoked_loop_between_sessions_takes_each_frame_back() {
    let scene = Scene::new().await;
    scene.put("monday-1", old_day()).await;
    scene.put("tuesday-1", new_day().sees([door("901", NEW_DOOR)])).await;
    scene.close("l-1", "tuesday-1", "monday-1").await;
    scene.delete("/loops/l-1").await;
    let [monday, tuesday] = scene.anchors().await.try_into().expect("two anchors");
    assert_eq!(texts(&monday["frames"], "session"), ["monday"]);
    assert_eq!(texts(&tuesday["frames"], "session"), ["tuesday"]);
    close_to_all("tuesday", &tuesday["center"], NEW_DOOR);
}
