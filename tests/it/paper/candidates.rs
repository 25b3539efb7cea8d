//! §V, checks 1 and 2, in the answer; `crates/core/tests/paper/candidates.rs` asks the core.

use serde_json::json;

use super::scene::{Scene, close_to, keyframe, texts};

#[tokio::test]
async fn an_answer_says_what_is_covisible_and_how_alike_the_candidates_look() {
    let scene = Scene::with(json!({"candidates_min_gap_s": 10})).await;
    // 40 zero bytes: five features of 8 bytes, seeing the points 11 to 15.
    let features = json!({
        "descriptor_bytes": 8, "descriptors": format!("{}==", "A".repeat(54)),
        "keypoints": [[1, 1], [2, 2], [3, 3], [4, 4], [5, 5]], "map_points": [11, 12, 13, 14, 15]
    });
    scene.put("elsewhere", keyframe().words(&[(1, 0.25), (2, 0.75)])).await;
    scene.put("neighbour", keyframe().stamp(100).observes(1..=15)).await;
    scene.put("too-recent", keyframe().stamp(101)).await;
    // 10 listed and 5 seen by features.
    let query = keyframe().stamp(102).observes(1..=10).member("features", features);
    let stored = scene.put("query", query.words(&[(1, 0.5), (2, 0.5)])).await;
    assert_eq!(stored["covisible"], 1);
    let shared = scene.get("/keyframes/query/covisible").await;
    assert_eq!(shared["items"], json!([{"keyframe": "neighbour", "shared": 15}]));
    let answer = scene.ask("query").await;
    assert_eq!(answer["excluded_covisible"], 1);
    assert_eq!(texts(&answer["candidates"], "keyframe"), ["elsewhere"]);
    let bow = &answer["candidates"][0]["bow"];
    close_to("score", &bow["score"], 0.75);
    assert_eq!(bow["common_words"], 2);
    close_to("reference", &bow["reference_score"], 0.5);
    // Where all are covisible or too recent, the answer itself says why there is none.
    scene.delete("/keyframes/elsewhere").await;
    let reason = scene.ask("query").await["reason"].clone();
    assert_eq!(
        [&reason["code"], &reason["measured"], &reason["limit"]],
        [&json!("too_recent"), &json!(1.0), &json!(10.0)]
    );
}
