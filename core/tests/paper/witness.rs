//! M22: a text without an identifier closes a loop only with a witness.

use revisit_core::{Candidate, CandidateDecision, ReasonCode, Settings};

use super::equation::compared;
use super::scene::{Keyframe, Scene, Thing, anchors, close_to, code, door, keyframe, thing, to_the_letter};

/// A poster, a metre ahead.
fn poster(text: &str) -> Thing {
    thing("sign", text).at([0.0, 0.0, 1.0])
}

/// What is a loop, or is none for want of a witness.
#[track_caller]
fn is_loop(what: &str, found: &Candidate, expected: bool) {
    let expected = if expected {
        (CandidateDecision::Loop, None)
    } else {
        (CandidateDecision::Undecided, Some(ReasonCode::NoWitness))
    };
    assert_eq!((found.decision, code(found)), expected, "{what}: {found:#?}");
}

fn no_witness_needed() -> Settings {
    Settings { single_text_needs_witness: false, ..Settings::default() }
}

#[test]
fn a_slogan_alone_makes_no_loop_and_beside_a_door_number_it_counts() {
    let check = |what: &str, settings: Settings, sights: &[Thing], expected: bool| {
        let found = compared(&settings, sights.to_vec(), sights.to_vec());
        close_to(what, anchors(&found).similarity, 1.0);
        is_loop(what, &found, expected);
    };
    let default = Settings::default;
    let slogan = || poster("Be Updated");
    check("a slogan", default(), &[slogan()], false);
    let two = [slogan(), thing("sign", "Library Corner").at([0.5, 0.0, 1.0])];
    check("two do not witness each other", default(), &two, false);
    check("turned off", no_witness_needed(), &two, true);
    check("the paper's letter", to_the_letter(), &[slogan()], true);
    let numbered = [slogan(), door("901", [0.5, 0.0, 1.0])];
    check("beside a number", default(), &numbered, true);
    let described = [poster("a painting of a sailing boat before a windmill")];
    check("what a picture shows is a description", default(), &described, true);
    for notice in [
        "Prière de fermer doucement cette porte",
        "本室設備使用後請歸還原位",
        "Kérjük az ajtót mindig csukva tartani",
    ] {
        check("a count of words is no witness", default(), &[poster(notice)], false);
    }
    let container = [poster("Library Corner, level 5")];
    check("a floor is no identifier", default(), &container, false);
}

/// A keyframe at x on a way whose neighbours share fifteen points; the ends share none.
fn on_the_way(x: f64, first_point: i64) -> Keyframe {
    keyframe().at([x, 0.0, 0.0]).observes(first_point..first_point + 30)
}

#[test]
fn odometry_over_an_unbroken_chain_is_a_witness_if_it_has_the_two_at_one_place() {
    let check = |what: &str, chain: bool, ahead_m: f64, back_m: f64, expected: bool| {
        let mut scene = Scene::new();
        let sees = |x: f64| [thing("sign", "Be Updated").at([x, 0.0, 1.0])];
        scene.put("candidate", on_the_way(0.0, 0).stamp(0).sees(sees(0.0)));
        // So many that neither end's local anchor map holds what the other sees.
        for (number, x) in (0..).zip([0.5 * ahead_m, ahead_m, back_m]) {
            let first_point = if chain || number != 1 { 15 * (number + 1) } else { 1_000 };
            scene.put(&format!("between-{number}"), on_the_way(x, first_point).stamp(number + 1));
        }
        scene.put("query", on_the_way(back_m, 60).stamp(4).sees(sees(back_m)));
        is_loop(what, &scene.compare("query", "candidate"), expected);
    };
    // There and back: 2 m + 1.1 m of way explain 1 m + 5 % of it, 1.155 m; the two posters hang 0.9 m apart.
    check("back at the poster", true, 2.0, 0.9, true);
    // 2 m + 0.8 m of way: 1.14 m, and 1.2 m apart.
    check("a little farther", true, 2.0, 1.2, false);
    check("another poster", true, 2.0, 4.0, false);
    check("the chain is broken", false, 2.0, 0.9, false);
}

#[test]
fn a_confirmed_loop_that_joins_the_passages_is_a_witness() {
    let mut scene = Scene::with(Settings { returns_close_once: false, ..Settings::default() });
    let sees = || [poster("Be Updated")];
    scene.put("monday-1", keyframe().session("monday").sees(sees()));
    scene.put("monday-2", keyframe().session("monday").words(&[(7, 1.0)]).covisible(&["monday-1"]));
    scene.put("tuesday-1", keyframe().session("tuesday").sees(sees()));
    let tuesday_2 = keyframe().session("tuesday").words(&[(8, 1.0)]).covisible(&["tuesday-1"]);
    scene.put("tuesday-2", tuesday_2);
    is_loop("alone", &scene.compare("tuesday-1", "monday-1"), false);
    scene.close("somebody-knows", "tuesday-2", "monday-2");
    is_loop("joined", &scene.compare("tuesday-1", "monday-1"), true);
}

#[test]
fn a_number_that_begins_unlike_those_around_it_makes_no_loop_alone() {
    let plate = || door("3.02", [0.0, 0.0, 1.0]);
    let check = |what: &str, settings: Settings, around: [&str; 2], expected: bool| {
        let [left, above] = around;
        let sees = [plate(), door(left, [3.0, 0.0, 0.0]), door(above, [0.0, 3.0, 0.0])];
        let found = compared(&settings, sees, [plate()]);
        // (1 + 1) / (1 + 1 + 1/3 + 1/3).
        close_to(what, anchors(&found).similarity, 0.75);
        is_loop(what, &found, expected);
    };
    check("floor 3 among floor 9", Settings::default(), ["9.01", "9.04"], false);
    check("two floors meet", Settings::default(), ["9.01", "3.04"], true);
    check("turned off", no_witness_needed(), ["9.01", "9.04"], true);
}
