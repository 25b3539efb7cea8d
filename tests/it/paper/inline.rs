//! M50, in the answer: a keyframe sent along with the query is judged as if it had just arrived, and is not stored;
//! `crates/core/tests/paper/inline.rs` asks the core.

use serde_json::{Value, json};

use super::scene::{Detection, Keyframe, NAMES, Scene, door, keyframe, list, thing, unread};

/// The verdict without its name; anchors that the keyframe founds go by its detections.
fn figures(mut answer: Value, founded: &[String]) -> Value {
    answer["id"].take();
    answer["map_version"].take();
    for candidate in answer["candidates"].as_array_mut().expect("a list") {
        for pairs in ["matches", "contradictions"] {
            for pair in candidate["anchors"][pairs].as_array_mut().expect("a list") {
                let place = founded.iter().position(|anchor| pair["query_anchor"] == json!(anchor));
                if let Some(place) = place {
                    pair["query_anchor"] = json!(format!("inline-{place}"));
                }
            }
        }
    }
    for candidate in answer["candidates"].as_array_mut().into_iter().flatten() {
        for term in candidate["evidence"].as_array_mut().into_iter().flatten() {
            for name in term["query_anchors"].as_array_mut().into_iter().flatten() {
                if let Some(place) = founded.iter().position(|anchor| *name == json!(anchor)) {
                    *name = json!(format!("inline-{place}"));
                }
            }
        }
    }
    // An inline keyframe has no name.
    answer["keyframe"] = Value::Null;
    answer
}

/// Asks about a keyframe before it is stored and after.
async fn check(what: &str, scene: &Scene, query: Keyframe, verdict: &str) {
    let inline = scene.post("/loop-queries", &json!({"inline": query.0})).await;
    let stored = scene.put("query", query).await;
    let founded: Vec<String> = list(&stored["detections"])
        .iter()
        .map(|outcome| match outcome["outcome"].as_str() {
            Some("created") => outcome["anchor"].as_str().unwrap_or_default().to_owned(),
            _ => String::new(),
        })
        .collect();
    let after = scene.ask("query").await;
    assert_eq!(after["verdict"], verdict, "{what}: {after:#}");
    assert_eq!(figures(inline, &founded), figures(after, &founded), "{what}");
}

const AHEAD: [f64; 3] = [0.0, 0.0, 2.0];

/// A passage with a door and a poster.
async fn passage() -> Scene {
    let scene = Scene::new().await;
    let sights = [door("901", AHEAD), thing("poster", NAMES[0]).at([3.0, 0.0, 0.0])];
    scene.put("old", keyframe().words(&[(1, 0.5), (2, 0.5)]).observes(1..=20).sees(sights)).await;
    scene
}

#[tokio::test]
async fn an_inline_keyframe_gets_the_answer_it_would_get_if_it_were_stored() {
    let query = |sights: Vec<Detection>| keyframe().words(&[(1, 0.25), (3, 0.75)]).sees(sights);
    let two = vec![unread([1.0, 1.0, 1.0]), door("901", [0.5, 0.0, 2.0])];
    check("a door, and one that nobody has read", &passage().await, query(two), "loop").await;
    check("another door", &passage().await, query(vec![door("910", AHEAD)]), "no_loop").await;
    let by_points = query(vec![thing("door_number", "901").on([101, 102])]).session("other-day");
    let points = by_points.points(&[(101, [-1.0, 0.0, 2.0]), (102, [1.0, 0.0, 2.0])]);
    check("map points of its own, of another session", &passage().await, points, "loop").await;
}

#[tokio::test]
async fn an_inline_query_changes_nothing() {
    let scene = passage().await;
    let state = async || {
        let places = ["", "/keyframes", "/anchors", "/keyframes/old/covisible"];
        let mut state = Vec::new();
        for place in places {
            state.push(scene.get(place).await);
        }
        state
    };
    let before = state().await;
    let query =
        keyframe().covisible(&["old"]).session("new").points(&[(1, AHEAD)]).sees([door("901", AHEAD)]);
    for verify in ["auto", "anchors", "geometry"] {
        scene.post("/loop-queries", &json!({"inline": query.0, "verify": verify})).await;
    }
    assert_eq!(state().await, before);
}

#[tokio::test]
async fn an_inline_keyframe_must_be_covisible_with_keyframes_that_exist() {
    let scene = passage().await;
    let body = json!({"inline": keyframe().covisible(&["nobody"]).0});
    let answer = scene.server.post(&scene.path("/loop-queries"), &body).await;
    assert_eq!(answer.status.as_u16(), 422);
    assert_eq!(answer.pointers(), ["/inline/covisible/0/keyframe"]);
}
