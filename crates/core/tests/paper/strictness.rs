//! §V-B: `< pi/3`, `< 1 m` and `> 0.3` are strict, and the settings move them.

use std::f64::consts::{FRAC_PI_2, PI};

use revisit_core::{CandidateDecision, ReasonCode, Settings};

use super::equation::compared;
use super::scene::{NAMES, Thing, anchors, close_to, code, door, reason, thing, to_the_letter, told};

/// Do a door seen straight ahead at 2 m and one seen there match?
fn matches(what: &str, settings: &Settings, there: [f64; 3], expected: bool) {
    let found = compared(settings, [door("901", [0.0, 0.0, 2.0])], [door("901", there)]);
    close_to(what, anchors(&found).similarity, if expected { 1.0 } else { 0.0 });
    let decision = if expected { CandidateDecision::Loop } else { CandidateDecision::Rejected };
    assert_eq!(found.decision, decision, "{what}");
}

#[test]
fn bearings_must_differ_by_less_than_the_angle() {
    let at = |degrees: f64| [2.0 * degrees.to_radians().sin(), 0.0, 2.0 * degrees.to_radians().cos()];
    let letter = &to_the_letter();
    matches("59.999 degrees", letter, at(59.999), true);
    matches("60.001 degrees", letter, at(60.001), false);
    matches("59.999 degrees to the left", letter, at(-59.999), true);
    matches("60.001 degrees to the left", letter, at(-60.001), false);
    // pi/3 itself is no number of a computer's, a right angle is as near as one: atan2(1, 0) is this pi/2 to the bit.
    let within = |what: &str, angle: f64, there: [f64; 3], expected: bool| {
        let settings = Settings { anchor_map_max_angle_difference_rad: angle, ..to_the_letter() };
        matches(what, &settings, there, expected);
    };
    within("exactly a right angle", FRAC_PI_2, [2.0, 0.0, 0.0], false);
    within("a right angle, and a hair allowed", FRAC_PI_2 + 1e-9, [2.0, 0.0, 0.0], true);
    within("exactly opposite", PI, [0.0, 0.0, -2.0], false);
    within("opposite, and all allowed", 4.0, [0.0, 0.0, -2.0], true);
    within("nothing allowed", 0.0, [0.0, 0.0, 2.0], false);
}

#[test]
fn distances_must_differ_by_less_than_a_metre() {
    let letter = &to_the_letter();
    matches("exactly 1 m more", letter, [0.0, 0.0, 3.0], false);
    matches("exactly 1 m less", letter, [0.0, 0.0, 1.0], false);
    matches("just less than 1 m more", letter, [0.0, 0.0, 2.999_999], true);
    matches("just less than 1 m less", letter, [0.0, 0.0, 1.000_001], true);
    let within = |what: &str, metres: f64, there: [f64; 3], expected: bool| {
        let settings = Settings { anchor_map_max_distance_difference_m: metres, ..to_the_letter() };
        matches(what, &settings, there, expected);
    };
    within("exactly another limit", 0.5, [0.0, 0.0, 2.5], false);
    within("within another limit", 0.5, [0.0, 0.0, 2.25], true);
    within("far, and far allowed", 20.0, [0.0, 0.0, 12.0], true);
    within("nothing allowed", 0.0, [0.0, 0.0, 2.0], false);
}

#[test]
fn s_must_exceed_its_threshold() {
    // Weights 2, 4, 2 against 1, 1, of which 2 and 1 match: 3 / 10, and 0.3 is not greater than 0.3.
    let query = || -> Vec<Thing> {
        vec![door("901", [0.0, 0.0, 0.5]), door(NAMES[0], [0.25, 0.0, 0.0]), door(NAMES[1], [0.0, 0.5, 0.0])]
    };
    let candidate = |more: &[Thing]| -> Vec<Thing> {
        let two = [door("901", [0.0, 0.0, 1.0]), thing("poster", NAMES[2]).at([-1.0, 0.0, 0.0])];
        two.into_iter().chain(more.iter().cloned()).collect()
    };
    let check = |what: &str, threshold: f64, more: &[Thing], measured: f64, passes: bool| {
        let settings = Settings { anchor_map_min_similarity: threshold, ..to_the_letter() };
        let found = compared(&settings, query(), candidate(more));
        close_to(what, anchors(&found).similarity, measured);
        close_to(what, anchors(&found).threshold, threshold);
        if passes {
            assert_eq!(found.decision, CandidateDecision::Loop, "{what}");
            assert_eq!(found.reason, None, "{what}");
        } else {
            assert_eq!(found.decision, CandidateDecision::Rejected, "{what}");
            assert_eq!(code(&found), Some(ReasonCode::ScoreBelowThreshold), "{what}");
            told(what, reason(&found).measured, measured);
            told(what, reason(&found).limit, threshold);
        }
    };
    check("exactly 0.3", 0.3, &[], 0.3, false);
    check("a lower threshold", 0.299_999, &[], 0.3, true);
    // One poster more, 10 m away: 3 / 10.1.
    let far = [thing("poster", NAMES[3]).at([0.0, -10.0, 0.0])];
    check("below it", 0.3, &far, 3.0 / 10.1, false);
    check("exactly 0", 0.0, &[], 0.3, true);
}

#[test]
fn descriptions_must_reach_the_similarity_level_asked_for() {
    let check = |what: &str, a: &str, b: &str, level: u32, similarity: f64| {
        close_to(what, similarity_of(a, b, level), similarity);
    };
    check("4 or 5 is at least 4", "B1-3", "B1-03", 4, 1.0);
    check("3 is not at least 4", "9O1", "901", 4, 0.0);
    check("3 is at least 3", "9O1", "901", 3, 1.0);
    check("a name that lacks a part, 3 is not at least 4", "HUB 10", "10", 4, 0.0);
    check("5 is at least 5", "901", "room 901", 5, 1.0);
    check("1 is never enough", "901", "910", 2, 0.0);
}

#[test]
fn a_name_and_one_that_lacks_a_part_match_where_level_3_suffices() {
    close_to("S", similarity_of("HUB 10", "10", 3), 1.0);
}

/// S of two plates at the same relative place, where this SimilarityLevel suffices.
fn similarity_of(a: &str, b: &str, level: u32) -> f64 {
    let settings = Settings { matching_min_similarity_level: level, ..to_the_letter() };
    let found = compared(&settings, [door(a, [0.0, 0.0, 2.0])], [door(b, [0.0, 0.0, 2.0])]);
    anchors(&found).similarity
}
