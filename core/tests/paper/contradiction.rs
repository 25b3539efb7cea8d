//! M7, contradictions: two different identifiers of one class at the same relative place, where no keyframe has features.
//! What geometry leaves of them is in `tests/it/geometry.rs` of the server.

use revisit_core::{Candidate, CandidateDecision, ReasonCode, Settings};

use super::scene::{
    Keyframe, NAMES, Scene, Thing, anchors, candidate_of, close_to, code, door, keyframe, reason, thing, told,
};

const AHEAD: [f64; 3] = [0.0, 0.0, 1.0];

/// A passage: how often the plate ahead is read, and as what.
type Readings<'a> = &'a [&'a str];

/// Stores a passage; the first keyframe has its name, those that read the plate again are covisible with it.
fn pass(scene: &mut Scene, name: &str, readings: Readings<'_>, more: &[Thing]) {
    for (number, text) in readings.iter().enumerate() {
        let plate = door(text, AHEAD);
        if number == 0 {
            scene.put(name, seeing([plate].into_iter().chain(more.iter().cloned())));
        } else {
            scene.put(&format!("{name}-{number}"), seeing([plate]).covisible(&[name]));
        }
    }
}

fn seeing(sights: impl IntoIterator<Item = Thing>) -> Keyframe {
    keyframe().sees(sights)
}

/// Two passages compared.
fn between(settings: Settings, query: Readings<'_>, candidate: Readings<'_>) -> Candidate {
    let mut scene = Scene::with(settings);
    pass(&mut scene, "candidate", candidate, &[]);
    pass(&mut scene, "query", query, &[]);
    scene.compare("query", "candidate")
}

#[track_caller]
fn is_contradicted(what: &str, found: &Candidate, named: [&str; 2]) {
    assert_eq!(found.decision, CandidateDecision::Rejected, "{what}: {found:#?}");
    assert_eq!(code(found), Some(ReasonCode::Contradiction), "{what}");
    let contradictions = &anchors(found).contradictions;
    assert_eq!(contradictions.len(), 1, "{what}");
    for text in [&reason(found).detail, &contradictions[0].reason] {
        assert!(named.iter().all(|name| text.contains(name)), "{what}: {text:?} does not name {named:?}");
    }
}

#[track_caller]
fn only_does_not_match(what: &str, found: &Candidate) {
    assert_eq!(found.decision, CandidateDecision::Rejected, "{what}: {found:#?}");
    assert_eq!(code(found), Some(ReasonCode::ScoreBelowThreshold), "{what}");
    assert_eq!(anchors(found).contradictions, [], "{what}");
}

#[test]
fn identifiers_that_differ_contradict_where_geometry_cannot_run_and_the_reason_names_both() {
    let check = |what: &str, query: Readings<'_>, candidate: Readings<'_>, contradict: bool| {
        let found = between(Settings::default(), query, candidate);
        if contradict {
            is_contradicted(what, &found, [query[0], candidate[0]]);
        } else {
            only_does_not_match(what, &found);
        }
    };
    check("two characters differ, single readings", &["901"], &["910"], true);
    check("one character differs, single readings", &["3"], &["8"], true);
    check("each read alike twice", &["3", "3"], &["8", "8"], true);
    check("one of them read once", &["3", "3"], &["8"], true);
    check("each read twice, not alike", &["3", "unknown"], &["8", "8"], true);
    check("look-alikes are no conflict of the judge's", &["9O1", "9O1"], &["901", "901"], false);
    check("another role is no conflict", &["floor 9", "floor 9"], &["room 9", "room 9"], false);
    check("names are no identifiers", &["Turing", "Turing"], &["Curie", "Curie"], false);
}

#[test]
fn the_veto_can_be_turned_off() {
    let off = Settings { contradiction_veto: false, ..Settings::default() };
    only_does_not_match("off", &between(off, &["901"], &["910"]));
}

#[test]
fn only_anchors_of_one_class_at_the_same_relative_place_contradict() {
    let check = |what: &str, there: Thing, contradict: bool| {
        let mut scene = Scene::new();
        scene.put("candidate", seeing([there]));
        scene.put("query", seeing([door("901", AHEAD)]));
        let found = scene.compare("query", "candidate");
        if contradict {
            is_contradicted(what, &found, ["901", "910"]);
        } else {
            only_does_not_match(what, &found);
        }
    };
    check("the same place", door("910", AHEAD), true);
    check("another class", thing("shelf", "910").at(AHEAD), false);
    check("1 m farther", door("910", [0.0, 0.0, 2.0]), false);
    check("less than 1 m farther", door("910", [0.0, 0.0, 1.9]), true);
    check("61 degrees to the right", door("910", [0.8746, 0.0, 0.4848]), false);
    check("59 degrees to the right", door("910", [0.8572, 0.0, 0.5150]), true);
}

#[test]
fn contradictions_must_outweigh_agreements() {
    // 901 against 910 a metre ahead: 1 + 1. Room 905 on the right, at some distance, agrees.
    let check = |what: &str, distance_m: f64, contradicted: bool| {
        let agreeing = [door("905", [distance_m, 0.0, 0.0])];
        let mut scene = Scene::with(Settings { company: false, ..Settings::default() });
        pass(&mut scene, "candidate", &["910"], &agreeing);
        pass(&mut scene, "query", &["901"], &agreeing);
        let found = scene.compare("query", "candidate");
        close_to(what, anchors(&found).contradictions[0].weight, 2.0);
        close_to(what, anchors(&found).matches[0].weight, 2.0 / distance_m);
        if contradicted {
            is_contradicted(what, &found, ["901", "910"]);
            told(what, reason(&found).measured, 2.0);
            told(what, reason(&found).limit, 2.0 / distance_m);
        } else {
            assert_eq!(found.decision, CandidateDecision::Loop, "{what}: {found:#?}");
        }
    };
    check("2 against 1", 2.0, true);
    check("2 against 2 does not exceed", 1.0, false);
    check("2 against 4", 0.5, false);
}

#[test]
fn a_plate_known_on_the_other_side_contradicts_nothing() {
    // 901 is ahead in one map and behind the camera in the other: another point of view, not another room.
    let mut scene = Scene::new();
    pass(&mut scene, "candidate", &["910"], &[door("901", [0.0, 0.0, -5.0])]);
    pass(&mut scene, "query", &["901"], &[]);
    only_does_not_match("901 hangs behind", &scene.compare("query", "candidate"));
}

#[test]
fn an_anchor_contradicts_one_other_at_most() {
    let mut scene = Scene::new();
    // Both within reach of 901; 920 weighs 1/1.5, 910 weighs 1.
    pass(&mut scene, "candidate", &["910"], &[door("920", [1.2, 0.0, 0.9])]);
    pass(&mut scene, "query", &["901"], &[]);
    let found = scene.compare("query", "candidate");
    is_contradicted("the heavier pair", &found, ["901", "910"]);
    close_to("weight", anchors(&found).contradictions[0].weight, 2.0);
}

#[test]
fn contradicting_weights_are_distinctive_too() {
    // 910 hangs at 2 places, 901 at one: 1 + 1/2. What agrees weighs 0.8 + 0.8: it outweighs.
    let settings = Settings { single_text_needs_witness: false, company: false, ..Settings::default() };
    let mut scene = Scene::with(settings);
    let agreeing = [thing("poster", NAMES[0]).at([1.25, 0.0, 0.0])];
    pass(&mut scene, "candidate", &["910"], &agreeing);
    pass(&mut scene, "query", &["901"], &agreeing);
    let other = keyframe().at([50.0, 0.0, 0.0]).words(&[(99, 1.0)]).sees([door("910", [50.0, 0.0, 1.0])]);
    let before = scene.compare("query", "candidate");
    is_contradicted("2 against 1.6", &before, ["901", "910"]);
    scene.put("elsewhere", other);
    let found = candidate_of(&scene.ask("query"), "candidate").expect("it has the query's words");
    close_to("weight", anchors(&found).contradictions[0].weight, 1.5);
    assert_eq!(found.decision, CandidateDecision::Loop, "{found:#?}");
}
