//! M64, the sum of evidence: what it says of a scene, and what it decides.

use revisit_core::domain::verdict::EvidenceKind::{
    self, Copy, DisplacedName, Name, Neighbour, Odometry, SharedName, Texts,
};
use revisit_core::recognition::odds::log_odds::LogOdds;
use revisit_core::recognition::odds::weights;
use revisit_core::{Candidate, CandidateDecision, Decision, ReasonCode, Settings};

use super::equation::compared;
use super::scene::{Keyframe, Scene, Thing, code, confidence, door, ids, keyframe, terms, thing};

/// A scene's sum and its answer.
#[track_caller]
fn is_told(
    what: &str,
    found: &Candidate,
    told: &[(EvidenceKind, LogOdds)],
    (decision, reason): (CandidateDecision, Option<ReasonCode>),
) {
    assert_eq!(terms(found), told, "{what}: {found:#?}");
    assert_eq!((found.decision, code(found)), (decision, reason), "{what}: {found:#?}");
}

const LOOP: (CandidateDecision, Option<ReasonCode>) = (CandidateDecision::Loop, None);

/// A name that is read here and there.
const NAME: (EvidenceKind, LogOdds) = (Name, weights::NAME);

/// Signs of the query that the candidate lacks.
fn absent(signs: usize) -> (EvidenceKind, LogOdds) {
    (EvidenceKind::Absent, weights::ABSENT * signs)
}

const fn undecided(reason: ReasonCode) -> (CandidateDecision, Option<ReasonCode>) {
    (CandidateDecision::Undecided, Some(reason))
}

/// A metre ahead.
fn sign(text: &str) -> Thing {
    thing("sign", text).at([0.0, 0.0, 1.0])
}

/// To the right of that.
fn beside(class: &str, text: &str) -> Thing {
    thing(class, text).at([0.5, 0.0, 1.0])
}

#[test]
fn one_sure_plate_is_a_loop_and_what_a_copy_of_the_place_would_show_is_none() {
    let settings = Settings::default();
    let check = |what: &str, sights: &[Thing], told: &[(EvidenceKind, LogOdds)], expected| {
        let found = compared(&settings, sights.to_vec(), sights.to_vec());
        is_told(what, &found, told, expected);
    };
    let plate = || door("901", [0.0, 0.0, 1.0]);
    let slogan = || sign("Be Updated");
    let picture = || sign("a painting of a sailing boat before a windmill");
    let a_copy_shows_it = undecided(ReasonCode::TooLittleEvidence);
    check("one sure plate, in a map of one keyframe", &[plate()], &[NAME], LOOP);
    let two = [NAME, NAME, (Neighbour, -(weights::NAME * 2 - weights::HERE))];
    check(
        "two plates say no more than that it is near",
        &[plate(), beside("door_number", "903")],
        &two,
        LOOP,
    );
    check(
        "a plate beside a slogan",
        &[plate(), beside("sign", "Be Updated")],
        &[NAME, (Texts, weights::TEXT)],
        LOOP,
    );
    check("a slogan", &[slogan()], &[(Texts, weights::TEXT)], a_copy_shows_it);
    let slogans = [slogan(), beside("sign", "Library Corner")];
    check(
        "two slogans",
        &slogans,
        &[(Texts, weights::TEXT * 2), (Copy, weights::NO_COPY - weights::TEXT * 2)],
        a_copy_shows_it,
    );
    check(
        "a picture",
        &[picture()],
        &[(Texts, weights::DESCRIPTION), (Copy, weights::NO_COPY - weights::DESCRIPTION)],
        a_copy_shows_it,
    );
    let floor = [sign("Library Corner, level 5")];
    check("a floor is no own number", &floor, &[(Texts, weights::TEXT)], a_copy_shows_it);
}

#[test]
fn a_plate_alone_among_signs_that_the_place_lacks_is_no_loop() {
    let settings = Settings::default();
    let plate = || door("901", [0.0, 0.0, 1.0]);
    let notices = ["Be Updated", "Library Corner", "Faculty Club", "Career Centre"];
    for (missing, decision) in [(1, LOOP), (3, LOOP), (4, undecided(ReasonCode::TooLittleEvidence))] {
        let signs = || {
            let notices = notices[..missing].iter().enumerate();
            let placed = notices.map(|(at, text)| sign(text).at([at as f64, 1.0, 3.0]));
            placed.chain([plate()]).collect::<Vec<_>>()
        };
        let found = compared(&settings, signs(), vec![plate()]);
        is_told(&format!("{missing} only in the query"), &found, &[NAME, absent(missing)], decision);
        // The place may have been read from farther away: its own signs that the query lacks say nothing.
        let found = compared(&settings, vec![plate()], signs());
        is_told(&format!("{missing} only in the candidate"), &found, &[NAME], LOOP);
    }
}

#[test]
fn a_notice_is_no_loop_in_any_language() {
    for notice in [
        "Prière de fermer doucement cette porte",
        "本室設備使用後請歸還原位",
        "Kérjük az ajtót mindig csukva tartani",
    ] {
        let found = compared(&Settings::default(), [sign(notice)], [sign(notice)]);
        assert_eq!(found.decision, CandidateDecision::Undecided, "{notice}: {found:#?}");
        assert!(confidence(&found) < 0.67, "{notice}");
    }
}

#[test]
fn texts_that_agree_close_no_loop_where_nothing_repeats_either() {
    let settings = Settings { building_repeats: false, ..Settings::default() };
    let picture = || sign("a painting of a sailing boat before a windmill");
    let found = compared(&settings, [picture()], [picture()]);
    is_told("a picture", &found, &[(Texts, weights::DESCRIPTION)], undecided(ReasonCode::TooLittleEvidence));
}

#[test]
fn a_loop_is_what_reaches_the_confidence_asked_for() {
    // 5.3 is 0.99503, 6.9 is 0.99899.
    let plate = || door("901", [0.0, 0.0, 1.0]);
    let check = |asked: f64, sights: &[Thing], decision: CandidateDecision| {
        let settings = Settings { loop_min_confidence: asked, ..Settings::default() };
        let found = compared(&settings, sights.to_vec(), sights.to_vec());
        assert_eq!(found.decision, decision, "{asked}: {found:#?}");
    };
    let two = || [plate(), beside("door_number", "903")];
    check(0.995, &[plate()], CandidateDecision::Loop);
    check(0.996, &[plate()], CandidateDecision::Undecided);
    check(0.996, &two(), CandidateDecision::Loop);
    check(0.999, &two(), CandidateDecision::Undecided);
    check(0.66, &[sign("a painting of a sailing boat before a windmill")], CandidateDecision::Loop);
}

#[test]
fn a_name_that_a_reader_was_not_confident_of_is_no_loop_alone() {
    // Each is read once; where two keyframes read alike, the text is valid.
    let unsure = || door("901", [0.0, 0.0, 1.0]).confidence(0.6);
    let sure = || door("901", [0.0, 0.0, 1.0]);
    for (query, candidate) in [(unsure(), unsure()), (unsure(), sure()), (sure(), unsure())] {
        let found = compared(&Settings::default(), [query], [candidate]);
        assert_eq!(found.decision, CandidateDecision::Undecided, "{found:#?}");
        assert_eq!(terms(&found), [(Name, weights::NAME_DOUBTFUL)]);
    }
}

#[test]
fn a_name_on_both_sides_of_the_camera_is_displaced() {
    let ahead = door("901", [0.0, 0.0, 2.0]);
    let found = compared(&Settings::default(), [ahead], [door("901", [0.0, 0.0, -2.0])]);
    let rejected = (CandidateDecision::Rejected, Some(ReasonCode::AnchorsDisplaced));
    is_told("behind", &found, &[(DisplacedName, weights::DISPLACED_BY_BEARING)], rejected);
}

#[test]
fn a_name_that_hangs_in_two_places_adds_nothing_to_a_picture() {
    let mut scene = Scene::new();
    let sights =
        |x: f64| [door("901", [x, 0.0, 2.0]), sign("a painting of a sailing boat").at([x + 1.0, 0.0, 2.0])];
    for (id, x) in [("here", 0.0), ("there", 50.0)] {
        scene.put(id, keyframe().session("first").at([x, 0.0, 0.0]).sees(sights(x)));
    }
    scene.put("query", keyframe().session("second").sees(sights(0.0)));
    let found = scene.compare("query", "here");
    assert!(terms(&found).contains(&(SharedName, LogOdds::EVEN)), "{found:#?}");
    assert_eq!(found.decision, CandidateDecision::Undecided, "{found:#?}");
    assert!(confidence(&found) < 0.67, "{found:#?}");
}

/// A keyframe at x on a way whose neighbours share fifteen points; the ends share none.
fn on_the_way(x: f64, first_point: i64) -> Keyframe {
    keyframe().at([x, 0.0, 0.0]).observes(first_point..first_point + 30)
}

#[test]
fn odometry_over_an_unbroken_chain_stops_a_plate_that_hangs_too_far_away() {
    let check = |what: &str, chain: bool, back_m: f64, told: &[(EvidenceKind, LogOdds)], decision| {
        let mut scene = Scene::new();
        let sees = |x: f64| [door("901", [x, 0.0, 1.0])];
        scene.put("candidate", on_the_way(0.0, 0).stamp(0).sees(sees(0.0)));
        // So many that neither end's local anchor map holds what the other sees.
        for (number, x) in (0..).zip([5.0, 10.0, back_m]) {
            let first_point = if chain || number != 1 { 15 * (number + 1) } else { 1_000 };
            scene.put(&format!("between-{number}"), on_the_way(x, first_point).stamp(number + 1));
        }
        scene.put("query", on_the_way(back_m, 60).stamp(4).sees(sees(back_m)));
        let found = scene.compare("query", "candidate");
        assert_eq!(terms(&found), told, "{what}: {found:#?}");
        assert_eq!(found.decision, decision, "{what}: {found:#?}");
    };
    check("back at the plate", true, 0.9, &[NAME], CandidateDecision::Loop);
    // 3 m and 5 % of 10 m.
    check("too far", true, 10.0, &[NAME, (Odometry, weights::ELSEWHERE)], CandidateDecision::Undecided);
    check("the chain is broken", false, 10.0, &[NAME], CandidateDecision::Loop);
}

#[test]
fn a_name_that_two_far_places_bear_tells_neither_and_one_name_more_tells_which() {
    let check = |what: &str, session: &str, loops: &[&str]| {
        let mut scene = Scene::new();
        let plates = |x: f64| [door("901", [x, 0.0, 2.0]), door("905", [x + 2.0, 0.0, 2.0])];
        scene.put("one", keyframe().session("one").sees(plates(0.0).into_iter().take(1)));
        let far = keyframe().session(session).at([50.0, 0.0, 0.0]);
        scene.put("other", far.sees(plates(50.0)));
        scene.put("query", keyframe().session("now").sees(plates(0.0)));
        let mut found = ids(&scene.ask("query").loops);
        found.sort_unstable();
        assert_eq!(found, loops, "{what}: {:#?}", scene.ask("query"));
    };
    check("in one frame, 50 m apart", "one", &["other"]);
    check("in two frames, which may be one place", "two", &["one", "other"]);
}

#[test]
fn two_places_that_agree_by_different_names_leave_the_answer_open() {
    let sights = |text: &str, x: f64| [door(text, [x, 0.0, 2.0])];
    let mut scene = Scene::new();
    scene.put("one", keyframe().session("one").sees(sights("901", 0.0)));
    let query = [sights("901", 0.0), sights("905", 2.0)].concat();
    scene.put("query", keyframe().session("now").sees(query));
    assert_eq!(ids(&scene.ask("query").best), ["one"]);
    scene.put("other", keyframe().session("other").sees(sights("905", 2.0)));
    let verdict = scene.ask("query");
    assert_eq!((verdict.decision, verdict.best), (Decision::Undecided, None));
    for candidate in &verdict.candidates {
        is_told(
            "a rival",
            candidate,
            &[NAME, absent(1), (EvidenceKind::Rival, -(weights::NAME + weights::ABSENT))],
            undecided(ReasonCode::AmbiguousPlaces),
        );
    }
    // The strongest rival counts.
    let mut three = scene.clone();
    let query = [sights("901", 0.0), sights("905", 2.0), sights("907", -2.0), sights("909", -4.0)].concat();
    three.put("query-of-four", keyframe().session("then").sees(query));
    three.put("third", keyframe().session("third").sees([sights("907", -2.0), sights("909", -4.0)].concat()));
    let rival = (EvidenceKind::Rival, -weights::HERE);
    let open = undecided(ReasonCode::AmbiguousPlaces);
    is_told("the strongest", &three.compare("query-of-four", "one"), &[NAME, absent(3), rival], open);
    // Somebody knows that the two are one place.
    scene.close("l-1", "other", "one");
    assert_eq!(ids(&scene.ask("query").loops), ["one"]);
}

#[test]
fn an_undecided_answer_says_what_to_look_for() {
    let mut scene = Scene::new();
    let slogan = || thing("sign", "Be Updated").at([0.0, 0.0, 2.0]);
    scene.put("one", keyframe().session("one").sees([slogan(), door("901", [1.0, 0.0, 2.0])]));
    scene.put("other", keyframe().session("other").sees([slogan(), door("903", [1.0, 0.0, 2.0])]));
    scene.put("query", keyframe().session("now").sees([slogan()]));
    let verdict = scene.ask("query");
    assert_eq!(verdict.decision, Decision::Undecided);
    let told = verdict
        .look_for
        .iter()
        .map(|found| (verdict.candidates[found.place].keyframe.as_str(), found.sign.description.as_str()));
    assert_eq!(told.collect::<Vec<_>>(), [("one", "901"), ("other", "903")]);
    assert!(verdict.why.ends_with("Look for 901."), "{}", verdict.why);
    // Once it is read, the answer is a loop, and there is nothing to look for.
    scene.put("later", keyframe().session("now").sees([slogan(), door("901", [1.0, 0.0, 2.0])]));
    let verdict = scene.ask("later");
    assert_eq!((verdict.decision, verdict.look_for), (Decision::Loop, vec![]));
}

#[test]
fn places_that_read_one_name_on_two_signs_are_no_rivals() {
    let mut scene = Scene::new();
    let [left, right] = [[-1.5, 0.0, 2.0], [1.5, 0.0, 2.0]].map(|at| door("901", at));
    scene.put("one", keyframe().session("one").sees([left.clone()]));
    scene.put("other", keyframe().session("other").sees([right.clone()]));
    scene.put("query", keyframe().session("now").sees([left, right]));
    let verdict = scene.ask("query");
    let mut loops = ids(&verdict.loops);
    loops.sort_unstable();
    assert_eq!(loops, ["one", "other"], "{verdict:#?}");
}
