//! §IV-C.2, semantic anchor matching, in the answers; `crates/core/tests/paper/matching.rs` asks the core.

use serde_json::json;

use super::scene::{Scene, door, keyframe, list, texts};

#[tokio::test]
async fn matches_are_read_with_their_kind_and_merged_anchors_name_each_other() {
    let scene = Scene::new().await;
    let at = |x: f64| [x, 0.0, 2.0];
    scene.put("kf-1", keyframe().sees([door("901", at(0.0)), door("901", at(5.0))])).await;
    scene.put("kf-9", keyframe().sees([door("room 901", at(0.0)), door("910", at(9.0))])).await;
    let anchors = scene.anchors().await;
    let matches = &anchors[0]["matches"];
    assert_eq!(texts(matches, "anchor"), ["a-1", "a-2"]);
    assert_eq!(texts(matches, "kind"), ["covisible", "revisit"]);
    assert_eq!(texts(matches, "source"), ["identical", "identifiers"]);
    assert!(
        list(matches).iter().all(|found| found["level"] == 5 && found["reason"].is_string()),
        "{matches}"
    );
    assert_eq!([&anchors[0]["matches_total"], &anchors[3]["matches_total"]], [2, 0]);

    // Two of one keyframe, too near each other to be two.
    scene.put("kf-20", keyframe().sees([door("Turing", at(0.0)), door("Turing", at(0.5))])).await;
    let merged = scene.anchor("a-4").await;
    assert_eq!(merged["merged_from"], json!(["a-5"]));
    assert_eq!(scene.anchor("a-5").await["merged_into"], "a-4");
    let told = scene.events_until("anchors_merged", 1).await.pop().expect("an event");
    assert_eq!([&told["anchor"], &told["other"]], ["a-4", "a-5"]);
}
