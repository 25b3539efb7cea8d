//! M50: a keyframe sent along with the query is judged as if it had just arrived, and is not stored.
//!
//! Cases that M50 leaves open are tested as the service documents it (`recognition/loops/anchor_map.rs`): sights of a known
//! anchor add nothing to what the map knows of it, the others stand for themselves.

use serde_json::{Value, json};

use super::scene::{
    Detection, Keyframe, NAMES, Scene, candidate_of, close_to, door, keyframe, list, thing, unread,
};

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
async fn an_inline_keyframe_gets_the_verdict_it_would_get_if_it_were_stored() {
    let query = |sights: Vec<Detection>| keyframe().words(&[(1, 0.25), (3, 0.75)]).sees(sights);
    check("the same door", &passage().await, query(vec![door("room 901", AHEAD)]), "loop").await;
    let two = vec![unread([1.0, 1.0, 1.0]), door("901", [0.5, 0.0, 2.0])];
    check("a door, and one that nobody has read", &passage().await, query(two), "loop").await;
    check("another door", &passage().await, query(vec![door("910", AHEAD)]), "no_loop").await;
    check("a door that nobody has read", &passage().await, query(vec![unread(AHEAD)]), "undecided").await;
    check("a sign", &passage().await, query(vec![door("exit", AHEAD)]), "undecided").await;
    check("nothing", &passage().await, query(vec![]), "undecided").await;
    check("no word in common", &passage().await, query(vec![door("901", AHEAD)]).words(&[(9, 1.0)]), "loop")
        .await;
    check("no word at all", &passage().await, query(vec![]).words(&[]), "undecided").await;
    check("shared map points", &passage().await, query(vec![door("901", AHEAD)]).observes(6..=20), "no_loop")
        .await;
    let by_points = || thing("door_number", "901").on([101, 102]);
    let points = query(vec![by_points()]).points(&[(101, [-1.0, 0.0, 2.0]), (102, [1.0, 0.0, 2.0])]);
    check("map points of its own", &passage().await, points.clone(), "loop").await;
    check("of another session", &passage().await, points.session("other-day"), "loop").await;
}

#[tokio::test]
async fn an_inline_keyframe_tracks_what_its_neighbours_saw() {
    let scene = passage().await;
    scene
        .put("new", keyframe().words(&[(1, 1.0)]).at([1.0, 0.0, 0.0]).sees([door("901", [1.0, 0.0, 2.0])]))
        .await;
    let sights = [door("901", [1.0, 0.0, 2.0]), door("Gauss", [9.0, 0.0, 2.0])];
    let query = keyframe().words(&[(1, 1.0)]).covisible(&["new"]).at([1.0, 0.0, 0.0]).sees(sights);
    check("tracked, and a new one", &scene, query, "loop").await;
}

#[tokio::test]
async fn an_inline_anchor_counts_itself_among_the_places_of_its_description() {
    let scene = Scene::with(json!({"description_min_information_level": 2})).await;
    let see = |x: f64| {
        keyframe()
            .at([x, 0.0, 0.0])
            .sees([thing("sign", "EXIT").at([x, 0.0, 2.0]), door("901", [x + 2.0, 0.0, 0.0])])
    };
    scene.put("old-1", see(0.0)).await;
    scene.put("old-2", see(10.0)).await;
    // M6: p counts the places of the anchor itself and of those it matches; stored, it would stand at a third.
    let sights = [thing("sign", "EXIT").at([20.0, 0.0, 2.0]), door("777", [22.0, 0.0, 0.0])];
    check("a third place", &scene, keyframe().at([20.0, 0.0, 0.0]).sees(sights), "no_loop").await;
}

#[tokio::test]
async fn an_inline_sight_adds_nothing_to_what_it_tracks_and_what_it_founds_stands_for_itself() {
    let scene = passage().await;
    let known = scene.put("new", keyframe().words(&[(9, 1.0)]).sees([door("901", AHEAD)])).await;
    // 0.5 m beside it, read otherwise: stored, it would move the anchor's box and take part in its vote. The other one
    // is too far for tracking.
    let sights = [door("950", [0.5, 0.0, 2.0]).confidence(0.9), door("room 902", [0.0, -0.75, 1.75])];
    let query = keyframe().covisible(&["new"]).sees(sights);
    let answer = scene.post("/loop-queries", &json!({"inline": query.0})).await;
    let found = candidate_of(&answer, "old").expect("it shares a word");
    assert_eq!(found["anchors"]["in_query"], 2);
    let pair = &found["anchors"]["matches"][0];
    assert_eq!(pair["query_anchor"], known["detections"][0]["anchor"]);
    close_to("angle", &pair["angle_difference_rad"], 0.0);
    close_to("weight", &pair["weight"], 1.0);
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
