//! M4: an anchor read several times is called what most of its readings say.

use revisit_core::Settings;

use super::scene::{Keyframe, Scene, Sign, close_to, door, ids, keyframe, thing};

const PLATE: [f64; 3] = [0.0, 0.0, 2.0];

/// A keyframe covisible with all before it, reading the plate.
fn reading(number: usize, text: &str, confidence: f64) -> Keyframe {
    let before: Vec<String> = (0..number).map(|number| format!("kf-{number}")).collect();
    let before: Vec<&str> = before.iter().map(String::as_str).collect();
    keyframe().covisible(&before).sees([door(text, PLATE).confidence(confidence)])
}

fn read(readings: &[(&str, f64)]) -> Scene {
    let mut scene = Scene::new();
    for (number, (text, confidence)) in readings.iter().enumerate() {
        scene.put(&format!("kf-{number}"), reading(number, text, *confidence));
    }
    scene
}

/// Text, weight and count of each reading, heaviest first.
type Tallies<'a> = &'a [(&'a str, f64, usize)];

#[track_caller]
fn has_readings(what: &str, anchor: &Sign, tallies: Tallies<'_>) {
    let readings = anchor.readings();
    assert_eq!(readings.len(), tallies.len(), "{what}: {readings:?}");
    for ((text, weight, count), expected) in readings.iter().zip(tallies) {
        assert_eq!((text.as_str(), *count), (expected.0, expected.2), "{what}: {readings:?}");
        close_to(what, *weight, expected.1);
    }
}

#[test]
fn readings_vote_by_confidence_and_ties_go_to_the_newest() {
    let check = |what: &str, readings: &[(&str, f64)], elected: &str, tallies: Tallies<'_>| {
        let anchors = read(readings).anchors();
        assert_eq!(anchors.len(), 1, "{what}");
        assert_eq!(anchors[0].description(), elected, "{what}");
        has_readings(what, &anchors[0], tallies);
    };
    check("the heavier of two", &[("901", 0.5), ("907", 0.4)], "901", &[("901", 0.5, 1), ("907", 0.4, 1)]);
    check(
        "two weak readings outweigh a strong one",
        &[("901", 0.5), ("907", 0.4), ("907", 0.2)],
        "907",
        &[("907", 0.6, 2), ("901", 0.5, 1)],
    );
    check(
        "three weak readings do not outweigh a stronger one",
        &[("901", 0.9), ("907", 0.1), ("907", 0.2), ("907", 0.3)],
        "901",
        &[("901", 0.9, 1), ("907", 0.6, 3)],
    );
    check(
        "a tie goes to the newest",
        &[("901", 0.5), ("907", 0.5)],
        "907",
        &[("907", 0.5, 1), ("901", 0.5, 1)],
    );
    check(
        "a tie of sums goes to the one read last",
        &[("907", 0.25), ("901", 0.5), ("907", 0.25)],
        "907",
        &[("907", 0.5, 2), ("901", 0.5, 1)],
    );
    check(
        "readings that differ in case alone are one",
        &[("Room 901", 0.3), ("room 901", 0.3), ("907", 0.5)],
        "room 901",
        &[("room 901", 0.6, 2), ("907", 0.5, 1)],
    );
}

#[test]
fn a_description_wins_over_a_text_and_no_reading_is_no_vote() {
    let mut scene = Scene::new();
    scene.put("kf-0", keyframe().sees([thing("door_number", "907").described("901").at(PLATE)]));
    scene.put("kf-1", reading(1, "", 1.0));
    let anchor = scene.anchors().remove(0);
    has_readings("described", &anchor, &[("901", 1.0, 1)]);
    assert_eq!(anchor.keyframes, ["kf-0", "kf-1"]);
}

#[test]
fn a_reading_that_says_nothing_outvotes_nobody() {
    let scene = read(&[("901", 0.1), ("unknown", 0.9), ("unknown", 0.9)]);
    assert_eq!(scene.anchors()[0].description(), "901");
}

#[test]
fn a_description_by_hand_stands_whatever_is_read_and_can_be_taken_back() {
    let mut scene = read(&[("901", 1.0)]);
    let id = scene.anchors()[0].id;
    scene.describe(id, Some("room 950"));
    scene.put("kf-1", reading(1, "901", 1.0));
    let anchor = scene.anchor(id);
    assert_eq!(anchor.description(), "room 950");
    has_readings("by hand", &anchor, &[("901", 2.0, 2)]);
    scene.describe(id, None);
    assert_eq!(scene.anchor(id).description(), "901");
}

#[test]
fn when_the_vote_turns_its_matches_are_withdrawn_and_judged_again() {
    let mut scene = Scene::with(Settings { reading_min_confidence: 0.25, ..Settings::default() });
    // Two other passages: room 901, and room 907.
    scene.put("at-901", keyframe().at([30.0, 0.0, 0.0]).sees([door("901", [30.0, 0.0, 2.0])]));
    scene.put("at-907", keyframe().at([60.0, 0.0, 0.0]).sees([door("907", [60.0, 0.0, 2.0])]));
    scene.put("kf-0", reading(0, "901", 0.5));

    let matched = |scene: &Scene| {
        let anchors = scene.anchors();
        let plate = anchors.last().expect("an anchor");
        let back = |at: usize| anchors[at].matches.iter().any(|found| found.anchor == plate.id);
        assert_eq!(anchors[2].matches.len(), usize::from(back(0)) + usize::from(back(1)));
        (back(0), back(1))
    };
    assert_eq!(matched(&scene), (true, false));
    assert_eq!(ids(&scene.ask("kf-0").loops), ["at-901"]);

    // 0.25 + 0.375 against 0.5.
    scene.put("kf-1", reading(1, "907", 0.25));
    assert_eq!(matched(&scene), (true, false));
    scene.put("kf-2", reading(2, "907", 0.375));
    assert_eq!(matched(&scene), (false, true));
    assert_eq!(ids(&scene.ask("kf-0").loops), ["at-907"]);
}
