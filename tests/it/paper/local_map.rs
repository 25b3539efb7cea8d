//! §V-A, the local anchor map M_k, as it is read; `crates/core/tests/paper/local_map.rs` asks the core.

use super::scene::{Scene, close_to, close_to_all, door, keyframe, list, texts, thing, unread};

#[tokio::test]
async fn the_local_anchor_map_is_read_with_bearings_distances_weights_and_states() {
    let scene = Scene::new().await;
    let sights =
        [door("901", [3.0, 0.0, 4.0]), thing("sign", "exit").at([3.0, 0.0, 2.0]), unread([-3.0, 0.0, 2.0])];
    let stored = scene.put("kf-1", keyframe().sees(sights)).await;
    let found = scene.get("/keyframes/kf-1/local-anchor-map").await;
    assert_eq!(found["keyframe"], "kf-1");
    let anchors = &found["anchors"];
    assert_eq!(texts(anchors, "anchor"), texts(&stored["detections"], "anchor"));
    assert_eq!(texts(anchors, "class"), ["door_number", "sign", "door_number"]);
    assert_eq!(texts(anchors, "state"), ["valid", "uninformative", "pending"]);
    assert_eq!(texts(anchors, "description"), ["901", "exit", ""]);
    assert_eq!(list(anchors).len(), 3);
    close_to_all("bearing", &anchors[0]["bearing"], [0.6, 0.0, 0.8]);
    close_to("distance", &anchors[0]["distance_m"], 5.0);
    close_to("weight", &anchors[0]["weight"], 0.2);
}
