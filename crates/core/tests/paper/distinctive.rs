//! M6, distinctive weights: what stands in p places weighs (1/d) / p.

use revisit_core::domain::method::Method;
use revisit_core::domain::verdict::EvidenceKind;
use revisit_core::recognition::odds::log_odds::LogOdds;
use revisit_core::{Candidate, CandidateDecision, ReasonCode, Settings};

use super::scene::{Scene, anchors, close_to, code, door, keyframe, reason, terms, thing, told};

/// Settings by which EXIT is a valid description.
fn exit_counts() -> Settings {
    Settings { description_min_information_level: 2, ..Settings::default() }
}

/// Something with this text hangs 2 m from a keyframe of its own, at each of these x.
fn hang(scene: &mut Scene, session: &str, class: &str, text: &str, xs: impl IntoIterator<Item = f64>) {
    for (number, x) in xs.into_iter().enumerate() {
        let id = format!("{session}-{class}-{}-{number}", text.replace(' ', "-"));
        let sight = thing(class, text).at([x, 0.0, 2.0]);
        scene.put(&id, keyframe().session(session).at([x, 0.0, 0.0]).words(&[(99, 1.0)]).sees([sight]));
    }
}

/// The weight of what the keyframe sees.
fn weight(scene: &Scene, keyframe: &str) -> f64 {
    scene.local_map(keyframe)[0].weight
}

/// What hangs elsewhere: session, class, text, and each x.
type Others<'a> = &'a [(&'a str, &'a str, &'a str, &'a [f64])];

#[test]
fn a_description_that_stands_in_p_places_weighs_a_pth() {
    let check_with = |settings: Settings, what: &str, others: Others<'_>, places: f64| {
        let mut scene = Scene::with(settings);
        hang(&mut scene, "here", "sign", "EXIT", [0.0]);
        for (session, class, text, xs) in others {
            hang(&mut scene, session, class, text, xs.iter().copied());
        }
        close_to(what, weight(&scene, "here-sign-EXIT-0"), 0.5 / places);
    };
    let check = |what: &str, others: Others<'_>, places: f64| check_with(exit_counts(), what, others, places);
    check("it hangs once", &[], 1.0);
    check("it hangs at three more places", &[("here", "sign", "exit", &[10.0, 20.0, 30.0])], 4.0);
    check("exactly 3 m apart is one place", &[("here", "sign", "exit", &[3.0])], 1.0);
    check("more than 3 m apart are two", &[("here", "sign", "exit", &[3.01])], 2.0);
    let radius = Settings { distinctive_place_radius_m: 2.9, ..exit_counts() };
    check_with(radius, "another radius", &[("here", "sign", "exit", &[3.0])], 2.0);
    let off = Settings { method: Method::Paper, ..exit_counts() };
    check_with(off, "the paper's", &[("here", "sign", "exit", &[10.0, 20.0])], 1.0);
    check("other texts are not counted", &[("here", "sign", "toilet", &[10.0, 20.0])], 1.0);
    check("other classes are not counted", &[("here", "poster", "EXIT", &[10.0, 20.0])], 1.0);
    // Frames of different sessions cannot be compared: the largest count of any one of them, 3, and not 1 + 3.
    check("the largest of the sessions", &[("there", "sign", "exit", &[0.0, 10.0, 20.0])], 3.0);
    check("and not the smaller", &[("there", "sign", "exit", &[50.0])], 1.0);
}

#[test]
fn an_anchor_counts_with_those_it_matches() {
    let mut scene = Scene::new();
    hang(&mut scene, "here", "door_number", "901", [0.0]);
    hang(&mut scene, "here", "door_number", "room 901", [10.0]);
    hang(&mut scene, "here", "door_number", "910", [20.0]);
    close_to("901 and room 901", weight(&scene, "here-door_number-901-0"), 0.25);
    close_to("910", weight(&scene, "here-door_number-910-0"), 0.5);
}

/// Two passages 10 m apart, at which a sign and a door hang a metre from the camera, alike as the camera sees them.
fn signs_and_doors(settings: Settings, doors: [&str; 2], more_signs: usize) -> Candidate {
    let mut scene = Scene::with(settings);
    for (id, x, plate) in [("candidate", 0.0, doors[0]), ("query", 10.0, doors[1])] {
        let sights = [thing("sign", "EXIT").at([x, 0.0, 1.0]), door(plate, [x + 1.0, 0.0, 0.0])];
        scene.put(id, keyframe().at([x, 0.0, 0.0]).sees(sights));
    }
    hang(&mut scene, "default", "sign", "EXIT", (0..more_signs).map(|n| 20.0 + 10.0 * n as f64));
    scene.compare("query", "candidate")
}

#[test]
fn a_sign_at_every_door_makes_a_loop_of_two_rooms_by_the_letter_alone() {
    use CandidateDecision::{Loop, Rejected};
    let check = |what: &str, method: Method, doors: [&str; 2], more_signs: usize, expected: (f64, _)| {
        let found = signs_and_doors(Settings { method, ..exit_counts() }, doors, more_signs);
        close_to(what, anchors(&found).similarity, expected.0);
        assert_eq!(found.decision, expected.1, "{what}: {found:#?}");
    };
    // The paper's: (1 + 1) / 4, a loop between two rooms.
    check("equal weights", Method::Paper, ["901", "902"], 22, (0.5, Loop));
    // Signs weigh 1/24: (2/24) / (2/24 + 2) = 1/25.
    check("an EXIT sign at 24 doors", Method::Revisit, ["901", "902"], 22, (0.04, Rejected));
    // Signs weigh 1/2: (1/2 + 1/2) / (1/2 + 1 + 1/2 + 1) = 1/3.
    check("at two doors only", Method::Revisit, ["901", "902"], 0, (1.0 / 3.0, Rejected));
    // The door is one of a kind wherever it is seen, but here it is seen 10 m from itself: p = 2 for both.
    check(
        "the same door, by a map that has drifted by 10 m",
        Method::Revisit,
        ["901", "901"],
        22,
        (1.0, Loop),
    );
}

#[test]
fn a_name_that_hangs_in_several_places_tells_none_of_them() {
    let mut scene = Scene::new();
    hang(&mut scene, "here", "door_number", "901", [0.0, 10.0]);
    let sight = [door("901", [0.0, 0.0, 2.0])];
    scene.put("query", keyframe().session("there").words(&[(99, 1.0)]).sees(sight));
    let found = scene.compare("query", "here-door_number-901-0");
    assert_eq!(found.decision, CandidateDecision::Undecided);
    assert_eq!(code(&found), Some(ReasonCode::NotDistinctive));
    assert_eq!(terms(&found), [(EvidenceKind::SharedName, LogOdds::EVEN)]);
    told("confidence", reason(&found).measured, 0.5);
    told("confidence, at least", reason(&found).limit, 0.99);
}

#[test]
fn the_weight_of_a_pair_is_the_sum_of_the_two_distinctive_weights() {
    let found = signs_and_doors(exit_counts(), ["901", "902"], 2);
    // p = 4: 1/4 + 1/4.
    close_to("weight", anchors(&found).matches[0].weight, 0.5);
}

/// A drive along x, a metre a keyframe, whose neighbours share twenty points; with an EXIT two metres ahead at each of `signs`,
/// `drift_m` farther on than it stands.
fn drive(scene: &mut Scene, signs: &[(usize, f64)]) {
    let last = signs.last().map_or(0, |(at, _)| *at);
    for at in 0..=last {
        let x = at as f64;
        let sees = signs.iter().filter(|(sign, _)| *sign == at);
        let sees = sees.map(|(_, stands)| thing("sign", "EXIT").at([*stands, 0.0, 2.0])).collect::<Vec<_>>();
        let first_point = 20 * at as i64;
        let way = keyframe().at([x, 0.0, 0.0]).stamp(at as i64).observes(first_point..first_point + 40);
        scene.put(&format!("drive-{at}"), way.words(&[(99, 1.0)]).sees(sees));
    }
}

#[test]
fn a_second_place_needs_more_than_odometry_may_have_drifted() {
    let check = |what: &str, settings: Settings, signs: &[(usize, f64)], places: f64| {
        let mut scene = Scene::with(settings);
        drive(&mut scene, signs);
        let distance = ((signs[0].1).powi(2) + 4.0).sqrt();
        close_to(what, weight(&scene, "drive-0"), 1.0 / distance / places);
    };
    // After 20 m odometry may be off by 5 % of them: 3 + 1 m.
    check("4 m apart after 20 m", exit_counts(), &[(0, 0.0), (20, 4.0)], 1.0);
    check("4.01 m apart after 20 m", exit_counts(), &[(0, 0.0), (20, 4.01)], 2.0);
    let off = Settings { odometry_max_drift_share: 0.0, ..exit_counts() };
    check("without drift only the radius counts", off, &[(0, 0.0), (20, 4.0)], 2.0);
    // The third is held against the first alone: 3 + 1.5 m after 30 m.
    check("never from one to the next", exit_counts(), &[(0, 0.0), (20, 4.0), (30, 5.0)], 2.0);
}

#[test]
fn one_local_anchor_map_is_one_place() {
    // A room with two doors, 3.5 m apart, that bear its number; and the same from two keyframes that see nothing in common.
    let check = |what: &str, covisible: &[&str], places: f64| {
        let mut scene = Scene::new();
        scene.put("one", keyframe().sees([door("901", [0.0, 0.0, 2.0])]));
        let other = keyframe().at([3.5, 0.0, 0.0]).covisible(covisible);
        scene.put("other", other.sees([door("901", [3.5, 0.0, 2.0])]));
        close_to(what, weight(&scene, "one"), 0.5 / places);
    };
    check("in one local anchor map", &["one"], 1.0);
    check("in two", &[], 2.0);
}
