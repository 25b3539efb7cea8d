//! §IV-B: what an anchor knows, and when its description makes it valid.

use serde_json::json;

use super::scene::{Scene, close_to_all, door, keyframe, texts, thing, unread};

#[tokio::test]
async fn a_description_of_information_level_4_makes_a_valid_anchor_and_a_setting_moves_the_bar_at_once() {
    // (text, its level, its state at the bars 4 (the paper's), 2 and 5)
    let table = [
        ("", 1, ["pending", "pending", "pending"]),
        ("unknown", 1, ["uninformative", "uninformative", "uninformative"]),
        ("exit", 2, ["uninformative", "valid", "uninformative"]),
        ("brown door", 3, ["uninformative", "valid", "uninformative"]),
        ("901", 4, ["valid", "valid", "uninformative"]),
        ("Mona Lisa", 4, ["valid", "valid", "uninformative"]),
        ("room 902", 5, ["valid", "valid", "valid"]),
    ];
    let scene = Scene::new().await;
    let sights = table.iter().zip(0..).map(|((text, ..), n)| door(text, [f64::from(n) * 5.0, 0.0, 2.0]));
    let answer = scene.put("kf-1", keyframe().sees(sights)).await;
    assert_eq!(texts(&answer["detections"], "state"), table.map(|(_, _, [state, ..])| state));
    assert_eq!(texts(&answer["detections"], "outcome"), ["created"; 7]);
    for (column, bar) in [4, 2, 5].into_iter().enumerate() {
        scene.set(json!({"description_min_information_level": bar})).await;
        let anchors = scene.anchors().await;
        for ((text, level, states), anchor) in table.iter().zip(&anchors) {
            assert_eq!(anchor["state"], states[column], "{text:?} at {bar}");
            assert_eq!(anchor["information_level"], *level, "{text:?}");
        }
        let valid = states_like(&scene, "valid").await;
        assert_eq!(
            valid,
            table.iter().filter(|(_, _, states)| states[column] == "valid").count(),
            "at {bar}"
        );
    }
}

async fn states_like(scene: &Scene, state: &str) -> usize {
    let found = scene.get(&format!("/anchors?state={state}")).await;
    found["items"].as_array().expect("a list").len()
}

#[tokio::test]
async fn a_sign_becomes_evidence_when_the_bar_comes_down() {
    let scene = Scene::with(json!({"single_text_needs_witness": false})).await;
    for id in ["kf-1", "kf-9"] {
        scene.put(id, keyframe().sees([door("EXIT", [0.0, 0.0, 1.0])])).await;
    }
    let figures = async || {
        let candidate = scene.compare("kf-9", "kf-1").await;
        (
            candidate["verdict"].clone(),
            candidate["reason"]["code"].clone(),
            candidate["anchors"]["in_query"].clone(),
        )
    };
    assert_eq!(figures().await, (json!("undecided"), json!("no_anchors"), json!(0)));
    scene.set(json!({"description_min_information_level": 2})).await;
    assert_eq!(figures().await, (json!("loop"), json!(null), json!(1)));
}

#[tokio::test]
async fn an_anchor_has_its_class_keyframes_map_points_box_and_description() {
    let scene = Scene::new().await;
    let corners = [(1, [0.0, 0.0, 2.0]), (2, [1.0, 0.0, 2.0]), (3, [0.5, 1.0, 2.0])];
    let seen = scene
        .put("kf-1", keyframe().points(&corners).sees([thing("door_number", "Room 901").on([1, 2, 3])]))
        .await;
    let more = keyframe().covisible(&["kf-1"]).points(&[(4, [0.5, 0.5, 3.0])]);
    // 2 of 3 points are covered: more than 0.2.
    let again = scene.put("kf-2", more.sees([thing("door_number", "Room 901").on([2, 3, 4])])).await;
    let id = seen["detections"][0]["anchor"].as_str().expect("an anchor");
    assert_eq!(again["detections"][0], json!({"anchor": id, "outcome": "observed", "state": "valid"}));

    let anchor = scene.anchor(id).await;
    assert_eq!(anchor["class"], "door_number");
    assert_eq!(anchor["keyframes"], json!(["kf-1", "kf-2"]));
    assert_eq!(anchor["map_points"], 4);
    close_to_all("min", &anchor["box"]["min"], [0.0, 0.0, 2.0]);
    close_to_all("max", &anchor["box"]["max"], [1.0, 1.0, 3.0]);
    close_to_all("center", &anchor["center"], [0.5, 0.5, 2.5]);
    assert_eq!(anchor["description"], "Room 901");
    assert_eq!(anchor["identifiers"], json!(["901"]));
}

#[tokio::test]
async fn what_is_of_no_class_of_the_map_or_nowhere_makes_no_anchor() {
    let scene = Scene::of(json!({"anchor_classes": ["door_number"]})).await;
    let sights = [
        thing("chair", "901").at([0.0, 0.0, 2.0]),
        thing("door_number", "901"),
        unread([0.0, 0.0, 2.0]),
        thing("door_number", "902").on([77]),
    ];
    let answer = scene.put("kf-1", keyframe().sees(sights)).await;
    // A map point that is not triangulated yet is a place still to come.
    assert_eq!(texts(&answer["detections"], "outcome"), ["ignored", "ignored", "created", "created"]);
    let reasons = texts(&answer["detections"], "reason");
    assert!(reasons[..2].iter().all(|reason| !reason.is_empty()), "{answer:#}");
    assert_eq!(scene.anchors().await.len(), 2);
}
