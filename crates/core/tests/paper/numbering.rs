//! M20: a map learns how its building writes its numbers; M26: a distance may be assumed; M17: company.

use revisit_core::domain::anchor::AnchorState;
use revisit_core::semantics::Patterns;
use revisit_core::{CandidateDecision, ReasonCode, Settings};

use super::equation::compared;
use super::scene::{Keyframe, Scene, Thing, anchors, close_to, code, door, keyframe, thing, to_the_letter};

/// So many plates that each is read by two keyframes of one drive, and nothing else of the map is near.
fn building(scene: &mut Scene, plates: usize) {
    for pass in ["a", "b"] {
        let before = format!("plates-{pass}");
        let sights = (0..plates).map(|at| sign(&format!("7.{at:02}"), 100.0 + 5.0 * at as f64));
        scene.put(&before, keyframe().session("plates").words(&[(9, 1.0)]).sees(sights));
    }
}

fn sign(text: &str, x: f64) -> Thing {
    thing("sign", text).at([x, 0.0, 2.0])
}

/// A map of so many plates in which a board is read.
fn with_board(settings: Settings, plates: usize) -> Scene {
    let mut scene = Scene::with(settings);
    building(&mut scene, plates);
    scene.put("board", keyframe().session("boards").sees([sign("HUB04", 0.0)]));
    scene
}

#[test]
fn ten_numbers_read_alike_in_two_keyframes_make_a_numbering() {
    use AnchorState::{Uninformative, Valid};
    let check = |plates: usize, settings: Settings, state: AnchorState, numbering: &[&str]| {
        let board = with_board(settings, plates).anchors().pop().expect("the board");
        assert_eq!(board.state(), state, "{plates} plates: {board:#?}");
        assert_eq!(board.numbering, numbering, "{plates} plates: {board:#?}");
    };
    let default = Settings::default;
    check(9, default(), Valid, &[]);
    check(10, default(), Uninformative, &["#.99"]);
    check(10, Settings { learned_identifiers: false, ..default() }, Valid, &[]);
    check(10, to_the_letter(), Valid, &[]);
    let given = |pattern: &str| Settings {
        identifier_patterns: Patterns::new(vec![pattern.to_owned()]).expect("a pattern"),
        ..default()
    };
    check(0, given("[0-9]+[.][0-9]{2}"), Uninformative, &["[0-9]+[.][0-9]{2}"]);
    check(0, given("hub ?[0-9]+"), Valid, &["hub ?[0-9]+"]);
}

#[test]
fn a_numbering_is_forgotten_with_what_it_was_learned_from() {
    let mut scene = with_board(Settings::default(), 10);
    let state = |scene: &Scene| scene.anchors().pop().expect("the board").state();
    assert_eq!(state(&scene), AnchorState::Uninformative);
    scene.cull("plates-b");
    assert_eq!(state(&scene), AnchorState::Valid);
}

#[test]
fn where_a_distance_was_assumed_the_angle_alone_gates_and_weighs() {
    let settings = &Settings::default();
    let near = || door("901", [0.0, 0.0, 2.0]);
    let far = || door("901", [0.0, 0.0, 5.0]);
    let measured = compared(settings, [near()], [far()]);
    close_to("3 m apart", anchors(&measured).similarity, 0.0);
    let guessed = compared(settings, [near().at_a_guess()], [far().at_a_guess()]);
    close_to("guessed", anchors(&guessed).similarity, 1.0);
    // Each weighs 1 instead of 1/2 and 1/5.
    close_to("its weight", anchors(&guessed).matches[0].weight, 2.0);
    let aside = door("901", [5.0, 0.0, 0.0]).at_a_guess();
    let turned = compared(settings, [near().at_a_guess()], [aside]);
    close_to("90 degrees aside", anchors(&turned).similarity, 0.0);
}

/// A board 2 m ahead, in a session of its own.
fn board() -> Thing {
    thing("board", "HUB 04").at([0.0, 0.0, 2.0])
}

/// The board with a plaque a metre to its right.
fn lobby(session: &str, plaque: &str) -> Keyframe {
    keyframe().session(session).sees([board(), thing("plaque", plaque).at([1.0, 0.0, 2.0])])
}

#[test]
fn a_board_beside_which_another_plaque_hangs_hangs_in_two_places() {
    const LOOP: (CandidateDecision, Option<ReasonCode>) = (CandidateDecision::Loop, None);
    let check = |second: &str, expected| {
        let mut scene = Scene::new();
        scene.put("floor-4", lobby("four", "4"));
        scene.put("other", lobby("other", second));
        // It sees the board alone, and so nothing that contradicts.
        scene.put("query", keyframe().session("third").sees([board()]));
        let found = scene.compare("query", "floor-4");
        assert_eq!((found.decision, code(&found)), expected, "{found:#?}");
    };
    let in_two_places = (CandidateDecision::Undecided, Some(ReasonCode::NotDistinctive));
    check("5", in_two_places);
    check("4", LOOP);
}
