//! §IV-B: what an anchor knows, and when its description makes it valid.

use revisit_core::domain::anchor::{AnchorState, IgnoredReason, Outcome};
use revisit_core::semantics::Name;
use revisit_core::{CandidateDecision, MapProperties, ReasonCode};

use super::scene::{Scene, anchors, close_to_all, code, door, keyframe, named, thing, to_the_letter, unread};

#[test]
fn a_description_of_information_level_4_makes_a_valid_anchor_and_a_setting_moves_the_bar_at_once() {
    use AnchorState::{Pending, Uninformative, Valid};
    // (text, its level, its state at the bars 4 (the paper's), 2 and 5)
    let table = [
        ("", 1, [Pending, Pending, Pending]),
        ("unknown", 1, [Uninformative, Uninformative, Uninformative]),
        ("exit", 2, [Uninformative, Valid, Uninformative]),
        ("brown door", 3, [Uninformative, Valid, Uninformative]),
        ("901", 4, [Valid, Valid, Uninformative]),
        ("Mona Lisa", 4, [Valid, Valid, Uninformative]),
        ("room 902", 5, [Valid, Valid, Valid]),
    ];
    let mut scene = Scene::new();
    let sights = table.iter().zip(0..).map(|((text, ..), n)| door(text, [f64::from(n) * 5.0, 0.0, 2.0]));
    let stored = scene.put("kf-1", keyframe().sees(sights));
    let states = scene.fed(&stored).into_iter().map(|anchor| scene.anchor(anchor).state());
    assert_eq!(states.collect::<Vec<_>>(), table.map(|(_, _, [state, ..])| state));
    assert_eq!(stored.outcomes.iter().map(|outcome| named(*outcome)).collect::<Vec<_>>(), ["created"; 7]);
    for (column, bar) in [4, 2, 5].into_iter().enumerate() {
        scene.set(|settings| settings.description_min_information_level = bar);
        let anchors = scene.anchors();
        assert_eq!(anchors.len(), table.len());
        for ((text, level, states), anchor) in table.iter().zip(&anchors) {
            assert_eq!(anchor.state(), states[column], "{text:?} at {bar}");
            assert_eq!(anchor.information_level(), *level, "{text:?}");
        }
    }
}

#[test]
fn a_sign_becomes_evidence_when_the_bar_comes_down() {
    let mut scene = Scene::with(to_the_letter());
    for id in ["kf-1", "kf-9"] {
        scene.put(id, keyframe().sees([door("EXIT", [0.0, 0.0, 1.0])]));
    }
    let figures = |scene: &Scene| {
        let candidate = scene.compare("kf-9", "kf-1");
        (candidate.decision, code(&candidate), anchors(&candidate).in_query)
    };
    assert_eq!(figures(&scene), (CandidateDecision::Undecided, Some(ReasonCode::NoAnchors), 0));
    scene.set(|settings| settings.description_min_information_level = 2);
    assert_eq!(figures(&scene), (CandidateDecision::Loop, None, 1));
}

#[test]
fn an_anchor_has_its_class_keyframes_map_points_box_and_description() {
    let mut scene = Scene::new();
    let corners = [(1, [0.0, 0.0, 2.0]), (2, [1.0, 0.0, 2.0]), (3, [0.5, 1.0, 2.0])];
    let plate = || thing("door_number", "Room 901");
    let seen = scene.put("kf-1", keyframe().points(&corners).sees([plate().on([1, 2, 3])]));
    let more = keyframe().covisible(&["kf-1"]).points(&[(4, [0.5, 0.5, 3.0])]);
    // 2 of 3 points are covered: more than 0.2.
    let again = scene.put("kf-2", more.sees([plate().on([2, 3, 4])]));
    let id = scene.fed(&seen)[0];
    assert_eq!(again.outcomes, [Outcome::Observed(id)]);

    let anchor = scene.anchor(id);
    assert_eq!(anchor.state(), AnchorState::Valid);
    assert_eq!(anchor.class, "door_number");
    assert_eq!(anchor.keyframes, ["kf-1", "kf-2"]);
    assert_eq!(anchor.map_points(), 4);
    close_to_all("min", anchor.aabb().min(), [0.0, 0.0, 2.0]);
    close_to_all("max", anchor.aabb().max(), [1.0, 1.0, 3.0]);
    close_to_all("center", anchor.centre(), [0.5, 0.5, 2.5]);
    assert_eq!(anchor.description(), "Room 901");
    let description = anchor.object.description.as_ref().expect("it is described");
    assert_eq!(description.text.names().map(Name::as_str).collect::<Vec<_>>(), ["901"]);
}

#[test]
fn a_detection_of_another_class_or_without_a_place_makes_no_anchor() {
    let classes = vec!["door_number".to_owned()];
    let mut scene = Scene::of(MapProperties { anchor_classes: classes, ..MapProperties::default() });
    let sights = [
        thing("chair", "901").at([0.0, 0.0, 2.0]),
        thing("door_number", "901"),
        unread([0.0, 0.0, 2.0]),
        thing("door_number", "902").on([77]),
    ];
    let stored = scene.put("kf-1", keyframe().sees(sights));
    let [of_no_class, nowhere, placed, to_be_placed] = stored.outcomes.try_into().expect("four outcomes");
    assert_eq!(of_no_class, Outcome::Ignored(IgnoredReason::ClassNotAnchored));
    assert_eq!(nowhere, Outcome::Ignored(IgnoredReason::NoPlace));
    // A map point that is not triangulated yet is a place still to come.
    assert_eq!([named(placed), named(to_be_placed)], ["created", "created"]);
    assert_eq!(scene.anchors().len(), 2);
}
