//! §V, checks 1 and 2: covisible keyframes are excluded, bag of words chooses (M9), places are counted (M34).

use revisit_core::domain::channel::{Channel, ProposedBy};
use revisit_core::{CandidateDecision, Decision, Features, Keypoint, ReasonCode, Settings};

use super::scene::{
    Keyframe, NAMES, Scene, candidates, close_to, code, door, ids, keyframe, reason, thing, to_the_letter,
    told,
};

/// Five features of 8 zero bytes, seeing the points 11 to 15.
fn features() -> Features {
    let at = |at: f64| Keypoint { u: at, v: at, octave: 0, angle_deg: None };
    Features {
        descriptor_bytes: 8,
        descriptors: vec![0; 40],
        keypoints: [1.0, 2.0, 3.0, 4.0, 5.0].map(at).to_vec(),
        map_points: (11..=15).map(Some).collect(),
    }
}

#[test]
fn a_covisible_keyframe_is_excluded_and_counted() {
    let first = || keyframe().observes(1..=15);
    let declared = |shared: u32| keyframe().sharing(&["kf-1"], shared);
    let check_with = |settings: Settings, what: &str, query: Keyframe, excluded: bool| {
        let mut scene = Scene::with(settings);
        scene.put("kf-1", first());
        let stored = scene.put("kf-2", query);
        let verdict = scene.ask("kf-2");
        let expected: &[&str] = if excluded { &[] } else { &["kf-1"] };
        assert_eq!(candidates(&verdict), expected, "{what}");
        assert_eq!(verdict.excluded_covisible, usize::from(excluded), "{what}");
        let degree = scene.map().covisibility().degree(stored.keyframe);
        assert_eq!(degree, usize::from(excluded), "{what}");
        let expected = |id: &str| if excluded { vec![id.to_owned()] } else { vec![] };
        assert_eq!(scene.covisible("kf-2"), expected("kf-1"), "{what}");
        assert_eq!(scene.covisible("kf-1"), expected("kf-2"), "{what}: it is symmetric");
    };
    let check = |what: &str, query: Keyframe, excluded: bool| {
        check_with(Settings::default(), what, query, excluded);
    };
    check("nothing in common", keyframe(), false);
    check("15 common map points", keyframe().observes(1..=15), true);
    check("14 common map points", keyframe().observes(2..=15), false);
    check("14, one of them twice", keyframe().observes((2..=15).chain([2])), false);
    let fourteen = Settings { covisibility_min_shared_points: 14, ..Settings::default() };
    check_with(fourteen, "14, where 14 suffice", keyframe().observes(2..=15), true);
    check("10 listed and 5 seen by features", keyframe().observes(1..=10).features(features()), true);
    check("9 listed and 5 seen by features", keyframe().observes(2..=10).features(features()), false);
    check("declared", declared(40), true);
    check("declared with nothing shared", declared(0), true);
    check("declared across sessions", declared(40).session("other-day"), true);
    let of_another = keyframe().observes(1..=15).session("other-day");
    check("the same points of another session", of_another, false);
}

#[test]
fn the_number_of_shared_points_that_suffices_can_be_changed_later() {
    let mut scene = Scene::new();
    scene.put("kf-1", keyframe().observes(1..=20));
    scene.put("kf-2", keyframe().observes(11..=30));
    for (enough, covisible) in [(10, 1), (11, 0), (1, 1)] {
        scene.set(|settings| settings.covisibility_min_shared_points = enough);
        assert_eq!(scene.covisible("kf-1").len(), covisible, "{enough}");
        assert_eq!(scene.ask("kf-2").excluded_covisible, covisible, "{enough}");
    }
    assert_eq!(scene.shared("kf-1"), [("kf-2".to_owned(), 10)]);
}

#[test]
fn the_score_is_the_sum_over_common_words_of_the_smaller_weight() {
    let mut scene = Scene::new();
    let words: [(&str, &[(u32, f64)]); 5] = [
        ("both", &[(1, 0.25), (2, 0.75)]),
        ("one", &[(3, 1.0)]),
        ("not-normalised", &[(1, 50.0), (2, 30.0), (3, 20.0)]),
        ("order", &[(9, 4.0), (2, 4.0)]),
        ("none", &[(4, 1.0)]),
    ];
    for (id, words) in words {
        scene.put(id, keyframe().words(words));
    }
    scene.put("query", keyframe().words(&[(1, 0.5), (2, 0.3), (3, 0.2)]));
    let check = |id: &str, score: f64, common: u32| {
        let bow = scene.compare("query", id).bow;
        close_to(id, bow.score, score);
        assert_eq!(bow.common_words, common, "{id}");
    };
    check("both", 0.25 + 0.3, 2);
    check("one", 0.2, 1);
    check("not-normalised", 1.0, 3);
    check("order", 0.3, 1);
    // All that share a word, and no other.
    assert_eq!(scene.ask("query").candidates.len(), 4);
}

#[test]
fn the_reference_score_is_the_lowest_against_the_covisible_keyframes() {
    let mut scene = Scene::new();
    let covisible: [(&str, &[(u32, f64)]); 3] =
        [("half", &[(1, 1.0)]), ("quarter", &[(2, 1.0)]), ("wall", &[])];
    for (id, words) in covisible {
        scene.put(id, keyframe().words(words));
    }
    scene.put("candidate", keyframe().words(&[(3, 1.0)]));
    let query = || keyframe().words(&[(1, 0.5), (2, 0.25), (3, 0.25)]);
    let mut check = |id: &str, covisible: &[&str], expected: f64| {
        scene.put(id, query().covisible(covisible));
        close_to(id, scene.compare(id, "candidate").bow.reference_score, expected);
    };
    check("alone", &[], 0.0);
    check("one", &["half"], 0.5);
    check("two", &["half", "quarter"], 0.25);
    check("three", &["half", "quarter", "wall"], 0.0);
}

#[test]
fn a_candidate_must_score_its_share_of_the_reference_only_if_a_share_is_set() {
    // The reference is 1/2; the candidates score 1/2 and 1/4.
    for (ratio, limit, weak_passes) in
        [(0.0, 0.0, true), (0.5, 0.25, true), (0.75, 0.375, false), (1.0, 0.5, false)]
    {
        let mut scene = Scene::with(Settings { candidates_min_score_ratio: ratio, ..Settings::default() });
        let plate = || [door("901", [0.0, 0.0, 2.0])];
        scene.put("before", keyframe().words(&[(1, 1.0)]));
        scene.put("strong", keyframe().words(&[(2, 0.5), (8, 0.5)]).sees(plate()));
        scene.put("weak", keyframe().words(&[(2, 0.25), (9, 0.75)]).sees(plate()));
        scene.put("query", keyframe().words(&[(1, 0.5), (2, 0.5)]).covisible(&["before"]).sees(plate()));
        assert_eq!(scene.compare("query", "strong").decision, CandidateDecision::Loop, "{ratio}");
        let weak = scene.compare("query", "weak");
        if weak_passes {
            assert_eq!(weak.decision, CandidateDecision::Loop, "{ratio}");
        } else {
            assert_eq!(weak.decision, CandidateDecision::Rejected, "{ratio}");
            assert_eq!(code(&weak), Some(ReasonCode::BowBelowReference), "{ratio}");
            told("measured", reason(&weak).measured, 0.25);
            told("limit", reason(&weak).limit, limit);
        }
    }
}

#[test]
fn the_share_of_the_reference_is_asked_of_bag_of_words_candidates_and_not_of_those_that_anchors_propose() {
    let mut scene = Scene::with(Settings { candidates_min_score_ratio: 0.5, ..Settings::default() });
    let plate = || [door("901", [0.0, 0.0, 2.0])];
    scene.put("before", keyframe().words(&[(1, 1.0)]));
    scene.put("no-word", keyframe().words(&[(9, 1.0)]).sees(plate()));
    scene.put("query", keyframe().words(&[(1, 1.0)]).covisible(&["before"]).sees(plate()));
    // M9: a share of the reference score is asked of candidates by words; §III: an anchor seen before triggers.
    assert_eq!(scene.compare("query", "no-word").decision, CandidateDecision::Loop);
}

/// Keyframes `(id, score, covisible before it)` and a query with the word 1 alone.
fn ranked(candidates_max: u32, keyframes: &[(&str, f64, &[&str])]) -> Vec<String> {
    let mut scene = Scene::with(Settings { candidates_max, ..Settings::default() });
    for ((id, score, covisible), own_word) in keyframes.iter().zip(100..) {
        scene.put(id, keyframe().words(&[(1, *score), (own_word, 1.0 - *score)]).covisible(covisible));
    }
    scene.put("query", keyframe().words(&[(1, 1.0)]));
    candidates(&scene.ask("query"))
}

#[test]
fn places_are_counted_greedily_from_the_best_by_direct_covisibility() {
    let check = |what: &str, candidates_max: u32, keyframes: &[(&str, f64, &[&str])], expected: &[&str]| {
        assert_eq!(ranked(candidates_max, keyframes), expected, "{what}");
    };
    let chain = |scores: [f64; 4]| -> [(&str, f64, &[&str]); 4] {
        let [a, b, c, d] = scores;
        [("kf-1", a, &[]), ("kf-2", b, &["kf-1"]), ("kf-3", c, &["kf-2"]), ("kf-7", d, &[])]
    };
    check("the middle stands for its chain", 20, &chain([0.5, 0.9, 0.7, 0.1]), &["kf-2", "kf-7"]);
    check("its end leaves the other end", 20, &chain([0.9, 0.7, 0.5, 0.1]), &["kf-1", "kf-3", "kf-7"]);
    check("two places", 2, &chain([0.9, 0.7, 0.5, 0.1]), &["kf-1", "kf-3"]);
    check("one place", 1, &chain([0.9, 0.7, 0.5, 0.1]), &["kf-1"]);
    check("equal scores go to the smallest id", 1, &[("kf-5", 0.5, &[]), ("kf-4", 0.5, &[])], &["kf-4"]);
}

#[test]
fn each_channel_brings_its_own_places() {
    let mut scene = Scene::with(Settings { candidates_max: 1, ..Settings::default() });
    let plate = |x: f64| [door("901", [x, 0.0, 2.0])];
    scene.put("word-1", keyframe().words(&[(1, 0.75), (5, 0.25)]));
    scene.put("word-2", keyframe().words(&[(1, 0.5), (6, 0.5)]));
    scene.put("door-1", keyframe().words(&[(7, 1.0)]).sees(plate(0.0)));
    scene.put("door-2", keyframe().words(&[(8, 1.0)]).sees(plate(9.0)));
    scene.put("query", keyframe().words(&[(1, 1.0)]).sees(plate(0.0)));
    let mut found = candidates(&scene.ask("query"));
    found.sort();
    assert_eq!(found, ["door-1", "word-1"]);
}

#[test]
fn a_blank_wall_has_no_candidates_is_none_and_is_undecided_unless_an_anchor_proposes_one() {
    let mut scene = Scene::new();
    scene.put("wall", keyframe().words(&[]));
    scene.put("other-wall", keyframe().words(&[]));
    scene.put("kf-1", keyframe().sees([door("901", [0.0, 0.0, 2.0])]));
    scene.put("kf-2", keyframe());
    let verdict = scene.ask("wall");
    assert_eq!(verdict.decision, Decision::Undecided);
    assert_eq!(verdict.reason.map(|reason| reason.code), Some(ReasonCode::EmptyBow));
    assert_eq!(verdict.candidates, []);
    assert_eq!(candidates(&scene.ask("kf-1")), ["kf-2"]);

    scene.put("wall-with-door", keyframe().words(&[]).sees([door("901", [0.0, 0.0, 2.0])]));
    let verdict = scene.ask("wall-with-door");
    assert_eq!(ids(&verdict.best), ["kf-1"], "{verdict:#?}");
}

#[test]
fn the_best_loop_has_the_largest_s_then_the_best_score_then_the_smallest_id() {
    let mut scene = Scene::new();
    let plate = || door("901", [0.0, 0.0, 2.0]);
    // (1/2 + 1/2) / (1/2 + 1/2 + 1/2) = 2/3 where a name hangs beside the door.
    let more = thing("poster", NAMES[0]).at([2.0, 0.0, 0.0]);
    let half = [(1, 0.5), (9, 0.5)];
    scene.put("kf-d", keyframe().sees([plate(), more]));
    scene.put("kf-b", keyframe().words(&half).sees([plate()]));
    scene.put("kf-a", keyframe().words(&half).sees([plate()]));
    scene.put("kf-c", keyframe().sees([plate()]));
    scene.put("query", keyframe().sees([plate()]));
    let verdict = scene.ask("query");
    assert_eq!(ids(&verdict.best), ["kf-c"], "{verdict:#?}");
    assert_eq!(ids(&verdict.loops), ["kf-c", "kf-a", "kf-b", "kf-d"]);
}

#[test]
fn a_keyframe_of_the_session_taken_just_before_is_no_candidate_where_the_map_says_so() {
    let too_recent = |limit: f64| Some((ReasonCode::TooRecent, Some(1.0), Some(limit)));
    let check = |what: &str, gap_s: f64, session: &str, expected: &[&str], reason| {
        let mut scene = Scene::with(Settings { candidates_min_gap_s: gap_s, ..Settings::default() });
        scene.put("kf-1", keyframe().stamp(100).session("today"));
        scene.put("kf-2", keyframe().stamp(130).session(session));
        let verdict = scene.ask("kf-2");
        assert_eq!(candidates(&verdict), expected, "{what}");
        let got = verdict.reason.map(|reason| (reason.code, reason.measured, reason.limit));
        assert_eq!(got, reason, "{what}");
    };
    check("off by default", 0.0, "today", &["kf-1"], None);
    check("30 s before, where 30 s suffice", 30.0, "today", &["kf-1"], None);
    check("30 s before, where more is asked for", 30.5, "today", &[], too_recent(30.5));
    check("by another session's clock", 30.5, "other-day", &["kf-1"], None);
}

#[test]
fn images_that_are_alike_as_a_whole_are_candidates_whatever_their_words() {
    let map = |settings: Settings| {
        let mut scene = Scene::with(settings);
        scene.put("alike", keyframe().words(&[(7, 1.0)]).global(&[100, 90, -80, 3]));
        scene.put("less", keyframe().words(&[]).global(&[100, -90, -80, 3]));
        scene.put("opposite", keyframe().words(&[]).global(&[-100, -90, 80, -3]));
        scene.put("words", keyframe().words(&[(1, 1.0)]));
        scene.put("query", keyframe().words(&[(1, 1.0)]).global(&[50, 45, -40, 2]));
        scene
    };
    let by =
        |scene: &Scene, id: &str| scene.compare("query", id).proposed.expect("the query has a descriptor");
    let scene = map(Settings::default());
    let mut found = candidates(&scene.ask("query"));
    found.sort_unstable();
    assert_eq!(found, ["alike", "less", "words"]);
    assert_eq!(by(&scene, "alike").channels, [Channel::Global]);
    assert_eq!(by(&scene, "words"), ProposedBy { channels: vec![Channel::Bow], similarity: None });
    for (id, cosine) in [("alike", 1.0), ("less", 4156.0 / (24509.0_f64 * 6129.0).sqrt())] {
        let similarity = by(&scene, id).similarity.expect("both have one");
        assert!((similarity - cosine).abs() < 1e-3, "{id}: {similarity}");
    }
    let letter = map(to_the_letter()).ask("query");
    assert_eq!(candidates(&letter), ["words"], "the paper knows words alone");
    assert_eq!(letter.candidates[0].proposed, None);
}

#[test]
fn a_global_descriptor_is_gone_with_its_keyframe_and_excluded_with_its_neighbours() {
    let mut scene = Scene::new();
    for id in ["gone", "near", "far"] {
        scene.put(id, keyframe().words(&[]).global(&[1, 2, 3]));
    }
    scene.put("query", keyframe().words(&[]).global(&[1, 2, 3]).covisible(&["near"]));
    scene.cull("gone");
    assert_eq!(candidates(&scene.ask("query")), ["far"]);
}
