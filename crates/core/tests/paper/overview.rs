//! §III: an anchor that was seen before triggers loop detection, even where no word does (M10).

use revisit_core::domain::event::EventKind;
use revisit_core::{Decision, ReasonCode};

use super::scene::{Scene, anchors, candidates, close_to, door, ids, keyframe};

#[test]
fn an_anchor_that_matches_one_seen_before_triggers_a_loop_check() {
    let mut scene = Scene::new();
    let first = scene.put("kf-1", keyframe().words(&[(1, 1.0)]).sees([door("901", [0.0, 0.0, 2.0])]));
    assert!(!first.revisits);
    let again = scene.put("kf-9", keyframe().words(&[(2, 1.0)]).sees([door("room 901", [0.0, 0.0, 2.0])]));
    assert!(again.revisits);
    let told = again.decided.events.iter().find(|event| event.kind == EventKind::AnchorsMatched);
    let told = told.expect("it is told");
    assert_eq!([told.anchor, told.other], [scene.fed(&again)[0], scene.fed(&first)[0]].map(Some));
    assert_eq!(ids(&told.keyframe), ["kf-9"]);
}

#[test]
fn an_anchor_seen_before_proposes_a_keyframe_that_shares_no_word() {
    let mut scene = Scene::new();
    scene.put("kf-1", keyframe().words(&[(1, 1.0)]).sees([door("901", [0.0, 0.0, 2.0])]));
    scene.put("kf-9", keyframe().words(&[(2, 1.0)]).sees([door("room 901", [0.0, 0.0, 2.0])]));
    let verdict = scene.ask("kf-9");
    assert_eq!(verdict.decision, Decision::Loop, "{verdict:#?}");
    assert_eq!(ids(&verdict.best), ["kf-1"]);
    let candidate = scene.compare("kf-9", "kf-1");
    close_to("score", candidate.bow.score, 0.0);
    assert_eq!(candidate.bow.common_words, 0);
    // (1/2 + 1/2) / (1/2 + 1/2).
    close_to("S", anchors(&candidate).similarity, 1.0);
}

#[test]
fn an_anchor_merely_tracked_through_one_passage_proposes_nobody() {
    let mut scene = Scene::new();
    let plate = || [door("901", [0.0, 0.0, 2.0])];
    scene.put("kf-1", keyframe().words(&[(1, 1.0)]).sees(plate()));
    scene.put("kf-2", keyframe().words(&[(2, 1.0)]).covisible(&["kf-1"]).sees(plate()));
    scene.put("kf-3", keyframe().words(&[(3, 1.0)]).covisible(&["kf-2"]).sees(plate()));
    assert_eq!(scene.anchors().len(), 1);
    let verdict = scene.ask("kf-3");
    assert_eq!(verdict.candidates, []);
    assert_eq!(verdict.decision, Decision::NoLoop);
    assert_eq!(verdict.reason.map(|reason| reason.code), Some(ReasonCode::NoCandidates));
    assert_eq!(verdict.excluded_covisible, 1);
}

/// Two passages of one door, joined by a loop of their first keyframes; no two keyframes share a word.
fn joined_passages() -> Scene {
    let mut scene = Scene::new();
    let plate = || [door("901", [0.0, 0.0, 2.0])];
    scene.put("kf-1", keyframe().words(&[(1, 1.0)]).sees(plate()));
    scene.put("kf-2", keyframe().words(&[(2, 1.0)]).covisible(&["kf-1"]).sees(plate()));
    scene.put("kf-11", keyframe().words(&[(11, 1.0)]).sees(plate()));
    scene.close("l-1", "kf-11", "kf-1");
    scene.put("kf-12", keyframe().words(&[(12, 1.0)]).covisible(&["kf-11"]).sees(plate()));
    scene.put("kf-13", keyframe().words(&[(13, 1.0)]).covisible(&["kf-12"]).sees(plate()));
    assert_eq!(scene.anchors().len(), 1);
    scene
}

#[test]
fn an_anchor_merged_by_a_confirmed_loop_proposes_the_other_passage_and_not_its_own() {
    let scene = joined_passages();
    // kf-1 and kf-2 are one place, of which the smaller id stands; kf-11 is of kf-12's and kf-13's own passage.
    assert_eq!(candidates(&scene.ask("kf-13")), ["kf-1"]);
    assert_eq!(candidates(&scene.ask("kf-12")), ["kf-1"]);
}

#[test]
fn the_keyframe_that_closed_the_loop_is_proposed_the_rest_of_the_other_passage() {
    let scene = joined_passages();
    let verdict = scene.ask("kf-11");
    // kf-1 is covisible by the loop (M12), and so is kf-12 by its client; kf-2 observes an anchor that a confirmed
    // loop merged with one that kf-11 sees (M10).
    assert_eq!(verdict.excluded_covisible, 2);
    assert_eq!(candidates(&verdict), ["kf-2"]);
}
