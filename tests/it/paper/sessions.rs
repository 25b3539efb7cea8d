//! Sessions (M32), in the answers: an anchor in the frame of each; `crates/core/tests/paper/sessions.rs` asks the core.

use serde_json::json;

use super::scene::{Scene, close_to_all, door, keyframe, list, texts};

#[tokio::test]
async fn an_anchor_merged_across_sessions_is_read_in_each_frame() {
    const OLD_DOOR: [f64; 3] = [0.0, 0.0, 2.0];
    const NEW_DOOR: [f64; 3] = [100.0, 50.0, 2.5];
    let scene = Scene::new().await;
    scene.put("monday-1", keyframe().session("monday").sees([door("901", OLD_DOOR)])).await;
    let new_day = keyframe().session("tuesday").at([100.0, 50.0, 0.0]);
    scene.put("tuesday-1", new_day.sees([door("901", NEW_DOOR)])).await;
    assert_eq!(scene.ask("tuesday-1").await["best"], "monday-1");
    scene.close("l-1", "tuesday-1", "monday-1").await;

    let anchor = scene.anchors().await.remove(0);
    assert_eq!(anchor["keyframes"], json!(["monday-1", "tuesday-1"]));
    assert_eq!(texts(&anchor["frames"], "session"), ["monday", "tuesday"]);
    for (frame, place) in list(&anchor["frames"]).iter().zip([OLD_DOOR, NEW_DOOR]) {
        close_to_all("center", &frame["center"], place);
        close_to_all("min", &frame["box"]["min"], place);
        close_to_all("max", &frame["box"]["max"], place);
    }
    close_to_all("the oldest session's", &anchor["center"], OLD_DOOR);
}
