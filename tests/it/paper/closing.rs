//! §IV-C.2, the end: a confirmed loop merges what matched, and its revocation parts it again (§8.12).

use serde_json::{Value, json};

use super::scene::{Keyframe, NAMES, Scene, door, keyframe, list, texts, to_the_letter};

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

/// What a map says of its anchors and keyframes, without the versions that count writes.
async fn what_stands(scene: &Scene) -> Value {
    let mut anchors = scene.get("/anchors?merged=true&limit=1000").await["items"].take();
    for anchor in anchors.as_array_mut().expect("a list") {
        anchor["version"].take();
    }
    let covisible = [scene.covisible("kf-1").await, scene.covisible("kf-9").await];
    json!([anchors, covisible, verdict(scene, "kf-9").await, verdict(scene, "kf-1").await])
}

async fn verdict(scene: &Scene, keyframe: &str) -> Value {
    let mut answer = scene.ask(keyframe).await;
    answer["id"].take();
    answer["map_version"].take();
    answer
}

#[tokio::test]
async fn a_confirmed_loop_merges_the_pairs_that_matched_and_no_others() {
    let (scene, old, new) = two_passages().await;
    let pairs = json!([{"into": old[0], "from": new[0]}, {"into": old[1], "from": new[1]}]);
    let closed = scene.close("l-1", "kf-9", "kf-1").await;
    assert_eq!(closed["id"], "l-1");
    assert_eq!(closed["merged"], pairs);

    for (into, from) in [(&old[0], &new[0]), (&old[1], &new[1])] {
        assert_eq!(scene.anchor(into).await["keyframes"], json!(["kf-1", "kf-9"]));
        assert_eq!(scene.anchor(from).await["merged_into"], **into);
    }
    for alone in [&old[2], &new[2]] {
        assert_eq!(list(&scene.anchor(alone).await["keyframes"]).len(), 1);
    }
    assert_eq!(scene.anchors().await.len(), 4);
    let events = scene.events_until("anchors_merged", 2).await;
    let confirmed = events.iter().find(|event| event["event"] == "loop_confirmed").expect("it is told");
    assert_eq!(
        [&confirmed["loop"], &confirmed["keyframe"], &confirmed["candidate"]],
        ["l-1", "kf-9", "kf-1"]
    );
    let listed = scene.get("/loops").await;
    assert_eq!(listed["items"][0]["id"], "l-1");
    assert_eq!(listed["items"][0]["merged"], pairs);
}

#[tokio::test]
async fn a_confirmed_loop_makes_its_two_keyframes_covisible() {
    let (scene, ..) = two_passages().await;
    assert_eq!(scene.ask("kf-9").await["best"], "kf-1");
    scene.close("l-1", "kf-9", "kf-1").await;
    assert_eq!(scene.covisible("kf-9").await, ["kf-1"]);
    assert_eq!(scene.covisible("kf-1").await, ["kf-9"]);
    for query in ["kf-9", "kf-1"] {
        let answer = scene.ask(query).await;
        assert_eq!(answer["excluded_covisible"], 1, "{query}");
        assert_eq!(answer["candidates"], json!([]), "{query}");
    }
}

#[tokio::test]
async fn a_revoked_loop_leaves_everything_as_it_was() {
    let (scene, old, new) = two_passages().await;
    let before = what_stands(&scene).await;
    assert_eq!(before[2]["verdict"], "loop");
    scene.close("l-1", "kf-9", "kf-1").await;
    assert_ne!(what_stands(&scene).await, before);
    let revoked = scene.delete("/loops/l-1").await;
    assert_eq!(revoked["split"], json!([{"into": old[0], "from": new[0]}, {"into": old[1], "from": new[1]}]));
    assert_eq!(what_stands(&scene).await, before);
    assert_eq!(scene.get("/loops").await["items"], json!([]));
    let revoked = scene.events_until("loop_revoked", 1).await.pop().expect("an event");
    assert_eq!([&revoked["loop"], &revoked["keyframe"], &revoked["candidate"]], ["l-1", "kf-9", "kf-1"]);
}

#[tokio::test]
async fn what_is_seen_while_a_loop_stands_stays_with_its_own_passage_when_it_falls() {
    let (scene, old, new) = two_passages().await;
    scene.close("l-1", "kf-9", "kf-1").await;
    for (id, before) in [("kf-2", "kf-1"), ("kf-10", "kf-9")] {
        scene.put(id, keyframe().covisible(&[before]).sees([door("901", [0.0, 0.0, 2.0])])).await;
    }
    // In order of arrival: kf-2 came after kf-9.
    assert_eq!(scene.anchor(&old[0]).await["keyframes"], json!(["kf-1", "kf-9", "kf-2", "kf-10"]));
    scene.delete("/loops/l-1").await;
    assert_eq!(scene.anchor(&old[0]).await["keyframes"], json!(["kf-1", "kf-2"]));
    assert_eq!(scene.anchor(&new[0]).await["keyframes"], json!(["kf-9", "kf-10"]));
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

#[tokio::test]
async fn covisibility_that_was_declared_outlives_a_revoked_loop() {
    let scene = Scene::new().await;
    scene.put("kf-1", passage(NAMES[1])).await;
    scene.put("kf-9", keyframe().covisible(&["kf-1"])).await;
    scene.close("l-1", "kf-9", "kf-1").await;
    scene.delete("/loops/l-1").await;
    assert_eq!(scene.covisible("kf-9").await, ["kf-1"]);
}

#[tokio::test]
async fn a_loop_merges_one_to_one_even_where_the_map_reads_the_equation_to_the_letter() {
    // Three EXIT signs in view of each other, all of them in reach of each of the other three.
    let scene = Scene::with(to_the_letter(&json!({"description_min_information_level": 2}))).await;
    let signs =
        || [[0.6, 0.0, 0.8], [0.0, 0.6, 0.8], [2.0 / 3.0, 2.0 / 3.0, 1.0 / 3.0]].map(|at| door("EXIT", at));
    let old = scene.put("kf-1", keyframe().sees(signs())).await;
    let new = scene.put("kf-9", keyframe().sees(signs())).await;
    let closed = scene.close("l-1", "kf-9", "kf-1").await;
    let (mut into, mut from) = (texts(&closed["merged"], "into"), texts(&closed["merged"], "from"));
    into.sort();
    from.sort();
    assert_eq!(into, texts(&old["detections"], "anchor"));
    assert_eq!(from, texts(&new["detections"], "anchor"));
}
