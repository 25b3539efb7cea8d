//! §IV-C.2, semantic anchor matching: merged where covisible and close, else a revisit (M5).

use serde_json::{Value, json};

use super::scene::{Detection, Keyframe, Scene, close_to_all, door, keyframe, list, texts, thing};

/// What became of two anchors.
#[derive(Debug, PartialEq)]
enum Became {
    /// One anchor.
    One,
    /// Two that match, in this way.
    Two(&'static str),
    /// Two that do not match.
    Strangers,
}

/// Looks at the first two anchors of a map from both sides.
async fn became(scene: &Scene) -> Became {
    let anchors = scene.anchors().await;
    if anchors.len() == 1 {
        return Became::One;
    }
    let kind_of = |anchor: &Value, other: &Value| -> Option<String> {
        let matches = list(&anchor["matches"]);
        let found = matches.iter().find(|found| found["anchor"] == other["id"])?;
        assert!(!found["reason"].as_str().unwrap_or_default().is_empty(), "{found}");
        Some(found["kind"].as_str().expect("a kind").to_owned())
    };
    let [there, back] = [kind_of(&anchors[0], &anchors[1]), kind_of(&anchors[1], &anchors[0])];
    assert_eq!(there, back, "a match goes both ways");
    match there.as_deref() {
        Some("covisible") => Became::Two("covisible"),
        Some("revisit") => Became::Two("revisit"),
        _ => Became::Strangers,
    }
}

/// A plate over the square from (0,0,2) to (1,1,2).
fn first(plate: Detection) -> Keyframe {
    keyframe().points(&[(1, [0.0, 0.0, 2.0]), (2, [1.0, 1.0, 2.0])]).sees([plate.on([1, 2])])
}

/// A plate over the square from (1,1,2) to (2,2,2): it touches the first in one corner, and that is one of its six
/// points, too few to be the same by tracking.
fn second(plate: Detection) -> Keyframe {
    let positions = [[1.0, 1.0], [2.0, 1.0], [1.5, 1.0], [1.5, 2.0], [2.0, 2.0], [1.5, 1.5]];
    let points: Vec<(i64, [f64; 3])> = (11..).zip(positions.map(|[x, y]| [x, y, 2.0])).collect();
    keyframe().points(&points).sees([plate.on(11..17)])
}

/// What becomes of two plates that touch.
async fn met(a: &str, b: &str, settings: &Value, covisible: bool) -> Became {
    let scene = Scene::with(settings.clone()).await;
    scene.put("kf-1", first(thing("door_number", a))).await;
    let again = second(thing("door_number", b));
    let answer = scene.put("kf-2", if covisible { again.covisible(&["kf-1"]) } else { again }).await;
    assert_eq!(answer["detections"][0]["outcome"], "created");
    became(&scene).await
}

#[tokio::test]
async fn a_range_of_rooms_and_one_of_them_are_the_same_where_level_3_suffices() {
    // The golden pair 901-905 / 903 is of level 3.
    let three = json!({"matching_min_similarity_level": 3});
    assert_eq!(met("901-905", "903", &three, false).await, Became::Two("revisit"));
    assert_eq!(met("901-905", "903", &three, true).await, Became::One);
}

#[tokio::test]
async fn anchors_that_say_the_same_merge_if_covisible_and_are_a_revisit_if_not() {
    let check = async |a: &str, b: &str, settings: Value, covisible: bool, expected: Became| {
        assert_eq!(
            met(a, b, &settings, covisible).await,
            expected,
            "{a} / {b}, covisible: {covisible}, {settings}"
        );
    };
    // SimilarityLevel 5, 5, 4 or 5, 3 and 1 by the golden pairs; 4 is asked for.
    for (a, b, alike) in [
        ("901", "901", true),
        ("901", "room 901", true),
        ("B1-3", "B1-03", true),
        ("9O1", "901", false),
        ("901-905", "903", false),
        ("901", "910", false),
    ] {
        let (covisible, apart) = if alike {
            (Became::One, Became::Two("revisit"))
        } else {
            (Became::Strangers, Became::Strangers)
        };
        check(a, b, json!({}), true, covisible).await;
        check(a, b, json!({}), false, apart).await;
    }
    let three = || json!({"matching_min_similarity_level": 3});
    check("9O1", "901", three(), true, Became::One).await;
    check("9O1", "901", three(), false, Became::Two("revisit")).await;
    check("901", "901", json!({"matching_min_similarity_level": 5}), true, Became::One).await;
}

#[tokio::test]
async fn covisible_anchors_with_one_number_merge_wherever_their_distance_was_guessed() {
    let check = async |text: &str, range: &str, expected: Became| {
        let scene = Scene::new().await;
        for (id, covisible, far_m) in [("kf-1", &[][..], 2.0), ("kf-2", &["kf-1"], 7.0)] {
            let mut plate = door(text, [0.0, 0.0, far_m]);
            plate.0["range"] = json!(range);
            scene.put(id, keyframe().covisible(covisible).sees([plate])).await;
        }
        assert_eq!(became(&scene).await, expected, "{text}, {range}");
    };
    check("901", "assumed", Became::One).await;
    check("901", "measured", Became::Two("covisible")).await;
    check("a sailing boat before a windmill", "assumed", Became::Two("covisible")).await;
}

#[tokio::test]
async fn only_anchors_of_one_class_match() {
    for covisible in [&["kf-1"][..], &[]] {
        let scene = Scene::new().await;
        scene.put("kf-1", first(thing("door_number", "901"))).await;
        scene.put("kf-2", second(thing("shelf", "901")).covisible(covisible)).await;
        assert_eq!(became(&scene).await, Became::Strangers);
    }
}

#[tokio::test]
async fn covisible_anchors_that_match_merge_if_their_boxes_touch_or_their_centres_are_within_the_radius() {
    let check = async |what: &str, settings: Value, x: f64, expected: Became| {
        let scene = Scene::with(settings).await;
        // Two sights of one keyframe cannot feed one anchor; two of the same text can be the same thing.
        scene.put("kf-1", keyframe().sees([door("901", [0.0, 0.0, 2.0]), door("901", [x, 0.0, 2.0])])).await;
        assert_eq!(became(&scene).await, expected, "{what}");
    };
    check("at the radius", json!({}), 0.75, Became::One).await;
    check("beyond it", json!({}), 0.76, Became::Two("covisible")).await;
    check("another radius", json!({"association_position_radius_m": 2.0}), 1.9, Became::One).await;
    check(
        "the same point is touched by both boxes",
        json!({"association_position_radius_m": 0.0}),
        0.0,
        Became::One,
    )
    .await;
    check("no radius", json!({"association_position_radius_m": 0.0}), 0.01, Became::Two("covisible")).await;
}

#[tokio::test]
async fn a_merged_anchor_has_the_keyframes_the_points_and_the_readings_of_both_and_a_new_box() {
    let scene = Scene::with(json!({"reading_min_confidence": 0.5})).await;
    let stored = scene.put("kf-1", first(thing("door_number", "room 901").confidence(0.5))).await;
    let older = stored["detections"][0]["anchor"].clone();
    let again = second(thing("door_number", "901").confidence(0.75)).covisible(&["kf-1"]);
    scene.put("kf-2", again).await;
    let anchor = scene.anchors().await.remove(0);
    assert_eq!(anchor["keyframes"], json!(["kf-1", "kf-2"]));
    assert_eq!(anchor["map_points"], 8);
    close_to_all("min", &anchor["box"]["min"], [0.0, 0.0, 2.0]);
    close_to_all("max", &anchor["box"]["max"], [2.0, 2.0, 2.0]);
    close_to_all("center", &anchor["center"], [1.0, 1.0, 2.0]);
    // The vote over all readings: 0.75 against 0.5.
    assert_eq!(anchor["description"], "901");
    let readings =
        json!([{"text": "901", "weight": 0.75, "count": 1}, {"text": "room 901", "weight": 0.5, "count": 1}]);
    assert_eq!(anchor["readings"], readings);
    assert_eq!(anchor["matches"], json!([]));

    assert_eq!(anchor["id"], older, "the older anchor's name stands");
    let newer = anchor["merged_from"][0].as_str().expect("an id").to_owned();
    assert_eq!(scene.anchor(&newer).await["merged_into"], older);
    let merged = scene.events_until("anchors_merged", 1).await.pop().expect("an event");
    assert_eq!([&merged["anchor"], &merged["other"]], [&anchor["id"], &json!(newer)]);
}

#[tokio::test]
async fn what_is_merged_goes_on_merging() {
    let scene = Scene::new().await;
    let plates = [0.0, 0.8, 0.4].map(|x| door("901", [x, 0.0, 2.0]));
    scene.put("kf-1", keyframe().sees(plates)).await;
    // The outer two are 0.8 apart; with the one between, either is a box whose centre is 0.6 from the other.
    assert_eq!(scene.anchors().await.len(), 1);
}

#[tokio::test]
async fn an_anchor_seen_again_elsewhere_matches_all_its_earlier_selves() {
    let scene = Scene::new().await;
    for (id, x) in [("kf-1", 0.0), ("kf-5", 30.0), ("kf-9", 60.0)] {
        scene.put(id, keyframe().at([x, 0.0, 0.0]).sees([door("901", [x, 0.0, 2.0])])).await;
    }
    let anchors = scene.anchors().await;
    for anchor in &anchors {
        let others: Vec<&Value> =
            anchors.iter().map(|other| &other["id"]).filter(|id| **id != anchor["id"]).collect();
        assert_eq!(list(&anchor["matches"]).iter().map(|found| &found["anchor"]).collect::<Vec<_>>(), others);
        assert_eq!(texts(&anchor["matches"], "kind"), ["revisit"; 2]);
        assert_eq!(texts(&anchor["matches"], "source"), ["identical"; 2]);
        assert!(list(&anchor["matches"]).iter().all(|found| found["level"] == 5));
    }
}

#[tokio::test]
async fn one_covisible_pair_of_keyframes_makes_two_matching_anchors_covisible() {
    // §IV-C.2 asks whether "their keyframes share a co-visibility relationship": that of any two of them.
    let scene = Scene::new().await;
    scene.put("kf-1", keyframe().sees([door("901", [0.0, 0.0, 2.0])])).await;
    scene.put("kf-2", keyframe().sees([door("901", [9.0, 0.0, 2.0])])).await;
    assert_eq!(became(&scene).await, Became::Two("revisit"));
    // It sees the second anchor, and is covisible with a keyframe that sees the first.
    let bridge = keyframe().covisible(&["kf-1", "kf-2"]).sees([door("901", [9.0, 0.0, 2.0])]);
    assert_eq!(scene.put("kf-3", bridge).await["detections"][0]["outcome"], "observed");
    assert_eq!(became(&scene).await, Became::Two("covisible"));
}
