//! M7, contradictions: two different identifiers of one class at the same relative place, where no keyframe has features.
//! What geometry leaves of them is in `geometry.rs`.

use serde_json::{Value, json};

use super::scene::{Detection, Keyframe, NAMES, Scene, candidate_of, close_to, door, keyframe, list, thing};

const AHEAD: [f64; 3] = [0.0, 0.0, 1.0];

/// A passage: how often the plate ahead is read, and as what.
type Readings<'a> = &'a [&'a str];

/// Stores a passage; the first keyframe has its name, those that read the plate again are covisible with it.
async fn pass(scene: &Scene, name: &str, readings: Readings<'_>, more: &[Detection]) {
    for (number, text) in readings.iter().enumerate() {
        let plate = door(text, AHEAD);
        if number == 0 {
            scene.put(name, seeing([plate].into_iter().chain(more.iter().cloned()))).await;
        } else {
            scene.put(&format!("{name}-{number}"), seeing([plate]).covisible(&[name])).await;
        }
    }
}

fn seeing(sights: impl IntoIterator<Item = Detection>) -> Keyframe {
    keyframe().sees(sights)
}

/// Two passages compared.
async fn between(settings: Value, query: Readings<'_>, candidate: Readings<'_>) -> Value {
    let scene = Scene::with(settings).await;
    pass(&scene, "candidate", candidate, &[]).await;
    pass(&scene, "query", query, &[]).await;
    scene.compare("query", "candidate").await
}

#[track_caller]
fn is_contradicted(what: &str, found: &Value, named: [&str; 2]) {
    assert_eq!(found["verdict"], "rejected", "{what}: {found:#}");
    assert_eq!(found["reason"]["code"], "contradiction", "{what}");
    let contradictions = list(&found["anchors"]["contradictions"]);
    assert_eq!(contradictions.len(), 1, "{what}");
    for text in [&found["reason"]["detail"], &contradictions[0]["reason"]] {
        let text = text.as_str().unwrap_or_default();
        assert!(named.iter().all(|name| text.contains(name)), "{what}: {text:?} does not name {named:?}");
    }
}

#[track_caller]
fn only_does_not_match(what: &str, found: &Value) {
    assert_eq!(found["verdict"], "rejected", "{what}: {found:#}");
    assert_eq!(found["reason"]["code"], "score_below_threshold", "{what}");
    assert_eq!(found["anchors"]["contradictions"], json!([]), "{what}");
}

#[tokio::test]
async fn identifiers_that_differ_contradict_where_geometry_cannot_run_and_the_reason_names_both() {
    let check = async |what: &str, query: Readings<'_>, candidate: Readings<'_>, contradict: bool| {
        let found = between(json!({}), query, candidate).await;
        if contradict {
            is_contradicted(what, &found, [query[0], candidate[0]]);
        } else {
            only_does_not_match(what, &found);
        }
    };
    check("two characters differ, single readings", &["901"], &["910"], true).await;
    check("one character differs, single readings", &["3"], &["8"], true).await;
    check("each read alike twice", &["3", "3"], &["8", "8"], true).await;
    check("one of them read once", &["3", "3"], &["8"], true).await;
    check("each read twice, not alike", &["3", "unknown"], &["8", "8"], true).await;
    check("look-alikes are no conflict of the judge's", &["9O1", "9O1"], &["901", "901"], false).await;
    check("another role is no conflict", &["floor 9", "floor 9"], &["room 9", "room 9"], false).await;
    check("names are no identifiers", &["Turing", "Turing"], &["Curie", "Curie"], false).await;
}

#[tokio::test]
async fn the_veto_can_be_turned_off() {
    only_does_not_match("off", &between(json!({"contradiction_veto": false}), &["901"], &["910"]).await);
}

#[tokio::test]
async fn only_anchors_of_one_class_at_the_same_relative_place_contradict() {
    let check = async |what: &str, there: Detection, contradict: bool| {
        let scene = Scene::new().await;
        scene.put("candidate", seeing([there])).await;
        scene.put("query", seeing([door("901", AHEAD)])).await;
        let found = scene.compare("query", "candidate").await;
        if contradict {
            is_contradicted(what, &found, ["901", "910"]);
        } else {
            only_does_not_match(what, &found);
        }
    };
    check("the same place", door("910", AHEAD), true).await;
    check("another class", thing("shelf", "910").at(AHEAD), false).await;
    check("1 m farther", door("910", [0.0, 0.0, 2.0]), false).await;
    check("less than 1 m farther", door("910", [0.0, 0.0, 1.9]), true).await;
    check("61 degrees to the right", door("910", [0.8746, 0.0, 0.4848]), false).await;
    check("59 degrees to the right", door("910", [0.8572, 0.0, 0.5150]), true).await;
}

#[tokio::test]
async fn what_contradicts_must_outweigh_what_agrees() {
    // 901 against 910 a metre ahead: 1 + 1. Room 905 on the right, at some distance, agrees.
    let check = async |what: &str, distance_m: f64, contradicted: bool| {
        let agreeing = [door("905", [distance_m, 0.0, 0.0])];
        let scene = Scene::with(json!({"company": false})).await;
        pass(&scene, "candidate", &["910"], &agreeing).await;
        pass(&scene, "query", &["901"], &agreeing).await;
        let found = scene.compare("query", "candidate").await;
        close_to(what, &found["anchors"]["contradictions"][0]["weight"], 2.0);
        close_to(what, &found["anchors"]["matches"][0]["weight"], 2.0 / distance_m);
        if contradicted {
            is_contradicted(what, &found, ["901", "910"]);
            close_to(what, &found["reason"]["measured"], 2.0);
            close_to(what, &found["reason"]["limit"], 2.0 / distance_m);
        } else {
            assert_eq!(found["verdict"], "loop", "{what}: {found:#}");
        }
    };
    check("2 against 1", 2.0, true).await;
    check("2 against 2 does not exceed", 1.0, false).await;
    check("2 against 4", 0.5, false).await;
}

#[tokio::test]
async fn a_plate_known_on_the_other_side_contradicts_nothing() {
    // 901 is ahead in one map and behind the camera in the other: another point of view, not another room.
    let scene = Scene::new().await;
    pass(&scene, "candidate", &["910"], &[door("901", [0.0, 0.0, -5.0])]).await;
    pass(&scene, "query", &["901"], &[]).await;
    only_does_not_match("901 hangs behind", &scene.compare("query", "candidate").await);
}

#[tokio::test]
async fn an_anchor_contradicts_one_other_at_most() {
    let scene = Scene::new().await;
    // Both within reach of 901; 920 weighs 1/1.5, 910 weighs 1.
    pass(&scene, "candidate", &["910"], &[door("920", [1.2, 0.0, 0.9])]).await;
    pass(&scene, "query", &["901"], &[]).await;
    let found = scene.compare("query", "candidate").await;
    is_contradicted("the heavier pair", &found, ["901", "910"]);
    close_to("weight", &found["anchors"]["contradictions"][0]["weight"], 2.0);
}

#[tokio::test]
async fn contradicting_weights_are_distinctive_too() {
    // 910 hangs at 2 places, 901 at one: 1 + 1/2. What agrees weighs 0.8 + 0.8: it outweighs.
    let scene = Scene::with(json!({"single_text_needs_witness": false, "company": false})).await;
    let agreeing = [thing("poster", NAMES[0]).at([1.25, 0.0, 0.0])];
    pass(&scene, "candidate", &["910"], &agreeing).await;
    pass(&scene, "query", &["901"], &agreeing).await;
    let other = keyframe().at([50.0, 0.0, 0.0]).words(&[(99, 1.0)]).sees([door("910", [50.0, 0.0, 1.0])]);
    let before = scene.compare("query", "candidate").await;
    is_contradicted("2 against 1.6", &before, ["901", "910"]);
    scene.put("elsewhere", other).await;
    let answer = scene.ask("query").await;
    let found = candidate_of(&answer, "candidate").expect("it has the query's words");
    close_to("weight", &found["anchors"]["contradictions"][0]["weight"], 1.5);
    assert_eq!(found["verdict"], "loop", "{found:#}");
}
