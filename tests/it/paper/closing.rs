//! §IV-C.2, the end: a confirmed loop merges what matched, and its revocation parts it again (M12).

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
async fn after_a_confirmed_loop_the_same_question_names_it() {
    let (scene, ..) = two_passages().await;
    // A third place that is alike and bears other names: a candidate that is rejected.
    let elsewhere = keyframe().sees([door(NAMES[3], [0.0, 0.0, 2.0])]);
    scene.put("kf-5", elsewhere).await;
    assert_eq!(scene.ask("kf-9").await["closed"], json!([]));
    scene.close("l-1", "kf-9", "kf-1").await;
    for (query, other) in [("kf-9", "kf-1"), ("kf-1", "kf-9")] {
        let answer = scene.ask(query).await;
        assert_eq!(answer["verdict"], "no_loop", "{query}");
        assert_eq!(answer["closed"], json!([{"loop": "l-1", "keyframe": other}]), "{query}");
        assert_eq!(answer["reason"]["code"], "already_closed", "{query}");
        let detail = answer["reason"]["detail"].as_str().unwrap_or_default();
        assert!(detail.contains(other) && detail.contains("l-1"), "{detail}");
        assert_eq!(list(&answer["candidates"]).len(), 1, "{query}");
    }
    // Another loop is still a loop.
    scene.put("kf-20", passage(NAMES[4]).session("another")).await;
    let answer = scene.ask("kf-9").await;
    assert_eq!([&answer["verdict"], &answer["best"]], ["loop", "kf-20"]);
    assert!(answer.get("reason").is_none());
    scene.close("l-0", "kf-20", "kf-9").await;
    let closed = json!([{"loop": "l-0", "keyframe": "kf-20"}, {"loop": "l-1", "keyframe": "kf-1"}]);
    assert_eq!(scene.ask("kf-9").await["closed"], closed);
    scene.delete("/loops/l-1").await;
    assert_eq!(scene.ask("kf-1").await["closed"], json!([]));
}

#[tokio::test]
async fn a_loop_that_the_map_speaks_against_is_closed_with_a_warning() {
    let scene = Scene::new().await;
    let at = [0.0, 0.0, 2.0];
    scene.put("901", keyframe().sees([door("901", at)])).await;
    scene.put("901-again", keyframe().sees([door("901", at)])).await;
    scene.put("910", keyframe().sees([door("910", at)])).await;
    scene.put("904", keyframe().sees([door("904", at)])).await;
    scene.put("blank", keyframe()).await;
    scene.put("901-next", keyframe().covisible(&["901"])).await;
    for (keyframe, candidate, code, says) in [
        ("901-again", "901", None, ""),
        ("904", "901", Some("anchors_contradict"), "reads 904 where 901"),
        // A loop makes 904 stand around 901, too: either of the two contradicts.
        ("910", "901", Some("anchors_contradict"), "reads 910 where 90"),
        ("blank", "901", Some("not_supported"), "no_anchors"),
        ("901-next", "901", Some("already_covisible"), "the present place"),
        ("901-again", "901", Some("already_covisible"), "loop-0"),
    ] {
        let number = list(&scene.get("/loops").await["items"]).len();
        let closed = scene.close(&format!("loop-{number}"), keyframe, candidate).await;
        let warnings = list(&closed["warnings"]);
        assert_eq!(warnings.len(), usize::from(code.is_some()), "{keyframe}, {candidate}: {closed}");
        if let Some(code) = code {
            assert_eq!(warnings[0]["code"], code, "{keyframe}, {candidate}");
            let detail = warnings[0]["detail"].as_str().unwrap_or_default();
            assert!(detail.contains(says), "{detail}");
            let told = scene.events_until("loop_confirmed", number + 1).await.pop().expect("an event");
            assert_eq!(told["detail"], warnings[0]["detail"]);
        }
    }
    let retry = json!({"id": "loop-2", "keyframe": "910", "candidate": "901"});
    let again = scene.server.post(&scene.path("/loops"), &retry).await;
    assert_eq!(again.header("idempotent-replayed"), "true");
    assert_eq!(again.expect(200)["warnings"], json!([]));
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
