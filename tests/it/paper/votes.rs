//! M4: an anchor read several times is called what most of its readings say.

use serde_json::{Value, json};

use super::scene::{Keyframe, Scene, door, keyframe, list, thing};

const PLATE: [f64; 3] = [0.0, 0.0, 2.0];

/// A keyframe covisible with all before it, reading the plate.
fn reading(number: usize, text: &str, confidence: f64) -> Keyframe {
    let before: Vec<String> = (0..number).map(|number| format!("kf-{number}")).collect();
    let before: Vec<&str> = before.iter().map(String::as_str).collect();
    keyframe().covisible(&before).sees([door(text, PLATE).confidence(confidence)])
}

async fn read(readings: &[(&str, f64)]) -> Scene {
    let scene = Scene::new().await;
    for (number, (text, confidence)) in readings.iter().enumerate() {
        scene.put(&format!("kf-{number}"), reading(number, text, *confidence)).await;
    }
    scene
}

#[tokio::test]
async fn readings_vote_by_confidence_and_ties_go_to_the_newest() {
    let check = async |what: &str, readings: &[(&str, f64)], elected: &str, tallies: Value| {
        let anchors = read(readings).await.anchors().await;
        assert_eq!(anchors.len(), 1, "{what}");
        assert_eq!(anchors[0]["description"], elected, "{what}");
        assert_eq!(anchors[0]["readings"], tallies, "{what}");
    };
    check(
        "the heavier of two",
        &[("901", 0.5), ("907", 0.4)],
        "901",
        json!([{"text": "901", "weight": 0.5, "count": 1}, {"text": "907", "weight": 0.4, "count": 1}]),
    )
    .await;
    check(
        "two weak readings outweigh a strong one",
        &[("901", 0.5), ("907", 0.4), ("907", 0.2)],
        "907",
        json!([{"text": "907", "weight": 0.6, "count": 2}, {"text": "901", "weight": 0.5, "count": 1}]),
    )
    .await;
    check(
        "three weak readings do not outweigh a stronger one",
        &[("901", 0.9), ("907", 0.1), ("907", 0.2), ("907", 0.3)],
        "901",
        json!([{"text": "901", "weight": 0.9, "count": 1}, {"text": "907", "weight": 0.6, "count": 3}]),
    )
    .await;
    check(
        "a tie goes to the newest",
        &[("901", 0.5), ("907", 0.5)],
        "907",
        json!([{"text": "907", "weight": 0.5, "count": 1}, {"text": "901", "weight": 0.5, "count": 1}]),
    )
    .await;
    check(
        "a tie of sums goes to the one read last",
        &[("907", 0.25), ("901", 0.5), ("907", 0.25)],
        "907",
        json!([{"text": "907", "weight": 0.5, "count": 2}, {"text": "901", "weight": 0.5, "count": 1}]),
    )
    .await;
    check(
        "readings that differ in case alone are one",
        &[("Room 901", 0.3), ("room 901", 0.3), ("907", 0.5)],
        "room 901",
        json!([{"text": "room 901", "weight": 0.6, "count": 2}, {"text": "907", "weight": 0.5, "count": 1}]),
    )
    .await;
}

#[tokio::test]
async fn a_description_wins_over_a_text_and_no_reading_is_no_vote() {
    let scene = Scene::new().await;
    scene.put("kf-0", keyframe().sees([thing("door_number", "907").described("901").at(PLATE)])).await;
    scene.put("kf-1", reading(1, "", 1.0)).await;
    let anchor = scene.anchors().await.remove(0);
    assert_eq!(anchor["readings"], json!([{"text": "901", "weight": 1.0, "count": 1}]));
    assert_eq!(anchor["keyframes"], json!(["kf-0", "kf-1"]));
}

#[tokio::test]
async fn a_reading_that_says_nothing_outvotes_nobody() {
    let scene = read(&[("901", 0.1), ("unknown", 0.9), ("unknown", 0.9)]).await;
    assert_eq!(scene.anchors().await[0]["description"], "901");
}

#[tokio::test]
async fn a_description_by_hand_stands_whatever_is_read_and_can_be_taken_back() {
    let scene = read(&[("901", 1.0)]).await;
    let id = scene.anchors().await[0]["id"].as_str().expect("an id").to_owned();
    scene.describe(&id, "room 950").await;
    scene.put("kf-1", reading(1, "901", 1.0)).await;
    let anchor = scene.anchor(&id).await;
    assert_eq!(anchor["description"], "room 950");
    assert_eq!(anchor["readings"], json!([{"text": "901", "weight": 2.0, "count": 2}]));
    let path = scene.path(&format!("/anchors/{id}"));
    let request = scene.server.request(reqwest::Method::PATCH, &path).header("if-match", "*");
    crate::support::Answer::of(request.json(&json!({"description": null}))).await.expect(200);
    assert_eq!(scene.anchor(&id).await["description"], "901");
}

#[tokio::test]
async fn when_the_vote_turns_its_matches_are_withdrawn_and_judged_again() {
    let scene = Scene::with(json!({"reading_min_confidence": 0.25})).await;
    // Two other passages: room 901, and room 907.
    scene.put("at-901", keyframe().at([30.0, 0.0, 0.0]).sees([door("901", [30.0, 0.0, 2.0])])).await;
    scene.put("at-907", keyframe().at([60.0, 0.0, 0.0]).sees([door("907", [60.0, 0.0, 2.0])])).await;
    scene.put("kf-0", reading(0, "901", 0.5)).await;

    let matched = async || {
        let anchors = scene.anchors().await;
        let plate = anchors.last().expect("an anchor")["id"].clone();
        let back = |at: usize| list(&anchors[at]["matches"]).iter().any(|found| found["anchor"] == plate);
        assert_eq!(list(&anchors[2]["matches"]).len(), usize::from(back(0)) + usize::from(back(1)));
        (back(0), back(1))
    };
    let loops = async |query: &str| scene.ask(query).await["loops"].clone();
    assert_eq!(matched().await, (true, false));
    assert_eq!(loops("kf-0").await, json!(["at-901"]));

    // 0.25 + 0.375 against 0.5.
    scene.put("kf-1", reading(1, "907", 0.25)).await;
    assert_eq!(matched().await, (true, false));
    scene.put("kf-2", reading(2, "907", 0.375)).await;
    assert_eq!(matched().await, (false, true));
    assert_eq!(loops("kf-0").await, json!(["at-907"]));
}
