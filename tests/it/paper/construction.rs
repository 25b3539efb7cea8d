//! §IV-B, in the answers: anchors as they are read; `crates/core/tests/paper/construction.rs` asks the core.

use serde_json::json;

use super::scene::{Scene, close_to_all, door, keyframe, texts, thing, unread};

#[tokio::test]
async fn an_anchor_is_read_with_all_it_knows_and_found_by_its_state() {
    let scene = Scene::of(json!({"anchor_classes": ["door_number"]})).await;
    let corners = [(1, [0.0, 0.0, 2.0]), (2, [1.0, 0.0, 2.0]), (3, [0.5, 1.0, 2.0])];
    let sights = [
        thing("door_number", "Room 901").on([1, 2, 3]),
        door("exit", [5.0, 0.0, 2.0]),
        unread([9.0, 0.0, 2.0]),
        thing("chair", "901").at([0.0, 0.0, 2.0]),
        thing("door_number", "901"),
    ];
    let stored = scene.put("kf-1", keyframe().points(&corners).sees(sights)).await;
    let detections = &stored["detections"];
    assert_eq!(texts(detections, "outcome"), ["created", "created", "created", "ignored", "ignored"]);
    assert_eq!(texts(detections, "state"), ["valid", "uninformative", "pending", "", ""]);
    assert_eq!(texts(detections, "reason")[3..], ["class_not_anchored", "no_place"]);
    let again = keyframe().covisible(&["kf-1"]).sees([thing("door_number", "Room 901").on([1, 2, 3])]);
    let again = scene.put("kf-2", again).await;
    let id = detections[0]["anchor"].as_str().expect("an anchor");
    assert_eq!(again["detections"], json!([{"anchor": id, "outcome": "observed", "state": "valid"}]));

    let anchor = scene.anchor(id).await;
    assert_eq!([&anchor["class"], &anchor["description"]], ["door_number", "Room 901"]);
    assert_eq!(anchor["keyframes"], json!(["kf-1", "kf-2"]));
    assert_eq!(anchor["identifiers"], json!(["901"]));
    assert_eq!([&anchor["map_points"], &anchor["information_level"]], [3, 5]);
    close_to_all("min", &anchor["box"]["min"], [0.0, 0.0, 2.0]);
    close_to_all("max", &anchor["box"]["max"], [1.0, 1.0, 2.0]);
    close_to_all("center", &anchor["center"], [0.5, 0.5, 2.0]);

    let valid = async || texts(&scene.get("/anchors?state=valid").await["items"], "description");
    assert_eq!(valid().await, ["Room 901"]);
    scene.set(json!({"description_min_information_level": 2})).await;
    assert_eq!(valid().await, ["Room 901", "exit"]);
}
