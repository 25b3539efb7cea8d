//! §IV-C.2, the end, in the answers: a confirmed loop and its revocation (M12); `crates/core/tests/paper/closing.rs` asks the core.

use serde_json::json;

use super::scene::{Keyframe, NAMES, Scene, door, keyframe, texts};

/// A passage that sees 901, Turing, and one more.
fn passage(more: &str) -> Keyframe {
    keyframe().sees([
        door("901", [0.0, 0.0, 2.0]),
        door(NAMES[0], [2.0, 0.0, 2.0]),
        door(more, [-2.0, 0.0, 2.0]),
    ])
}

/// Two passages of one place; the anchors of each.
async fn two_passages() -> (Scene, Vec<String>, Vec<String>) {
    let scene = Scene::new().await;
    let old = scene.put("kf-1", passage(NAMES[1])).await;
    let new = scene.put("kf-9", passage(NAMES[2])).await;
    (scene, texts(&old["detections"], "anchor"), texts(&new["detections"], "anchor"))
}

#[tokio::test]
async fn a_confirmed_loop_and_its_revocation_are_in_every_answer_and_told() {
    let (scene, old, new) = two_passages().await;
    let before = scene.ask("kf-9").await;
    assert_eq!([&before["best"], &before["closed"]], [&json!("kf-1"), &json!([])]);
    let pairs = json!([{"into": old[0], "from": new[0]}, {"into": old[1], "from": new[1]}]);
    let closed = scene.close("l-1", "kf-9", "kf-1").await;
    assert_eq!([&closed["id"], &closed["merged"]], [&json!("l-1"), &pairs]);
    let listed = scene.get("/loops").await["items"].take();
    assert_eq!([&listed[0]["id"], &listed[0]["merged"]], [&json!("l-1"), &pairs]);
    assert_eq!(scene.anchor(&old[0]).await["keyframes"], json!(["kf-1", "kf-9"]));
    assert_eq!(scene.anchor(&new[0]).await["merged_into"], json!(old[0]));
    let answer = scene.ask("kf-9").await;
    assert_eq!(answer["closed"], json!([{"loop": "l-1", "keyframe": "kf-1"}]));
    assert_eq!(answer["reason"]["code"], "already_closed");
    let events = scene.events_until("anchors_merged", 2).await;
    let confirmed = events.iter().find(|event| event["event"] == "loop_confirmed").expect("it is told");
    let of_loop = ["loop", "keyframe", "candidate"].map(|member| &confirmed[member]);
    assert_eq!(of_loop, ["l-1", "kf-9", "kf-1"]);

    assert_eq!(scene.delete("/loops/l-1").await["split"], pairs);
    assert_eq!(scene.get("/loops").await["items"], json!([]));
    let after = scene.ask("kf-9").await;
    for member in ["verdict", "best", "loops", "closed", "candidates"] {
        assert_eq!(after[member], before[member], "{member}");
    }
    let revoked = scene.events_until("loop_revoked", 1).await.pop().expect("an event");
    assert_eq!(["loop", "keyframe", "candidate"].map(|member| &revoked[member]), ["l-1", "kf-9", "kf-1"]);
}

#[tokio::test]
async fn a_loop_is_warned_of_once_in_the_answer_and_to_listeners() {
    let scene = Scene::new().await;
    for room in ["901", "910"] {
        scene.put(room, keyframe().sees([door(room, [0.0, 0.0, 2.0])])).await;
    }
    let closed = scene.close("l-1", "910", "901").await;
    let warnings = &closed["warnings"];
    assert_eq!(texts(warnings, "code"), ["anchors_contradict"]);
    let detail = warnings[0]["detail"].as_str().unwrap_or_default();
    assert!(detail.contains("reads 910 where 901"), "{detail}");
    let told = scene.events_until("loop_confirmed", 1).await.pop().expect("an event");
    assert_eq!(told["detail"], warnings[0]["detail"]);
    let retry = json!({"id": "l-1", "keyframe": "910", "candidate": "901"});
    let again = scene.server.post(&scene.path("/loops"), &retry).await;
    assert_eq!(again.header("idempotent-replayed"), "true");
    assert_eq!(again.expect(200)["warnings"], json!([]));
}

#[tokio::test]
async fn a_loop_names_the_query_that_found_it() {
    let (scene, ..) = two_passages().await;
    let query = scene.ask("kf-9").await["id"].clone();
    let body = json!({"id": "l-1", "keyframe": "kf-9", "candidate": "kf-1", "query": query});
    scene.post("/loops", &body).await;
    assert_eq!(scene.get("/loops").await["items"][0]["query"], query);
    let events = scene.events_until("anchors_merged", 2).await;
    let confirmed = events.iter().find(|event| event["event"] == "loop_confirmed").expect("it is told");
    assert_eq!(confirmed["query"], query);
}
