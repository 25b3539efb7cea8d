//! §V-B, Eq. (1) and (2), in the answer; `crates/core/tests/paper/equation.rs` asks the core.

use serde_json::{Value, json};

use super::scene::{Detection, Scene, close_to, door, keyframe, unread};

/// What the query says of the candidate, each seeing these things from the origin.
pub(super) async fn compared(
    settings: &Value,
    query: impl IntoIterator<Item = Detection>,
    candidate: impl IntoIterator<Item = Detection>,
) -> Value {
    let scene = Scene::with(settings.clone()).await;
    scene.put("candidate", keyframe().sees(candidate)).await;
    scene.put("query", keyframe().sees(query)).await;
    scene.compare("query", "candidate").await
}

#[tokio::test]
async fn s_and_every_pair_are_told_with_every_figure() {
    let query = [door("901", [0.0, 0.0, 2.0]), unread([-2.0, 0.0, 0.0])];
    let found = compared(&json!({"method": "paper"}), query, [door("room 901", [1.5, 0.0, 2.0])]).await;
    assert_eq!(found["verdict"], "loop");
    let anchors = &found["anchors"];
    close_to("S", &anchors["similarity"], 1.0);
    close_to("threshold", &anchors["threshold"], 0.3);
    assert_eq!(["in_query", "in_candidate", "pending"].map(|member| &anchors[member]), [1, 1, 1]);
    let pair = &anchors["matches"][0];
    assert_eq!(pair["level"], 5);
    assert_eq!(pair["source"], "identifiers");
    // atan(1.5 / 2); sqrt(1.5^2 + 2^2) = 2.5.
    close_to("angle", &pair["angle_difference_rad"], 0.75_f64.atan());
    close_to("distance", &pair["distance_difference_m"], 0.5);
    close_to("weight", &pair["weight"], 0.5 + 0.4);
    assert_eq!([&pair["query_anchor"], &pair["candidate_anchor"]], ["a-1", "a-0"]);
}
