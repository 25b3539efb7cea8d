//! The kind of each text, in anchors, local maps and verdicts.

use serde_json::json;

use super::scene::{Scene, door, keyframe, texts, thing, unread};

#[tokio::test]
async fn each_text_has_a_kind_and_what_a_person_describes_is_a_description() {
    let scene = Scene::of(json!({"code_classes": ["asset"]})).await;
    let read = [
        ("door_number", "901", "name"),
        ("sign", "Meeting Room Turing", "proper_name"),
        ("sign", "Please keep this door closed", "notice"),
        ("sign", "EXIT", "common_sign"),
        ("sign", "tag36h11:7", "code"),
        ("asset", "901", "code"),
        ("sign", "Kijárat ablak", "unknown"),
    ];
    let at = |number: usize| [5.0 * number as f64, 0.0, 2.0];
    let things = read.iter().enumerate().map(|(number, (class, text, _))| thing(class, text).at(at(number)));
    scene.put("kf-1", keyframe().sees(things)).await;
    let kinds = read.map(|(.., kind)| kind);
    assert_eq!(texts(&json!(scene.anchors().await), "kind"), kinds);
    assert_eq!(texts(&json!(scene.local_map("kf-1").await), "kind"), kinds);
    let last = scene.anchors().await[6]["id"].as_str().expect("an id").to_owned();
    let described = scene.describe(&last, Some("a sticker of a red boat")).await;
    assert_eq!(described["kind"], "description");
}

#[tokio::test]
async fn a_match_says_the_kind_of_the_query_s_text_and_nothing_read_has_none() {
    let scene = Scene::new().await;
    scene.put("candidate", keyframe().sees([door("901", [0.0, 0.0, 2.0])])).await;
    let query = [door("room 901", [0.0, 0.0, 2.0]), unread([-2.0, 0.0, 0.0])];
    scene.put("query", keyframe().sees(query)).await;
    let found = scene.compare("query", "candidate").await;
    assert_eq!(found["anchors"]["matches"][0]["kind"], "name", "{found:#}");
    let anchors = scene.anchors().await;
    assert!(anchors[2].get("kind").is_none(), "{anchors:#?}");
}
