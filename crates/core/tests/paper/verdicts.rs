//! Verdicts: what is missing, what could turn the answer, and which checks run (M11, M28, M39).

use revisit_core::domain::settings::WithoutAnchors;
use revisit_core::domain::verdict::{EvidenceKind, GeometryStatus};
use revisit_core::recognition::odds::weights;
use revisit_core::{CandidateDecision, Decision, ReasonCode, Settings, Verify};

use super::equation::compared;
use super::scene::{
    NAMES, Scene, Thing, anchors, candidate_of, close_to, code, door, keyframe, terms, thing, to_the_letter,
    unread,
};

const AHEAD: [f64; 3] = [0.0, 0.0, 1.0];

fn plate() -> Vec<Thing> {
    vec![door("901", AHEAD)]
}

#[test]
fn where_either_local_map_is_empty_a_setting_decides() {
    let check = |what: &str,
                 settings: Settings,
                 query: Vec<Thing>,
                 candidate: Vec<Thing>,
                 expected: (CandidateDecision, ReasonCode)| {
        let found = compared(&settings, query, candidate);
        assert_eq!((found.decision, code(&found)), (expected.0, Some(expected.1)), "{what}, {settings:?}");
        close_to(what, anchors(&found).similarity, 0.0);
    };
    for (without_anchors, expected, by_the_letter) in [
        (WithoutAnchors::Undecided, CandidateDecision::Undecided, ReasonCode::NoAnchors),
        (WithoutAnchors::Reject, CandidateDecision::Rejected, ReasonCode::NoAnchors),
        // By the letter geometry alone decides, and here it cannot run; of ours, a copy may look the same.
        (WithoutAnchors::Geometry, CandidateDecision::Undecided, ReasonCode::NoFeatures),
    ] {
        let ours = Settings { without_anchors, ..Settings::default() };
        let letter = Settings { without_anchors, ..to_the_letter() };
        for (settings, reason) in [(ours, ReasonCode::NoAnchors), (letter, by_the_letter)] {
            let exit = || vec![door("exit", AHEAD)];
            let check = |what: &str, query, candidate| {
                check(what, settings.clone(), query, candidate, (expected, reason));
            };
            check("neither sees an anchor", vec![], vec![]);
            check("the query sees none", vec![], plate());
            check("the candidate sees none", plate(), vec![]);
            check("what is not valid does not count", exit(), exit());
        }
    }
    let behind = || vec![door("910", [0.0, 0.0, -1.0])];
    let low = (CandidateDecision::Rejected, ReasonCode::ScoreBelowThreshold);
    check("both see one", to_the_letter(), plate(), behind(), low);
    let other = (CandidateDecision::Rejected, ReasonCode::Contradiction);
    check("both see one", Settings::default(), plate(), behind(), other);
}

#[test]
fn a_candidate_that_looks_far_less_alike_than_the_neighbours_leaves_nothing_undecided() {
    let check = |what: &str, settings: Settings, score: f64, sights: Vec<Thing>, expected: Decision| {
        let mut scene = Scene::with(settings);
        scene.put("candidate", keyframe().words(&[(1, score), (9, 1.0 - score)]).sees(sights.clone()));
        scene.put("neighbour", keyframe().words(&[(1, 1.0)]));
        scene.put("query", keyframe().words(&[(1, 1.0)]).covisible(&["neighbour"]).sees(sights));
        let verdict = scene.ask("query");
        let candidate = &verdict.candidates[0];
        assert_eq!(
            (verdict.decision, candidate.decision),
            (expected, CandidateDecision::Undecided),
            "{what}"
        );
        close_to(what, candidate.bow.reference_score, 1.0);
    };
    check("0.2 of 1", Settings::default(), 0.2, vec![], Decision::NoLoop);
    check("0.31 of 1", Settings::default(), 0.31, vec![], Decision::Undecided);
    check("the paper's letter", to_the_letter(), 0.2, vec![], Decision::Undecided);
    // Something agrees, and could be told to be this one.
    let slogan = vec![thing("sign", "Be Updated").at(AHEAD)];
    check("what agrees counts", Settings::default(), 0.2, slogan, Decision::Undecided);
}

#[test]
fn an_answer_is_undecided_if_any_candidate_is_and_none_is_a_loop() {
    let mut scene = Scene::new();
    scene.put("query", keyframe().sees(plate()));
    assert_eq!(scene.ask("query").decision, Decision::NoLoop);
    scene.put("other-room", keyframe().sees([door("910", AHEAD)]));
    assert_eq!(scene.ask("query").decision, Decision::NoLoop);
    scene.put("corridor", keyframe());
    assert_eq!(scene.ask("query").decision, Decision::Undecided);
    scene.put("same-room", keyframe().sees(plate()));
    assert_eq!(scene.ask("query").decision, Decision::Loop);
}

#[test]
fn an_anchor_not_described_yet_leaves_undecided_what_it_could_turn() {
    let name = |number: usize, position: [f64; 3]| thing("poster", NAMES[number]).at(position);
    let check = |what: &str,
                 query: Vec<Thing>,
                 candidate: Vec<Thing>,
                 pending: usize,
                 expected: Option<ReasonCode>| {
        let found = compared(&to_the_letter(), query.clone(), candidate.clone());
        assert_eq!(anchors(&found).pending, pending, "{what}");
        let decision = match expected {
            Some(ReasonCode::NotDescribed) => CandidateDecision::Undecided,
            Some(_) => CandidateDecision::Rejected,
            None => CandidateDecision::Loop,
        };
        assert_eq!((found.decision, code(&found)), (decision, expected), "{what}: {found:#?}");
        // By the sum, too, nothing is a loop by what nobody has read yet.
        let found = compared(&Settings::default(), query, candidate);
        let is_loop = found.decision == CandidateDecision::Loop;
        assert_eq!(is_loop, decision == CandidateDecision::Loop, "{what}: {found:#?}");
    };
    let open = Some(ReasonCode::NotDescribed);
    let no = Some(ReasonCode::ScoreBelowThreshold);
    check("the query's only one", vec![unread(AHEAD)], plate(), 1, open);
    check("the candidate's only one", plate(), vec![unread(AHEAD)], 1, open);
    check("both", vec![unread(AHEAD)], vec![unread(AHEAD)], 2, open);
    // At best (1 + 1) / (4 + 1 + 1) = 1/3.
    check("enough", vec![name(0, [0.25, 0.0, 0.0]), unread(AHEAD)], plate(), 1, open);
    // At best (1 + 1) / (5 + 1 + 1) = 2/7.
    check("too little", vec![name(0, [0.2, 0.0, 0.0]), unread(AHEAD)], plate(), 1, no);
    check("elsewhere", vec![name(0, [1.0, 0.0, 0.0]), unread([0.0, 0.0, -1.0])], plate(), 1, no);
    check("too far", vec![name(0, [1.0, 0.0, 0.0]), unread([0.0, 0.0, 2.0])], plate(), 1, no);
    let shelf = thing("shelf", "").at(AHEAD);
    check("another class", vec![name(0, [1.0, 0.0, 0.0]), shelf], plate(), 1, no);
    let beside = unread([0.0, 0.0, -1.0]);
    check("a loop already", vec![door("901", AHEAD), beside], plate(), 1, None);
}

/// 2/3, 1/3 and 2/3: 21 degrees from the first of three plates, 41 and 27 degrees from the others.
const BETWEEN: [f64; 3] = [2.0 / 3.0, 1.0 / 3.0, 2.0 / 3.0];

#[test]
fn the_effect_of_pending_anchors_is_measured_by_the_maps_own_reading_of_the_equation() {
    // Three plates of room 901 in the candidate's view, all in reach of the one in the query's that nobody has read; and
    // three posters that only the query sees. All are a metre away. To the letter the unread plate matches all three once
    // it is read: 3 (1 + 1) / (3 + 3 + 1) = 6/7; one-to-one it would be 2/7.
    let mut scene = Scene::with(to_the_letter());
    let plates = [[0.6, 0.0, 0.8], [0.0, 0.6, 0.8], [2.0 / 3.0, 2.0 / 3.0, 1.0 / 3.0]];
    let posters = [[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]];
    let posters = posters.iter().zip(NAMES).map(|(position, name)| thing("poster", name).at(*position));
    scene.put("candidate", keyframe().sees(plates.map(|position| door("901", position))));
    scene.put("query", keyframe().sees(posters.chain([unread(BETWEEN)])));
    assert_eq!(scene.compare("query", "candidate").decision, CandidateDecision::Undecided);
    let reads = keyframe().words(&[(7, 1.0)]).covisible(&["query"]).sees([door("901", BETWEEN)]);
    scene.put("query-2", reads);
    let after = scene.compare("query", "candidate");
    close_to("S once it is read", anchors(&after).similarity, 6.0 / 7.0);
    assert_eq!(after.decision, CandidateDecision::Loop);
}

#[test]
fn names_that_are_read_later_can_outweigh_another_name_at_one_spot() {
    let beside = [("905", [0.5, 0.0, 0.0]), ("907", [-0.5, 0.0, 0.0])];
    let mut scene = Scene::new();
    let known = beside.map(|(text, at)| door(text, at));
    scene.put("candidate", keyframe().sees([door("910", AHEAD)].into_iter().chain(known.clone())));
    let unread = beside.map(|(_, at)| unread(at));
    scene.put("query", keyframe().sees([door("901", AHEAD)].into_iter().chain(unread)));
    let before = scene.compare("query", "candidate");
    // M28: undecided is what a missing description could turn.
    assert_eq!(before.decision, CandidateDecision::Undecided, "{before:#?}");
    assert_eq!(terms(&before), [(EvidenceKind::OtherName, weights::OTHER_NAME)]);
    scene.put("query-2", keyframe().words(&[(7, 1.0)]).covisible(&["query"]).sees(known));
    let after = scene.compare("query", "candidate");
    assert_eq!(after.decision, CandidateDecision::Loop, "{after:#?}");
}

#[test]
fn verify_says_whether_geometry_may_or_must_run() {
    let mut scene = Scene::new();
    scene.put("same-room", keyframe().sees(plate()));
    scene.put("other-room", keyframe().sees([door("910", AHEAD)]));
    scene.put("query", keyframe().sees(plate()));
    let check = |verify: Verify, expected: Decision, of_same: (CandidateDecision, Option<ReasonCode>)| {
        let verdict = scene.ask_verifying("query", verify);
        assert_eq!(verdict.decision, expected, "{verify:?}");
        let of = |id: &str| candidate_of(&verdict, id).expect("it is a candidate");
        let same = of("same-room");
        assert_eq!((same.decision, code(&same)), of_same, "{verify:?}");
        // What the anchors stopped, geometry does not save.
        assert_eq!(code(&of("other-room")), Some(ReasonCode::Contradiction), "{verify:?}");
        for id in ["same-room", "other-room"] {
            let status = of(id).geometry.status;
            assert_eq!(status, GeometryStatus::Skipped, "{verify:?}: no keyframe has features");
        }
    };
    assert_eq!(Verify::default(), Verify::Auto);
    check(Verify::Auto, Decision::Loop, (CandidateDecision::Loop, None));
    check(Verify::Anchors, Decision::Loop, (CandidateDecision::Loop, None));
    let no_features = Some(ReasonCode::NoFeatures);
    check(Verify::Geometry, Decision::Undecided, (CandidateDecision::Undecided, no_features));
}

#[test]
fn no_answer_is_degraded_while_the_built_in_judge_is_all_there_is() {
    let mut scene = Scene::new();
    scene.put("kf-1", keyframe().sees(plate()));
    let verdict = scene.ask("kf-1");
    assert!(!verdict.degraded);
    assert_eq!(verdict.best, None);
    assert_eq!(verdict.loops, []);
}
