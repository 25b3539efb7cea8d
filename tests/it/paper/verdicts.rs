//! Verdicts in the answer: the paper's method by name, what nothing has described, and which checks run (M11, M28, M39);
//! `core/tests/paper/verdicts.rs` asks the core.

use std::time::Duration;

use serde_json::json;

use super::scene::{Detection, Scene, candidate_of, door, keyframe, unread};

/// A query that waits for nothing is answered long before; the test fails instead of hanging.
const PATIENCE: Duration = Duration::from_secs(30);

const AHEAD: [f64; 3] = [0.0, 0.0, 1.0];

fn plate() -> Vec<Detection> {
    vec![door("901", AHEAD)]
}

#[tokio::test]
async fn the_papers_method_is_one_setting_and_what_is_named_beside_it_wins() {
    let scene = Scene::with(json!({"method": "paper", "one_to_one": true})).await;
    let shown = async || scene.get("").await["settings"].clone();
    let paper = shown().await;
    assert_eq!(
        (&paper["one_to_one"], &paper["contradiction_veto"]),
        (&json!(true), &json!(false)),
        "{paper}"
    );
    assert_eq!(
        (&paper["undecided_min_score_ratio"], &paper["method"]),
        (&json!(0.0), &json!(null)),
        "{paper}"
    );
    scene.set(json!({"method": "revisit"})).await;
    let ours = shown().await;
    assert_eq!(
        (&ours["contradiction_veto"], &ours["undecided_min_score_ratio"]),
        (&json!(true), &json!(0.3))
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
