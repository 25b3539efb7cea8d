//! Verdicts in the answer: the paper's method by name, what nothing has described, which checks run (M11, M28, M39), and
//! the brief form;
//! `crates/core/tests/paper/verdicts.rs` asks the core.

use std::time::Duration;

use serde_json::{Value, json};

use super::scene::{Detection, Scene, candidate_of, door, keyframe, unread};

/// A query that waits for nothing is answered long before; the test fails instead of hanging.
const PATIENCE: Duration = Duration::from_secs(30);

const AHEAD: [f64; 3] = [0.0, 0.0, 1.0];

fn plate() -> Vec<Detection> {
    vec![door("901", AHEAD)]
}

#[tokio::test]
async fn the_papers_method_is_one_setting_and_what_is_named_beside_it_wins() {
    let scene = Scene::with(json!({"method": "paper", "covisibility_max_way_m": 2})).await;
    let shown = async || scene.get("").await["settings"].clone();
    let paper = shown().await;
    assert_eq!(
        (&paper["method"], &paper["covisibility_max_way_m"], &paper["learned_identifiers"]),
        (&json!("paper"), &json!(2.0), &json!(false)),
        "{paper}"
    );
    scene.set(json!({"method": "revisit"})).await;
    let ours = shown().await;
    assert_eq!(
        (&ours["method"], &ours["covisibility_max_way_m"], &ours["learned_identifiers"]),
        (&json!("revisit"), &json!(3.0), &json!(true)),
        "{ours}"
    );
    let answer = scene.server.put("/v1/maps/other", &json!({"settings": {"method": "papers"}})).await;
    assert_eq!(answer.expect(422)["errors"][0]["pointer"], "/settings/method");
}

#[tokio::test]
async fn a_server_without_models_says_at_once_what_nothing_has_described() {
    let scene = Scene::new().await;
    scene.put("candidate", keyframe().sees(plate())).await;
    scene.put("query", keyframe().sees([unread(AHEAD)])).await;
    // Were it to wait, this test would hang: nothing is written any more.
    let patient = json!({"keyframe": "query", "max_wait_ms": 60_000});
    let answer = tokio::time::timeout(PATIENCE, scene.post("/loop-queries", &patient)).await;
    let answer = answer.expect("an answer without waiting");
    assert_eq!(answer["verdict"], "undecided", "{answer:#}");
    assert_eq!(answer["candidates"][0]["reason"]["code"], "not_described", "{answer:#}");
}

#[tokio::test]
async fn a_request_says_whether_geometry_may_or_must_run() {
    let scene = Scene::new().await;
    scene.put("same-room", keyframe().sees(plate())).await;
    scene.put("other-room", keyframe().sees([door("910", AHEAD)])).await;
    scene.put("query", keyframe().sees(plate())).await;
    let check = async |verify: Option<&str>, verdict: &str, of_same: [Option<&str>; 2]| {
        let mut body = json!({"keyframe": "query"});
        if let Some(verify) = verify {
            body["verify"] = json!(verify);
        }
        let answer = scene.post("/loop-queries", &body).await;
        assert_eq!([&answer["verdict"], &answer["degraded"]], [&json!(verdict), &json!(false)], "{verify:?}");
        let of = |id: &str| candidate_of(&answer, id).expect("it is a candidate");
        let same = of("same-room");
        assert_eq!([same["verdict"].as_str(), same["reason"]["code"].as_str()], of_same, "{verify:?}");
        // What the anchors stopped, geometry does not save.
        assert_eq!(of("other-room")["reason"]["code"], "contradiction", "{verify:?}");
        for id in ["same-room", "other-room"] {
            assert_eq!(of(id)["geometry"]["status"], "skipped", "{verify:?}: no keyframe has features");
        }
    };
    check(None, "loop", [Some("loop"), None]).await;
    check(Some("auto"), "loop", [Some("loop"), None]).await;
    check(Some("anchors"), "loop", [Some("loop"), None]).await;
    check(Some("geometry"), "undecided", [Some("undecided"), Some("no_features")]).await;
}

/// Returns an answer without what `?detail=brief` leaves out.
fn shortened(whole: &Value) -> Value {
    let mut brief = whole.clone();
    let candidates = brief["candidates"].as_array_mut().expect("a list");
    candidates.retain(|candidate| candidate["verdict"] != "rejected");
    for anchors in candidates.iter_mut().filter_map(|candidate| candidate["anchors"].as_object_mut()) {
        anchors.remove("matches").expect("a whole answer has them, if only as an empty list");
    }
    brief
}

#[tokio::test]
async fn a_brief_answer_is_the_whole_one_without_rejected_candidates_and_without_matches() {
    let scene = Scene::new().await;
    scene.put("same-room", keyframe().sees(plate())).await;
    scene.put("other-room", keyframe().sees([door("910", AHEAD)])).await;
    scene.put("bare", keyframe()).await;
    let query = keyframe().sees(plate()).0;

    // The brief answer comes first: its record is whole from the start.
    let written = scene.server.put(&scene.path("/keyframes/query?query=loop&detail=brief"), &query).await;
    let brief = written.expect(201)["loop"].clone();
    let kept = async || scene.get(&format!("/loop-queries/{}", brief["id"].as_str().expect("an id"))).await;
    let whole = kept().await;
    let verdicts = |answer: &Value| -> Vec<String> {
        let candidates = answer["candidates"].as_array().expect("a list").iter();
        candidates.map(|candidate| candidate["verdict"].as_str().expect("a verdict").to_owned()).collect()
    };
    assert_eq!(verdicts(&whole), ["loop", "undecided", "rejected"], "{whole:#}");
    assert_eq!(verdicts(&brief), ["loop", "undecided"], "{brief:#}");
    assert_eq!(whole["candidates"][0]["anchors"]["matches"].as_array().map(Vec::len), Some(1), "{whole:#}");
    assert_eq!(brief, shortened(&whole));

    let again = scene.server.put(&scene.path("/keyframes/query?query=loop&detail=brief"), &query).await;
    assert_eq!(again.expect(200)["loop"], brief, "a retry");
    let body = json!({"keyframe": "query"});
    assert_eq!(scene.post("/loop-queries?detail=brief", &body).await, brief);
    for detail in ["", "?detail=full"] {
        assert_eq!(scene.post(&format!("/loop-queries{detail}"), &body).await, whole, "{detail}");
    }
    assert_eq!(kept().await, whole);
}

#[tokio::test]
async fn a_detail_by_another_name_is_refused_with_the_names_there_are() {
    let scene = Scene::new().await;
    scene.put("kf-1", keyframe()).await;
    let asked =
        scene.server.post(&scene.path("/loop-queries?detail=short"), &json!({"keyframe": "kf-1"})).await;
    let stored =
        scene.server.put(&scene.path("/keyframes/kf-2?query=loop&detail=short"), &keyframe().0).await;
    for answer in [asked, stored] {
        let error = answer.expect(422)["errors"][0].clone();
        assert_eq!(error["pointer"], "?detail", "{error:#}");
        assert_eq!(error["limit"], "full, brief", "{error:#}");
    }
    assert_eq!(scene.server.get(&scene.path("/keyframes/kf-2")).await.status, 404);
}
