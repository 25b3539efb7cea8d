//! M10 and M21: what one passage says once is no return, and what one unsure detection read is no text.

use revisit_core::domain::anchor::AnchorState;
use revisit_core::domain::verdict::{EvidenceKind, EvidenceTerm};
use revisit_core::{Candidate, CandidateDecision, ReasonCode, Settings};

use super::scene::{Scene, anchors, close_to, code, door, keyframe, to_the_letter};

const PLATE: [f64; 3] = [0.0, 0.0, 3.0];

/// Three keyframes of one drive, each covisible with the one before; all at these x, the second seeing the plate or not.
fn drive(settings: Settings, xs: [f64; 3], seen_between: bool) -> Candidate {
    let mut scene = Scene::with(settings);
    let plate = || vec![door("901", PLATE)];
    let at = |x: f64| keyframe().at([x, 0.0, 0.0]);
    scene.put("first", at(xs[0]).sees(plate()));
    let between = if seen_between { plate() } else { vec![] };
    scene.put("second", at(xs[1]).covisible(&["first"]).sees(between));
    scene.put("third", at(xs[2]).covisible(&["second"]).sees(plate()));
    scene.compare("third", "first")
}

#[test]
fn a_plate_that_is_tracked_through_one_passage_is_no_return() {
    const TRACKED: (CandidateDecision, Option<ReasonCode>) =
        (CandidateDecision::Undecided, Some(ReasonCode::TrackedOnly));
    const LOOP: (CandidateDecision, Option<ReasonCode>) = (CandidateDecision::Loop, None);
    let check = |what: &str, settings: Settings, xs: [f64; 3], seen: bool, expected| {
        let found = drive(settings, xs, seen);
        close_to(what, anchors(&found).similarity, 1.0);
        assert_eq!((found.decision, code(&found)), expected, "{what}: {found:#?}");
        if let Some(odds) = &found.odds {
            let is_name = |term: &EvidenceTerm| term.kind == EvidenceKind::Name;
            assert_eq!(odds.terms.iter().any(is_name), expected == LOOP, "{what}: {found:#?}");
        }
    };
    let default = Settings::default;
    check("past the plate", default(), [0.0, 0.5, 1.0], true, TRACKED);
    check("the paper asks for S alone", to_the_letter(), [0.0, 0.5, 1.0], true, LOOP);
    // 1.5 m and 1.5 m: between two sightings no more than 3 m, however far in all.
    check("from sighting to sighting", default(), [-1.5, 0.0, 1.5], true, TRACKED);
    let near = Settings { distinctive_place_radius_m: 1.4, ..default() };
    check("3 m at most", near, [-1.5, 0.0, 1.5], true, LOOP);
    // 3.5 m ahead and 3 m back, out of sight: another passage, and another anchor.
    check("gone and come back", default(), [0.0, 3.5, 0.5], false, LOOP);
}

#[test]
fn an_unsure_reading_tells_nothing_until_the_anchor_is_read_alike_again() {
    use AnchorState::{Uninformative, Valid};
    let state_with = |settings: Settings, readings: &[(&str, f64)]| {
        let mut scene = Scene::with(settings);
        for (number, (text, confidence)) in readings.iter().enumerate() {
            let covisible: Vec<String> = (0..number).map(|before| format!("kf-{before}")).collect();
            let covisible: Vec<&str> = covisible.iter().map(String::as_str).collect();
            let sight = door(text, PLATE).confidence(*confidence);
            scene.put(&format!("kf-{number}"), keyframe().covisible(&covisible).sees([sight]));
        }
        scene.anchors()[0].state()
    };
    let state = |readings: &[(&str, f64)]| state_with(Settings::default(), readings);
    assert_eq!(state(&[("901", 0.79)]), Uninformative);
    assert_eq!(state(&[("901", 0.8)]), Valid);
    assert_eq!(state(&[("901", 0.6), ("901", 0.5)]), Valid, "read alike again");
    assert_eq!(state(&[("901", 0.6), ("907", 0.5)]), Uninformative, "read otherwise");
    assert_eq!(state(&[("a sailing boat before a windmill", 0.5)]), Valid, "words of a wall");
    let off = Settings { reading_min_confidence: 0.0, ..Settings::default() };
    assert_eq!(state_with(off, &[("901", 0.1)]), Valid, "off");
}
