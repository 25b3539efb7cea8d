//! §III: an anchor that was seen before triggers loop detection, even where no word does (§8.10).

use serde_json::{Value, json};

use super::scene::{Scene, close_to, door, keyframe, texts};

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
        ["anchor_described", &old, "", ""],
        ["anchor_described", &new, "", ""],
        ["anchors_matched", &new, &old, "kf-9"],
    ];
    assert_eq!(events.iter().map(told).collect::<Vec<_>>(), expected);
    let numbers: Vec<u64> = events.iter().map(|event| event["seq"].as_u64().expect("a number")).collect();
    assert_eq!(numbers, [1, 2, 3]);
}

#[tokio::test]
async fn an_anchor_seen_before_proposes_a_keyframe_that_shares_no_word() {
    let scene = seen_twice().await;
    let answer = scene.ask("kf-9").await;
    assert_eq!(answer["verdict"], "loop", "{answer:#}");
    assert_eq!(answer["best"], "kf-1");
    let candidate = scene.compare("kf-9", "kf-1").await;
    close_to("score", &candidate["bow"]["score"], 0.0);
    assert_eq!(candidate["bow"]["common_words"], 0);
    // (1/2 + 1/2) / (1/2 + 1/2).
    close_to("S", &candidate["anchors"]["similarity"], 1.0);
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
    let events = scene.events_until("loop_found", 1).await;
    let found = events.last().expect("an event");
    assert_eq!([&found["keyframe"], &found["candidate"]], ["kf-9", "kf-1"]);
    assert_eq!(found["query"], answer["loop"]["id"]);
}

#[tokio::test]
async fn an_anchor_merely_tracked_through_one_passage_proposes_nobody() {
    let scene = Scene::new().await;
    let plate = || [door("901", [0.0, 0.0, 2.0])];
    scene.put("kf-1", keyframe().words(&[(1, 1.0)]).sees(plate())).await;
    scene.put("kf-2", keyframe().words(&[(2, 1.0)]).covisible(&["kf-1"]).sees(plate())).await;
    scene.put("kf-3", keyframe().words(&[(3, 1.0)]).covisible(&["kf-2"]).sees(plate())).await;
    assert_eq!(scene.anchors().await.len(), 1);
    let answer = scene.ask("kf-3").await;
    assert_eq!(answer["candidates"], json!([]));
    assert_eq!(answer["verdict"], "no_loop");
    assert_eq!(answer["reason"]["code"], "no_candidates");
    assert_eq!(answer["excluded_covisible"], 1);
}

#[tokio::test]
async fn an_anchor_merged_by_a_confirmed_loop_proposes_the_other_passage_and_not_its_own() {
    let scene = Scene::new().await;
    let plate = || [door("901", [0.0, 0.0, 2.0])];
    // Two passages of the same door; no two keyframes share a word.
    scene.put("kf-1", keyframe().words(&[(1, 1.0)]).sees(plate())).await;
    scene.put("kf-2", keyframe().words(&[(2, 1.0)]).covisible(&["kf-1"]).sees(plate())).await;
    scene.put("kf-11", keyframe().words(&[(11, 1.0)]).sees(plate())).await;
    scene.close("l-1", "kf-11", "kf-1").await;
    scene.put("kf-12", keyframe().words(&[(12, 1.0)]).covisible(&["kf-11"]).sees(plate())).await;
    scene.put("kf-13", keyframe().words(&[(13, 1.0)]).covisible(&["kf-12"]).sees(plate())).await;
    assert_eq!(scene.anchors().await.len(), 1);

    let candidates = async |query: &str| texts(&scene.ask(query).await["candidates"], "keyframe");
    // kf-1 is covisible by the loop; kf-2 is what is left of its passage.
    assert_eq!(candidates("kf-11").await, ["kf-2"]);
    // kf-1 and kf-2 are one place, of which the smaller id stands; kf-11 is of kf-13's own passage.
    assert_eq!(candidates("kf-13").await, ["kf-1"]);
}
