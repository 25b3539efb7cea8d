//! Moves and removals (M33), in the answers; `crates/core/tests/paper/correction.rs` asks the core.

use serde_json::{Value, json};

use super::scene::{NAMES, Scene, close_to_all, door, keyframe, thing, turned};
use crate::support::pose;

fn poses(keyframes: &[(&str, Value)], points: &[(i64, [f64; 3])]) -> Value {
    let (ids, poses): (Vec<&str>, Vec<&Value>) = keyframes.iter().map(|(id, pose)| (*id, pose)).unzip();
    let (points, positions): (Vec<i64>, Vec<[f64; 3]>) = points.iter().copied().unzip();
    json!({"keyframes": {"ids": ids, "poses": poses}, "map_points": {"ids": points, "positions": positions}})
}

#[tokio::test]
async fn a_correction_moves_what_is_read_and_a_culled_keyframe_is_read_no_more() {
    let scene = Scene::new().await;
    let known = scene.put("kf-1", keyframe().at([1.0, 0.0, 0.0]).sees([door("901", [1.0, 0.0, 2.0])])).await;
    let seen = [thing("door_number", NAMES[0]).on([1, 2])];
    scene.put("kf-2", keyframe().points(&[(1, [0.0, 0.0, 2.0]), (2, [1.0, 1.0, 2.0])]).sees(seen)).await;
    // A quarter turn about y takes ahead (z) to x: 2 m ahead of (10, 5, 0) is (12, 5, 0).
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let moved = turned([10.0, 5.0, 0.0], [0.0, half, 0.0, half]);
    let answer = scene.post("/poses", &poses(&[("kf-1", moved)], &[(2, [3.0, 1.0, 4.0])])).await;
    assert_eq!([&answer["keyframes"], &answer["map_points"]], [1, 1]);
    let anchors = scene.anchors().await;
    close_to_all("by position", &anchors[0]["center"], [12.0, 5.0, 0.0]);
    close_to_all("by points", &anchors[1]["center"], [1.5, 0.5, 3.0]);
    let at = scene.get("/keyframes/kf-1").await["pose"]["translation"].take();
    close_to_all("pose", &json!([at["x"], at["y"], at["z"]]), [10.0, 5.0, 0.0]);

    scene.delete("/keyframes/kf-1").await;
    let lost = known["detections"][0]["anchor"].as_str().expect("an anchor");
    for path in ["/keyframes/kf-1".to_owned(), format!("/anchors/{lost}")] {
        assert_eq!(scene.server.get(&scene.path(&path)).await.status.as_u16(), 404, "{path}");
    }
}

#[tokio::test]
async fn a_correction_is_taken_over_whole_or_not_at_all() {
    let scene = Scene::new().await;
    scene
        .put("kf-1", keyframe().points(&[(1, [0.0, 0.0, 2.0])]).sees([thing("door_number", "901").on([1])]))
        .await;
    let before = (scene.get("/keyframes/kf-1").await, scene.get("/anchors").await);
    let body = poses(
        &[("kf-1", pose([9.0, 0.0, 0.0])), ("kf-none", pose([9.0, 0.0, 0.0]))],
        &[(1, [5.0, 5.0, 5.0])],
    );
    let answer = scene.server.post(&scene.path("/poses"), &body).await;
    assert_eq!(answer.status.as_u16(), 422);
    assert_eq!(answer.pointers(), ["/keyframes/ids/1"]);
    assert_eq!((scene.get("/keyframes/kf-1").await, scene.get("/anchors").await), before);
}
