//! §III: an anchor that was seen before triggers loop detection, even where no word does (M10).

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

/// Two passages of one door, joined by a loop of their first keyframes; no two keyframes share a word.
async fn joined_passages() -> Scene {
    let scene = Scene::new().await;
    let plate = || [door("901", [0.0, 0.0, 2.0])];
    scene.put("kf-1", keyframe().words(&[(1, 1.0)]).sees(plate())).await;
    scene.put("kf-2", keyframe().words(&[(2, 1.0)]).covisible(&["kf-1"]).sees(plate())).await;
    scene.put("kf-11", keyframe().words(&[(11, 1.0)]).sees(plate())).await;
    scene.close("l-1", "kf-11", "kf-1").await;
    scene.put("kf-12", keyframe().words(&[(12, 1.0)]).covisible(&["kf-11"]).sees(plate())).await;
    scene.put("kf-13", keyframe().words(&[(13, 1.0)]).covisible(&["kf-12"]).sees(plate())).await;
    assert_eq!(scene.anchors().await.len(), 1);
    scene
}

#[tokio::test]
async fn an_anchor_merged_by_a_confirmed_loop_proposes_the_other_passage_and_not_its_own() {
    let scene = joined_passages().await;
    let candidates = async |query: &str| texts(&scene.ask(query).await["candidates"], "keyframe");
    // kf-1 and kf-2 are one place, of which the smaller id stands; kf-11 is of kf-12's and kf-13's own passage.
    assert_eq!(candidates("kf-13").await, ["kf-1"]);
    assert_eq!(candidates("kf-12").await, ["kf-1"]);
}

#[tokio::test]
async fn the_keyframe_that_closed_the_loop_is_proposed_the_rest_of_the_other_passage() {
    let scene = joined_passages().await;
    let answer = scene.ask("kf-11").await;
    // kf-1 is covisible by the loop (M12), and so is kf-12 by its client; kf-2 observes an anchor that a confirmed
    // loop merged with one that kf-11 sees (M10).
    assert_eq!(answer["excluded_covisible"], 2);
    assert_eq!(texts(&answer["candidates"], "keyframe"), ["kf-2"]);
}
