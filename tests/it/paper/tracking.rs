//! §IV-C.1, object tracking, in the answer; `crates/core/tests/paper/tracking.rs` asks the core.

use super::scene::{Scene, keyframe, texts, thing, unread};

#[tokio::test]
async fn an_answer_says_which_anchor_each_detection_is_a_sight_of() {
    let scene = Scene::new().await;
    let corners = [(1, [0.0, 0.0, 2.0]), (2, [1.0, 1.0, 2.0])];
    let by_points = |points: [i64; 2]| thing("door_number", "").on(points);
    let first = keyframe().points(&corners).sees([by_points([1, 2]), unread([5.0, 0.0, 2.0])]);
    let known = scene.put("kf-1", first).await;
    assert_eq!(texts(&known["detections"], "outcome"), ["created", "created"]);
    let sights = [by_points([2, 3]), unread([5.75, 0.0, 2.0]), unread([9.0, 0.0, 2.0])];
    let stored = scene.put("kf-2", keyframe().covisible(&["kf-1"]).sees(sights)).await;
    assert_eq!(texts(&stored["detections"], "outcome"), ["observed", "observed", "created"]);
    assert_eq!(texts(&stored["detections"], "anchor")[..2], texts(&known["detections"], "anchor"));
}
