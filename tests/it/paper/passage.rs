//! M10 and M21: what one passage says once is no return, and what one unsure detection read is no text.

use serde_json::{Value, json};

use super::scene::{Scene, close_to, door, keyframe};

const PLATE: [f64; 3] = [0.0, 0.0, 3.0];

/// Three keyframes of one drive, each covisible with the one before; all at these x, the second seeing the plate or not.
async fn drive(settings: Value, xs: [f64; 3], seen_between: bool) -> Value {
    let scene = Scene::with(settings).await;
    let plate = || vec![door("901", PLATE)];
    let at = |x: f64| keyframe().at([x, 0.0, 0.0]);
    scene.put("first", at(xs[0]).sees(plate())).await;
    let between = if seen_between { plate() } else { vec![] };
    scene.put("second", at(xs[1]).covisible(&["first"]).sees(between)).await;
    scene.put("third", at(xs[2]).covisible(&["second"]).sees(plate())).await;
    scene.compare("third", "first").await
}

#[tokio::test]
async fn a_plate_that_was_tracked_in_one_drive_is_no_loop() {
    let check = async |what: &str, settings: Value, xs: [f64; 3], seen: bool, verdict: &str, code: Value| {
        let found = drive(settings, xs, seen).await;
        close_to(what, &found["anchors"]["similarity"], 1.0);
        assert_eq!(
            (&found["verdict"], &found["reason"]["code"]),
            (&json!(verdict), &code),
            "{what}: {found:#}"
        );
    };
    let tracked = || json!("tracked_only");
    check("past the plate", json!({}), [0.0, 0.5, 1.0], true, "undecided", tracked()).await;
    let off = json!({"tracked_loops_need_geometry": false});
    check("turned off", off, [0.0, 0.5, 1.0], true, "loop", json!(null)).await;
    // 1.5 m and 1.5 m: between two sightings no more than 3 m, however far in all.
    check("from sighting to sighting", json!({}), [-1.5, 0.0, 1.5], true, "undecided", tracked()).await;
    check(
        "3 m at most",
        json!({"distinctive_place_radius_m": 1.4}),
        [-1.5, 0.0, 1.5],
        true,
        "loop",
        json!(null),
    )
    .await;
    // 3.5 m ahead and 3 m back, out of sight: another passage, and another anchor.
    check("gone and come back", json!({}), [0.0, 3.5, 0.5], false, "loop", json!(null)).await;
}

#[tokio::test]
async fn an_unsure_reading_tells_nothing_until_the_anchor_is_read_alike_again() {
    let state = async |settings: Value, readings: &[(&str, f64)]| {
        let scene = Scene::with(settings).await;
        for (number, (text, confidence)) in readings.iter().enumerate() {
            let covisible: Vec<String> = (0..number).map(|before| format!("kf-{before}")).collect();
            let covisible: Vec<&str> = covisible.iter().map(String::as_str).collect();
            let sight = door(text, PLATE).confidence(*confidence);
            scene.put(&format!("kf-{number}"), keyframe().covisible(&covisible).sees([sight])).await;
        }
        scene.anchors().await[0]["state"].as_str().unwrap_or_default().to_owned()
    };
    assert_eq!(state(json!({}), &[("901", 0.79)]).await, "uninformative");
    assert_eq!(state(json!({}), &[("901", 0.8)]).await, "valid");
    assert_eq!(state(json!({}), &[("901", 0.6), ("901", 0.5)]).await, "valid", "read alike again");
    assert_eq!(state(json!({}), &[("901", 0.6), ("907", 0.5)]).await, "uninformative", "read otherwise");
    assert_eq!(
        state(json!({}), &[("a sailing boat before a windmill", 0.5)]).await,
        "valid",
        "words of a wall"
    );
    assert_eq!(state(json!({"reading_min_confidence": 0}), &[("901", 0.1)]).await, "valid", "off");
}
