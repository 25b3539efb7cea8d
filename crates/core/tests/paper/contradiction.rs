//! M7, contradictions: two names of one class that exclude each other at the same relative place, as a verdict shows them and as
//! the sum weighs them, where no keyframe has features.

use revisit_core::domain::verdict::EvidenceKind::{self, DisplacedName, Name, OtherName, StrangeNames};
use revisit_core::recognition::odds::log_odds::LogOdds;
use revisit_core::recognition::odds::weights;
use revisit_core::{Candidate, CandidateDecision, ReasonCode};

use super::scene::{Keyframe, Scene, Thing, anchors, close_to, code, door, keyframe, reason, terms, thing};

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

/// Two passages compared, with what else each sees.
fn between(query: (Readings<'_>, &[Thing]), candidate: (Readings<'_>, &[Thing])) -> Candidate {
    let mut scene = Scene::new();
    pass(&mut scene, "candidate", candidate.0, candidate.1);
    pass(&mut scene, "query", query.0, query.1);
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

/// It is rejected for want of evidence.
#[track_caller]
fn is_unlike(what: &str, found: &Candidate, told: &[(EvidenceKind, LogOdds)]) {
    assert_eq!(found.decision, CandidateDecision::Rejected, "{what}: {found:#?}");
    assert_eq!(terms(found), told, "{what}");
    assert_eq!(anchors(found).contradictions, [], "{what}");
}

#[test]
fn a_plate_that_reads_910_where_901_hung_makes_no_loop_and_the_reason_names_both() {
    let check = |what: &str, query: Readings<'_>, candidate: Readings<'_>, contradict: bool| {
        let found = between((query, &[]), (candidate, &[]));
        if contradict {
            is_contradicted(what, &found, [query[0], candidate[0]]);
            assert_eq!(terms(&found), [(OtherName, weights::OTHER_NAME)], "{what}");
        } else {
            is_unlike(what, &found, &[]);
        }
    };
    check("two characters differ, single readings", &["901"], &["910"], true);
    check("one character differs, single readings", &["3"], &["8"], true);
    check("each read alike twice", &["3", "3"], &["8", "8"], true);
    check("one of them read once", &["3", "3"], &["8"], true);
    check("each read twice, one not alike", &["3", "unknown"], &["8", "8"], true);
    check("look-alikes are no conflict of the judge's", &["9O1", "9O1"], &["901", "901"], false);
    check("another role is no conflict", &["floor 9", "floor 9"], &["room 9", "room 9"], false);
    check("words are no names", &["Turing", "Turing"], &["Curie", "Curie"], false);
}

#[test]
fn only_names_of_one_class_at_the_same_relative_place_contradict_and_elsewhere_they_are_strange() {
    let strange = [(StrangeNames, weights::STRANGE_NAMES)];
    let check = |what: &str, there: Thing, otherwise: Option<&[(EvidenceKind, LogOdds)]>| {
        let mut scene = Scene::new();
        scene.put("candidate", seeing([there]));
        scene.put("query", seeing([door("901", AHEAD)]));
        let found = scene.compare("query", "candidate");
        match otherwise {
            None => is_contradicted(what, &found, ["901", "910"]),
            Some(told) => is_unlike(what, &found, told),
        }
    };
    check("the same place", door("910", AHEAD), None);
    check("another class", thing("shelf", "910").at(AHEAD), Some(&[]));
    check("1 m farther", door("910", [0.0, 0.0, 2.0]), Some(&strange));
    check("less than 1 m farther", door("910", [0.0, 0.0, 1.9]), None);
    check("61 degrees to the right", door("910", [0.8746, 0.0, 0.4848]), Some(&strange));
    check("59 degrees to the right", door("910", [0.8572, 0.0, 0.5150]), None);
}

#[test]
fn names_that_agree_weigh_against_another_name_at_one_spot() {
    // Plates a metre away, 90 degrees apart.
    let agreeing = [door("905", [1.0, 0.0, 0.0]), door("907", [-1.0, 0.0, 0.0])];
    let check = |what: &str, agree: usize, told: &[(EvidenceKind, LogOdds)], decision: CandidateDecision| {
        let more = &agreeing[..agree];
        let found = between((&["901"], more), (&["910"], more));
        assert_eq!(terms(&found), told, "{what}");
        assert_eq!(found.decision, decision, "{what}: {found:#?}");
        assert_eq!(anchors(&found).contradictions.len(), 1, "{what}");
    };
    let (name, other) = ((Name, weights::NAME), (OtherName, weights::OTHER_NAME));
    check("none agrees", 0, &[other], CandidateDecision::Rejected);
    // Beside one that differs, a single name may be that of two boards (M17).
    check("one agrees", 1, &[(EvidenceKind::SharedName, LogOdds::EVEN), other], CandidateDecision::Rejected);
    check("two agree", 2, &[name, name, other], CandidateDecision::Loop);
}

#[test]
fn a_plate_that_hangs_behind_in_the_other_map_is_displaced_and_contradicts_nothing() {
    // 901 is ahead in one map and behind the camera in the other: another point of view, not another room.
    let behind = [door("901", [0.0, 0.0, -5.0])];
    let found = between((&["901"], &[]), (&["910"], &behind));
    is_unlike("901 hangs behind", &found, &[(DisplacedName, weights::DISPLACED_BY_BEARING)]);
    assert_eq!(code(&found), Some(ReasonCode::AnchorsDisplaced));
}

#[test]
fn an_anchor_contradicts_one_other_at_most() {
    // Both within reach of 901; 920 weighs 1/1.5, 910 weighs 1.
    let beside = [door("920", [1.2, 0.0, 0.9])];
    let found = between((&["901"], &[]), (&["910"], &beside));
    is_contradicted("the heavier pair", &found, ["901", "910"]);
    close_to("weight", anchors(&found).contradictions[0].weight, 2.0);
    assert_eq!(terms(&found), [(OtherName, weights::OTHER_NAME)]);
}
