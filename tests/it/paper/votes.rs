//! M4, several readings, in the answers; `crates/core/tests/paper/votes.rs` asks the core.

use serde_json::json;

use super::scene::{Scene, door, keyframe};

#[tokio::test]
async fn an_anchors_readings_are_read_and_a_description_by_hand_stands_until_it_is_taken_back() {
    let scene = Scene::new().await;
    let reading = |text: &str, confidence: f64| [door(text, [0.0, 0.0, 2.0]).confidence(confidence)];
    let stored = scene.put("kf-0", keyframe().sees(reading("901", 0.5))).await;
    scene.put("kf-1", keyframe().covisible(&["kf-0"]).sees(reading("907", 0.4))).await;
    scene.put("kf-2", keyframe().covisible(&["kf-0"]).sees(reading("907", 0.2))).await;
    let id = stored["detections"][0]["anchor"].as_str().expect("an anchor");
    let anchor = scene.anchor(id).await;
    assert_eq!([&anchor["description"], &anchor["description_source"]], ["907", "readings"]);
    let readings =
        json!([{"text": "907", "weight": 0.6, "count": 2}, {"text": "901", "weight": 0.5, "count": 1}]);
    assert_eq!(anchor["readings"], readings);
    for (given, description, source) in
        [(Some("room 950"), "room 950", "operator"), (None, "907", "readings")]
    {
        let anchor = scene.describe(id, given).await;
        assert_eq!([&anchor["description"], &anchor["description_source"]], [description, source]);
        assert_eq!(anchor["readings"], readings);
    }
}
