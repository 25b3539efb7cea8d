//! Classes of codes: their texts are equal or different, and nothing between.

use serde_json::{Value, json};

use super::scene::{Scene, keyframe, thing};
use crate::exports::exported;

/// Puts keyframes, each in a session of its own and reading one text.
async fn read(scene: &Scene, texts: &[(&str, &str)]) {
    for (number, (class, text)) in texts.iter().enumerate() {
        let seen = keyframe().session(&format!("s-{number}")).sees([thing(class, text).at([0.0, 0.0, 2.0])]);
        scene.put(&format!("kf-{number}"), seen).await;
    }
}

/// The number of matches of each anchor, oldest first.
async fn matches(scene: &Scene) -> Vec<Value> {
    scene.anchors().await.into_iter().map(|anchor| anchor["matches_total"].clone()).collect()
}

#[tokio::test]
async fn texts_of_a_class_of_codes_are_compared_exactly() {
    let scene = Scene::of(json!({"code_classes": ["tag", "asset", "asset"]})).await;
    assert_eq!(scene.get("").await["code_classes"], json!(["asset", "tag"]));
    let texts = ["Kq-70x", "kq-70x", "Kq-70X", "Kq-71x", "Kq-7Ox", "Kq 70x", " Kq-70x "];
    read(&scene, &texts.map(|text| ("asset", text))).await;
    assert_eq!(matches(&scene).await, [1, 0, 0, 0, 0, 0, 1]);
    let first = &scene.anchors().await[0];
    assert_eq!((&first["state"], &first["identifiers"]), (&json!("valid"), &json!(["Kq-70x"])));
    let found = scene.get("/anchors?text=KQ-70X").await;
    assert_eq!(found["items"].as_array().unwrap().len(), 4, "a search sees no case: {found:#}");
}

#[tokio::test]
async fn the_name_of_a_fiducial_marker_is_a_code_in_any_class() {
    let scene = Scene::new().await;
    let texts = ["tag36h11:7", "tag36h11:70", "tag36h11:17", "tag25h9:7", "TAG36h11:7", "tag36h11:7"];
    read(&scene, &texts.map(|text| ("sign", text))).await;
    assert_eq!(matches(&scene).await, [1, 0, 0, 0, 0, 1]);
}

#[tokio::test]
async fn a_change_of_the_classes_applies_to_what_was_read_before() {
    let scene = Scene::new().await;
    read(&scene, &[("asset", "Kq-70x"), ("asset", "kq-70x"), ("sign", "R-12"), ("sign", "r-12")]).await;
    let set = async |body: Value| scene.server.patch("/v1/maps/tower", &body).await.expect(200);
    assert_eq!(matches(&scene).await, [1, 1, 1, 1]);
    assert_eq!(set(json!({"code_classes": ["asset"]})).await["code_classes"], json!(["asset"]));
    assert_eq!(matches(&scene).await, [0, 0, 1, 1]);
    set(json!({"description": "left as they are"})).await;
    assert_eq!(matches(&scene).await, [0, 0, 1, 1]);
    set(json!({"code_classes": ["sign"]})).await;
    assert_eq!(matches(&scene).await, [1, 1, 0, 0]);
    set(json!({"code_classes": []})).await;
    assert_eq!(matches(&scene).await, [1, 1, 1, 1]);
}

#[tokio::test]
async fn an_export_and_a_copy_have_the_classes_and_another_list_is_another_map() {
    let body = json!({"code_classes": ["asset"]});
    let scene = Scene::of(body.clone()).await;
    read(&scene, &[("asset", "Kq-70x")]).await;
    scene.server.put("/v1/maps/tower", &body).await.expect(200);
    scene.server.put("/v1/maps/tower", &json!({})).await.expect(409);
    let lines = exported(&scene.server, "tower").await;
    assert!(lines.iter().any(|line| line["body"]["code_classes"] == json!(["asset"])), "{lines:#?}");
    let copy = scene.server.put("/v1/maps/copy", &json!({"base": {"map": "tower"}})).await.expect(201);
    assert_eq!(copy["code_classes"], json!(["asset"]));
}
