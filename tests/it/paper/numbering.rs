//! M20: a map learns how its building writes its numbers; M26: a distance may be assumed; M17: company.

use serde_json::{Value, json};

use super::equation::compared;
use super::scene::{Keyframe, Scene, close_to, door, keyframe, thing};

/// So many plates that each is read by two keyframes of one drive, and nothing else of the map is near.
async fn building(scene: &Scene, plates: usize) {
    for pass in ["a", "b"] {
        let before = format!("plates-{pass}");
        let sights = (0..plates).map(|at| sign(&format!("7.{at:02}"), 100.0 + 5.0 * at as f64));
        scene.put(&before, keyframe().session("plates").words(&[(9, 1.0)]).sees(sights)).await;
    }
}

fn sign(text: &str, x: f64) -> super::scene::Detection {
    thing("sign", text).at([x, 0.0, 2.0])
}

#[tokio::test]
async fn ten_numbers_read_alike_in_two_keyframes_make_a_numbering() {
    let check = async |plates: usize, settings: Value, state: &str, numbering: Value| {
        let scene = Scene::with(settings).await;
        building(&scene, plates).await;
        scene.put("board", keyframe().session("boards").sees([sign("HUB04", 0.0)])).await;
        let board = scene.anchors().await.pop().unwrap_or_default();
        assert_eq!(
            (&board["state"], &board["numbering"]),
            (&json!(state), &numbering),
            "{plates} plates: {board:#}"
        );
    };
    check(9, json!({}), "valid", json!(null)).await;
    check(10, json!({}), "uninformative", json!(["#.99"])).await;
    check(10, json!({"learned_identifiers": false}), "valid", json!(null)).await;
    check(10, json!({"method": "paper"}), "valid", json!(null)).await;
    let given = |pattern: &str| json!({"identifier_patterns": [pattern]});
    check(0, given("[0-9]+[.][0-9]{2}"), "uninformative", json!(["[0-9]+[.][0-9]{2}"])).await;
    check(0, given("hub ?[0-9]+"), "valid", json!(["hub ?[0-9]+"])).await;
}

#[tokio::test]
async fn a_numbering_is_forgotten_with_what_it_was_learned_from() {
    let scene = Scene::new().await;
    building(&scene, 10).await;
    scene.put("board", keyframe().session("boards").sees([sign("HUB04", 0.0)])).await;
    let state = async || scene.anchors().await.pop().unwrap_or_default()["state"].clone();
    assert_eq!(state().await, "uninformative");
    scene.delete("/keyframes/plates-b").await;
    assert_eq!(state().await, "valid");
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

#[tokio::test]
async fn where_a_distance_was_assumed_the_angle_alone_gates_and_weighs() {
    let assumed = |sight: super::scene::Detection| {
        let mut sight = sight;
        sight.0["range"] = json!("assumed");
        sight
    };
    let near = || door("901", [0.0, 0.0, 2.0]);
    let far = || door("901", [0.0, 0.0, 5.0]);
    let measured = compared(&json!({}), vec![near()], vec![far()]).await;
    close_to("3 m apart", &measured["anchors"]["similarity"], 0.0);
    let guessed = compared(&json!({}), vec![assumed(near())], vec![assumed(far())]).await;
    close_to("guessed", &guessed["anchors"]["similarity"], 1.0);
    // Each weighs 1 instead of 1/2 and 1/5.
    close_to("its weight", &guessed["anchors"]["matches"][0]["weight"], 2.0);
    let aside = vec![assumed(door("901", [5.0, 0.0, 0.0]))];
    let turned = compared(&json!({}), vec![assumed(near())], aside).await;
    close_to("90 degrees aside", &turned["anchors"]["similarity"], 0.0);
}

/// A board 2 m ahead with a plaque a metre to its right, in a session of its own.
fn lobby(session: &str, plaque: &str) -> Keyframe {
    let board = thing("board", "HUB 04").at([0.0, 0.0, 2.0]);
    keyframe().session(session).sees([board, thing("plaque", plaque).at([1.0, 0.0, 2.0])])
}

#[tokio::test]
async fn a_board_beside_which_another_plaque_hangs_hangs_in_two_places() {
    let alone =
        |session: &str| keyframe().session(session).sees([thing("board", "HUB 04").at([0.0, 0.0, 2.0])]);
    let check = async |settings: Value, second: &str, verdict: &str, code: Value| {
        let scene = Scene::with(settings).await;
        scene.put("floor-4", lobby("four", "4")).await;
        scene.put("other", lobby("other", second)).await;
        // It sees the board alone, and so nothing that contradicts.
        scene.put("query", alone("third")).await;
        let found = scene.compare("query", "floor-4").await;
        assert_eq!((&found["verdict"], &found["reason"]["code"]), (&json!(verdict), &code), "{found:#}");
    };
    check(json!({}), "5", "undecided", json!("not_distinctive")).await;
    check(json!({}), "4", "loop", json!(null)).await;
    check(json!({"company": false}), "5", "loop", json!(null)).await;
}
