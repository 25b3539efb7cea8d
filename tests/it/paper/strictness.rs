//! §V-B: `< pi/3`, `< 1 m` and `> 0.3` are strict, and the settings move them.

use std::f64::consts::{FRAC_PI_2, PI};

use serde_json::{Value, json};

use super::equation::compared;
use super::scene::{Detection, NAMES, close_to, door, thing, to_the_letter};

/// Do a door seen straight ahead at 2 m and one seen there match?
async fn matches(what: &str, settings: Value, there: [f64; 3], expected: bool) {
    let settings = to_the_letter(&settings);
    let found = compared(&settings, [door("901", [0.0, 0.0, 2.0])], [door("901", there)]).await;
    close_to(what, &found["anchors"]["similarity"], if expected { 1.0 } else { 0.0 });
    assert_eq!(found["verdict"], if expected { "loop" } else { "rejected" }, "{what}");
}

#[tokio::test]
async fn bearings_must_differ_by_less_than_the_angle() {
    let at = |degrees: f64| [2.0 * degrees.to_radians().sin(), 0.0, 2.0 * degrees.to_radians().cos()];
    matches("59.999 degrees", json!({}), at(59.999), true).await;
    matches("60.001 degrees", json!({}), at(60.001), false).await;
    matches("59.999 degrees to the left", json!({}), at(-59.999), true).await;
    matches("60.001 degrees to the left", json!({}), at(-60.001), false).await;
    // pi/3 itself is no number of a computer's, a right angle is as near as one: atan2(1, 0) is this pi/2 to the bit.
    let limit = |angle: f64| json!({"anchor_map_max_angle_difference_rad": angle});
    matches("exactly a right angle", limit(FRAC_PI_2), [2.0, 0.0, 0.0], false).await;
    matches("a right angle, and a hair allowed", limit(FRAC_PI_2 + 1e-9), [2.0, 0.0, 0.0], true).await;
    matches("exactly opposite", limit(PI), [0.0, 0.0, -2.0], false).await;
    matches("opposite, and all allowed", limit(4.0), [0.0, 0.0, -2.0], true).await;
    matches("nothing allowed", limit(0.0), [0.0, 0.0, 2.0], false).await;
}

#[tokio::test]
async fn distances_must_differ_by_less_than_a_metre() {
    matches("exactly 1 m more", json!({}), [0.0, 0.0, 3.0], false).await;
    matches("exactly 1 m less", json!({}), [0.0, 0.0, 1.0], false).await;
    matches("just less than 1 m more", json!({}), [0.0, 0.0, 2.999_999], true).await;
    matches("just less than 1 m less", json!({}), [0.0, 0.0, 1.000_001], true).await;
    let limit = |metres: f64| json!({"anchor_map_max_distance_difference_m": metres});
    matches("exactly another limit", limit(0.5), [0.0, 0.0, 2.5], false).await;
    matches("within another limit", limit(0.5), [0.0, 0.0, 2.25], true).await;
    matches("far, and far allowed", limit(20.0), [0.0, 0.0, 12.0], true).await;
    matches("nothing allowed", limit(0.0), [0.0, 0.0, 2.0], false).await;
}

#[tokio::test]
async fn s_must_exceed_its_threshold() {
    // Weights 2, 4, 2 against 1, 1, of which 2 and 1 match: 3 / 10, and 0.3 is not greater than 0.3.
    let query = || -> Vec<Detection> {
        vec![door("901", [0.0, 0.0, 0.5]), door(NAMES[0], [0.25, 0.0, 0.0]), door(NAMES[1], [0.0, 0.5, 0.0])]
    };
    let candidate = |more: &[Detection]| -> Vec<Detection> {
        let two = [door("901", [0.0, 0.0, 1.0]), thing("poster", NAMES[2]).at([-1.0, 0.0, 0.0])];
        two.into_iter().chain(more.iter().cloned()).collect()
    };
    let check = async |what: &str, threshold: f64, more: &[Detection], measured: f64, passes: bool| {
        let settings = to_the_letter(&json!({"anchor_map_min_similarity": threshold}));
        let found = compared(&settings, query(), candidate(more)).await;
        close_to(what, &found["anchors"]["similarity"], measured);
        close_to(what, &found["anchors"]["threshold"], threshold);
        if passes {
            assert_eq!(found["verdict"], "loop", "{what}");
            assert_eq!(found.get("reason"), None, "{what}");
        } else {
            assert_eq!(found["verdict"], "rejected", "{what}");
            assert_eq!(found["reason"]["code"], "score_below_threshold", "{what}");
            close_to(what, &found["reason"]["measured"], measured);
            close_to(what, &found["reason"]["limit"], threshold);
        }
    };
    check("exactly 0.3", 0.3, &[], 0.3, false).await;
    check("a lower threshold", 0.299_999, &[], 0.3, true).await;
    // One poster more, 10 m away: 3 / 10.1.
    let far = [thing("poster", NAMES[3]).at([0.0, -10.0, 0.0])];
    check("below it", 0.3, &far, 3.0 / 10.1, false).await;
    check("exactly 0", 0.0, &[], 0.3, true).await;
}

#[tokio::test]
async fn descriptions_must_reach_the_similarity_level_asked_for() {
    let check = async |what: &str, a: &str, b: &str, level: u32, similarity: f64| {
        close_to(what, &json!(similarity_of(a, b, level).await), similarity);
    };
    check("4 or 5 is at least 4", "B1-3", "B1-03", 4, 1.0).await;
    check("3 is not at least 4", "9O1", "901", 4, 0.0).await;
    check("3 is at least 3", "9O1", "901", 3, 1.0).await;
    check("a range of rooms, 3 is not at least 4", "901-905", "903", 4, 0.0).await;
    check("5 is at least 5", "901", "room 901", 5, 1.0).await;
    check("1 is never enough", "901", "910", 2, 0.0).await;
}

#[tokio::test]
async fn a_range_of_rooms_and_one_of_them_match_where_level_3_suffices() {
    // The golden pair 901-905 / 903 is of level 3.
    close_to("S", &json!(similarity_of("901-905", "903", 3).await), 1.0);
}

/// S of two plates at the same relative place, where this SimilarityLevel suffices.
async fn similarity_of(a: &str, b: &str, level: u32) -> f64 {
    let settings = to_the_letter(&json!({"matching_min_similarity_level": level}));
    let found = compared(&settings, [door(a, [0.0, 0.0, 2.0])], [door(b, [0.0, 0.0, 2.0])]).await;
    found["anchors"]["similarity"].as_f64().expect("S")
}
