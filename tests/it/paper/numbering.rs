//! M20, the numbering of a building, and M26, assumed distances, in the answers;
//! `crates/core/tests/paper/numbering.rs` asks the core.

use serde_json::json;

use super::scene::{Scene, close_to, keyframe, thing};

#[tokio::test]
async fn a_given_numbering_is_read_with_the_anchor_and_an_assumed_distance_weighs_one() {
    let scene = Scene::with(json!({"identifier_patterns": ["hub ?[0-9]+"]})).await;
    let mut board = thing("sign", "HUB04").at([0.0, 0.0, 5.0]);
    board.0["range"] = json!("assumed");
    scene.put("board", keyframe().sees([board, thing("sign", "7.04").at([0.0, 0.0, 2.0])])).await;
    let [board, other] = scene.anchors().await.try_into().expect("two anchors");
    assert_eq!([&board["state"], &other["state"]], ["valid", "uninformative"]);
    assert_eq!(board["numbering"], json!(["hub ?[0-9]+"]));
    let around = scene.local_map("board").await;
    close_to("assumed", &around[0]["weight"], 1.0);
    close_to("measured", &around[1]["weight"], 0.5);
}

#[tokio::test]
async fn a_pattern_that_is_none_is_refused_where_it_stands() {
    let scene = Scene::new().await;
    for bad in [json!(["("]), json!([""]), json!(["(a)\\1"])] {
        let body = json!({"settings": {"identifier_patterns": bad}});
        let answer = scene.server.put("/v1/maps/other", &body).await;
        assert_eq!(answer.status, 422, "{answer:#?}");
        assert_eq!(answer.body["errors"][0]["pointer"], "/settings/identifier_patterns/0", "{answer:#?}");
    }
    let many: Vec<String> = (0..17).map(|number| format!("a{number}")).collect();
    let body = json!({"settings": {"identifier_patterns": many}});
    assert_eq!(scene.server.put("/v1/maps/other", &body).await.status, 422);
}
