//! M6, distinctive weights, in the answers; `core/tests/paper/distinctive.rs` asks the core.

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
    let reason = &found["reason"];
    assert_eq!([&found["verdict"], &reason["code"]], ["undecided", "not_distinctive"]);
    assert_eq!([&reason["measured"], &reason["limit"]], [&json!(2.0), &json!(1.0)]);
    scene.set(json!({"distinctive_weights": false})).await;
    close_to("turned off", &scene.local_map("here").await[0]["weight"], 0.5);
}
