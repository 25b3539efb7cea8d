//! §III, told by events: an anchor that was seen before triggers loop detection (M10);
//! `crates/core/tests/paper/overview.rs` asks the core.

use serde_json::{Value, json};

use super::scene::{Scene, door, keyframe, texts};

/// The same door on two passages that have no word in common.
async fn seen_twice() -> Scene {
    let scene = Scene::new().await;
    scene.put("kf-1", keyframe().words(&[(1, 1.0)]).sees([door("901", [0.0, 0.0, 2.0])])).await;
    scene.put("kf-9", keyframe().words(&[(2, 1.0)]).sees([door("room 901", [0.0, 0.0, 2.0])])).await;
    scene
}

/// An event without what every event has.
fn told(event: &Value) -> [&str; 4] {
    ["event", "anchor", "other", "keyframe"].map(|member| event[member].as_str().unwrap_or_default())
}

#[tokio::test]
async fn an_anchor_that_matches_one_seen_before_is_told() {
    let scene = seen_twice().await;
    let [old, new] = texts(&json!(scene.anchors().await), "id").try_into().expect("two anchors");
    let events = scene.events_until("anchors_matched", 1).await;
    let expected = [
        ["keyframe_stored", "", "", "kf-1"],
        ["anchor_described", &old, "", ""],
        ["keyframe_stored", "", "", "kf-9"],
        ["anchor_described", &new, "", ""],
        ["anchors_matched", &new, &old, "kf-9"],
    ];
    assert_eq!(events.iter().map(told).collect::<Vec<_>>(), expected);
    let numbers: Vec<u64> = events.iter().map(|event| event["seq"].as_u64().expect("a number")).collect();
    assert_eq!(numbers, [1, 2, 3, 4, 5]);
}

#[tokio::test]
async fn the_query_rides_along_with_the_keyframe_and_the_loop_is_told() {
    let scene = Scene::new().await;
    scene.put("kf-1", keyframe().sees([door("901", [0.0, 0.0, 2.0])])).await;
    let path = scene.path("/keyframes/kf-9?query=loop");
    let body = keyframe().sees([door("901", [0.0, 0.0, 2.0])]).0;
    let answer = scene.server.put(&path, &body).await.expect(201);
    assert_eq!(answer["loop"]["best"], "kf-1", "{answer:#}");
    assert_eq!(answer["loop"], scene.ask("kf-9").await);
    scene.events_until("loop_found", 1).await;
    scene.close("l-1", "kf-9", "kf-1").await;
    let events = scene.events_until("loop_confirmed", 1).await;
    let found: Vec<&Value> = events.iter().filter(|event| event["event"] == "loop_found").collect();
    assert_eq!(found.len(), 1, "it is told once: {events:#?}");
    assert_eq!([&found[0]["keyframe"], &found[0]["candidate"]], ["kf-9", "kf-1"]);
    assert_eq!(found[0]["query"], answer["loop"]["id"]);
}

#[tokio::test]
async fn an_anchor_seen_before_triggers_loop_detection_without_being_asked() {
    let scene = seen_twice().await;
    let found = scene.events_until("loop_found", 1).await.pop().expect("an event");
    assert_eq!([&found["keyframe"], &found["candidate"]], ["kf-9", "kf-1"]);
}

#[tokio::test]
async fn the_verdict_of_a_query_that_an_event_names_can_be_read() {
    let scene = seen_twice().await;
    let found = scene.events_until("loop_found", 1).await.pop().expect("an event");
    let query = found["query"].as_str().expect("the query's name");
    let answer = scene.get(&format!("/loop-queries/{query}")).await;
    assert_eq!([&answer["id"], &answer["best"]], [query, "kf-1"]);
}
