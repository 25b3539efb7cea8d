//! §V-B, Eq. (1) and (2): the paper's reading to the letter, and one-to-one.

use revisit_core::domain::method::Method;
use revisit_core::domain::verdict::AnchorName;
use revisit_core::{Candidate, CandidateDecision, Settings};

use super::scene::{NAMES, Scene, Thing, anchors, close_to, door, keyframe, thing, to_the_letter, unread};

/// What the query says of the candidate, each seeing these things from the origin.
pub(super) fn compared(
    settings: &Settings,
    query: impl IntoIterator<Item = Thing>,
    candidate: impl IntoIterator<Item = Thing>,
) -> Candidate {
    let mut scene = Scene::with(settings.clone());
    scene.put("candidate", keyframe().sees(candidate));
    scene.put("query", keyframe().sees(query));
    scene.compare("query", "candidate")
}

/// One reading of the equation: settings, S, and how many pairs it sums.
struct Reading {
    settings: Settings,
    similarity: f64,
    matches: usize,
}

fn letter(similarity: f64, matches: usize) -> Reading {
    Reading { settings: to_the_letter(), similarity, matches }
}

fn check(what: &str, reading: Reading, query: &[Thing], candidate: &[Thing]) {
    let found = compared(&reading.settings, query.to_vec(), candidate.to_vec());
    let evidence = anchors(&found);
    close_to(what, evidence.similarity, reading.similarity);
    assert_eq!(evidence.matches.len(), reading.matches, "{what}: {found:#?}");
    close_to(what, evidence.threshold, 0.3);
    assert_eq!(evidence.contradictions, [], "{what}");
    // S decides by the letter alone.
    if reading.settings.method == Method::Paper {
        let is_loop = reading.similarity > 0.3;
        let expected = if is_loop { CandidateDecision::Loop } else { CandidateDecision::Rejected };
        assert_eq!(found.decision, expected, "{what}");
    }
}

#[test]
fn s_is_the_weight_of_what_matches_over_the_weight_of_everything() {
    let name = |number: usize, position: [f64; 3]| door(NAMES[number], position);
    // (1 + 1) / (1 + 1 + 1 + 1).
    check(
        "one match at d = 1 among 2 + 2 anchors at d = 1",
        letter(0.5, 1),
        &[door("901", [0.0, 0.0, 1.0]), name(0, [1.0, 0.0, 0.0])],
        &[door("901", [0.0, 0.0, 1.0]), name(1, [1.0, 0.0, 0.0])],
    );
    // (1/2 + 1/2.5) / (1/2 + 1/4 + 1/2.5 + 1/5) = 0.9 / 1.35.
    check(
        "different distances",
        letter(2.0 / 3.0, 1),
        &[door("901", [0.0, 0.0, 2.0]), name(0, [4.0, 0.0, 0.0])],
        &[door("901", [0.0, 0.0, 2.5]), name(1, [5.0, 0.0, 0.0])],
    );
    // 902 is at 2 m and at 4 m. (1 + 1/1.25) / (1 + 1/2 + 1/1.25 + 1/4) = 1.8 / 2.55.
    check(
        "one of two pairs is too far apart",
        letter(1.8 / 2.55, 1),
        &[door("901", [0.0, 0.0, 1.0]), door("902", [2.0, 0.0, 0.0])],
        &[door("901", [0.0, 0.0, 1.25]), door("902", [4.0, 0.0, 0.0])],
    );
    // (1 + 1 + 1/2 + 1/2) / (1 + 1/2 + 1 + 1/2 + 1/4).
    check(
        "two pairs, and one anchor more",
        letter(3.0 / 3.25, 2),
        &[door("901", [0.0, 0.0, 1.0]), door("902", [2.0, 0.0, 0.0])],
        &[door("901", [0.0, 0.0, 1.0]), door("902", [2.0, 0.0, 0.0]), name(0, [0.0, 4.0, 0.0])],
    );
    check("nothing in common", letter(0.0, 0), &[name(0, [0.0, 0.0, 1.0])], &[name(1, [0.0, 0.0, 1.0])]);
    check(
        "another class is another thing",
        letter(0.0, 0),
        &[door("901", [0.0, 0.0, 1.0])],
        &[thing("shelf", "901").at([0.0, 0.0, 1.0])],
    );
    check(
        "the same weight whichever way round: near and far",
        letter(1.0, 1),
        &[door("901", [0.0, 0.0, 1.25])],
        &[door("901", [0.0, 0.0, 0.5])],
    );
}

#[test]
fn three_exit_signs_against_three_make_s_three_by_the_letter_and_one_if_each_matches_once() {
    // Unit vectors 50.2, 48.2 and 48.2 degrees apart: each of the three is in reach of each, and none is another's twin
    // (0.85 m, 0.82 m and 0.82 m). Nine pairs of 1 + 1 over 6, or three of them over 6.
    let signs = || {
        [[0.6, 0.0, 0.8], [0.0, 0.6, 0.8], [2.0 / 3.0, 2.0 / 3.0, 1.0 / 3.0]]
            .map(|position| door("EXIT", position))
    };
    let valid = Settings { description_min_information_level: 2, ..to_the_letter() };
    check("to the letter", Reading { settings: valid.clone(), ..letter(3.0, 9) }, &signs(), &signs());
    let once = Settings { method: Method::Revisit, ..valid };
    check("one-to-one", Reading { settings: once, ..letter(1.0, 3) }, &signs(), &signs());
}

#[test]
fn the_assignment_takes_the_greatest_weight_together_where_the_heaviest_pair_would_waste_it() {
    // On a circle around the camera, 40 degrees between neighbours, 60 is too far: candidate 1.5 m, query 1 m,
    // candidate 1 m, query 1.5 m. The heaviest pair is the middle one (1 + 1 = 2); it leaves the outer two alone, 120
    // degrees apart: 2 / (10/3) = 0.6. The outer pairs are 5/3 each: (10/3) / (10/3) = 1.
    let at = |degrees: f64, distance_m: f64| {
        let angle = degrees.to_radians();
        door("901", [distance_m * angle.sin(), 0.0, distance_m * angle.cos()])
    };
    let settings = Settings { method: Method::Revisit, ..to_the_letter() };
    let (query, candidate) = ([at(40.0, 1.0), at(120.0, 1.5)], [at(0.0, 1.5), at(80.0, 1.0)]);
    check("the outer pairs", Reading { settings, ..letter(1.0, 2) }, &query, &candidate);
    // By the letter all three pairs count: (5/3 + 2 + 5/3) / (10/3).
    check("all of them", letter(1.6, 3), &query, &candidate);
}

#[test]
fn a_pair_is_told_with_every_figure() {
    let query = [door("901", [0.0, 0.0, 2.0])];
    let found = compared(&to_the_letter(), query, [door("room 901", [1.5, 0.0, 2.0])]);
    let pair = &anchors(&found).matches[0];
    assert_eq!(pair.level, 5);
    assert_eq!(pair.source, "identifiers");
    // atan(1.5 / 2); sqrt(1.5^2 + 2^2) = 2.5.
    close_to("angle", pair.angle_difference_rad, 0.75_f64.atan());
    close_to("distance", pair.distance_difference_m, 0.5);
    close_to("weight", pair.weight, 0.5 + 0.4);
    let named = ["a-1", "a-0"].map(|name| AnchorName::Stored(name.to_owned()));
    assert_eq!([&pair.query_anchor, &pair.candidate_anchor], [&named[0], &named[1]]);
    assert_eq!([anchors(&found).in_query, anchors(&found).in_candidate], [1, 1]);
}

#[test]
fn relative_places_are_compared_in_each_keyframes_own_camera_frame() {
    // The same room, seen from the same chair by two robots whose maps are turned by a right angle and 100 m apart.
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let mut scene = Scene::with(to_the_letter());
    scene.put("candidate", keyframe().sees([door("901", [0.0, 0.0, 2.0]), door("902", [2.0, 0.0, 0.0])]));
    // A quarter turn about y takes ahead (z) to x and right (x) to -z.
    let there = [door("901", [102.0, 0.0, 0.0]), door("902", [100.0, 0.0, -2.0])];
    let query = keyframe().session("other-day").turned([100.0, 0.0, 0.0], [0.0, half, 0.0, half]);
    scene.put("query", query.sees(there));
    let found = scene.compare("query", "candidate");
    close_to("S", anchors(&found).similarity, 1.0);
    for pair in &anchors(&found).matches {
        close_to("angle", pair.angle_difference_rad, 0.0);
    }
}

#[test]
fn only_valid_anchors_count_in_s() {
    let query = [door("901", [0.0, 0.0, 2.0]), door("exit", [2.0, 0.0, 0.0]), unread([-2.0, 0.0, 0.0])];
    let candidate = [door("901", [0.0, 0.0, 2.0]), door("exit", [2.0, 0.0, 0.0])];
    let found = compared(&to_the_letter(), query, candidate);
    close_to("S", anchors(&found).similarity, 1.0);
    assert_eq!(anchors(&found).in_query, 1);
    assert_eq!(anchors(&found).in_candidate, 1);
    assert_eq!(anchors(&found).pending, 1);
    assert_eq!(found.decision, CandidateDecision::Loop);
}
