//! M6, distinctive weights, in the answers; `crates/core/tests/paper/distinctive.rs` asks the core.

use serde_json::json;

use super::scene::{Scene, close_to, door, keyframe};

#[tokio::test]
async fn a_sign_in_two_places_weighs_a_half_and_is_reported_as_not_distinctive() {
    let scene = Scene::new().await;
    for (id, x) in [("here", 0.0), ("there", 10.0)] {
        scene.put(id, keyframe().at([x, 0.0, 0.0]).sees([door("901", [x, 0.0, 2.0])])).await;
    }
    close_to("weight", &scene.local_map("here").await[0]["weight"], 0.5 / 2.0);
    scene.put("query", keyframe().session("other-day").sees([door("901", [0.0, 0.0, 2.0])])).await;
    let found = scene.compare("query", "here").await;
    assert_eq!([&found["verdict"], &found["reason"]["code"]], ["undecided", "not_distinctive"]);
    assert_eq!(
        [&found["evidence"][0]["kind"], &found["evidence"][0]["log_odds"]],
        [&json!("shared_name"), &json!(0.0)]
    );
    scene.set(json!({"method": "paper"})).await;
    close_to("by the letter", &scene.local_map("here").await[0]["weight"], 0.5);
}
