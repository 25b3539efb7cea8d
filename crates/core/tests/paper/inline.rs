//! M50: a keyframe sent along with the query is judged as if it had just arrived, and is not stored.
//!
//! Cases that M50 leaves open are tested as the core documents it (`recognition/loops/anchor_map.rs`): sights of a known
//! anchor add nothing to what the map knows of it, the others stand for themselves.

use revisit_core::domain::anchor::Outcome;
use revisit_core::domain::verdict::AnchorName;
use revisit_core::{Decision, Settings, Verdict};

use super::scene::{
    Keyframe, NAMES, Scene, Thing, anchors, candidate_of, close_to, door, keyframe, thing, unread,
};

/// The verdict in which anchors that the keyframe founds go by its detections.
fn by_detections(mut verdict: Verdict, outcomes: &[Outcome]) -> Verdict {
    let inline = |name: &mut AnchorName| {
        let founded = |outcome: &Outcome| match outcome {
            Outcome::Created(anchor) => *name == AnchorName::Stored(anchor.public()),
            _ => false,
        };
        if let Some(place) = outcomes.iter().position(founded) {
            *name = AnchorName::Inline(place);
        }
    };
    for evidence in verdict.candidates.iter_mut().filter_map(|candidate| candidate.anchors.as_mut()) {
        evidence.matches.iter_mut().for_each(|pair| inline(&mut pair.query_anchor));
        evidence.contradictions.iter_mut().for_each(|pair| inline(&mut pair.query_anchor));
    }
    for odds in verdict.candidates.iter_mut().filter_map(|candidate| candidate.odds.as_mut()) {
        let pairs = odds.terms.iter_mut().flat_map(|term| &mut term.pairs);
        pairs.for_each(|(query, _)| inline(query));
    }
    verdict
}

/// Asks about a keyframe before it is stored and after.
fn check(what: &str, mut scene: Scene, query: Keyframe, decision: Decision) {
    let inline = scene.ask_inline(&query);
    let stored = scene.put("query", query);
    let after = scene.ask("query");
    assert_eq!(after.decision, decision, "{what}: {after:#?}");
    assert_eq!(inline, by_detections(after, &stored.outcomes), "{what}");
}

const AHEAD: [f64; 3] = [0.0, 0.0, 2.0];

/// A passage with a door and a poster.
fn passage() -> Scene {
    let mut scene = Scene::new();
    let sights = [door("901", AHEAD), thing("poster", NAMES[0]).at([3.0, 0.0, 0.0])];
    scene.put("old", keyframe().words(&[(1, 0.5), (2, 0.5)]).observes(1..=20).sees(sights));
    scene
}

#[test]
fn an_inline_keyframe_gets_the_verdict_it_would_get_if_it_were_stored() {
    use Decision::{Loop, NoLoop, Undecided};
    let query = |sights: Vec<Thing>| keyframe().words(&[(1, 0.25), (3, 0.75)]).sees(sights);
    let check = |what: &str, query: Keyframe, decision: Decision| check(what, passage(), query, decision);
    check("the same door", query(vec![door("room 901", AHEAD)]), Loop);
    let two = vec![unread([1.0, 1.0, 1.0]), door("901", [0.5, 0.0, 2.0])];
    check("a door, and one that nobody has read", query(two), Loop);
    check("another door", query(vec![door("910", AHEAD)]), NoLoop);
    check("a door that nobody has read", query(vec![unread(AHEAD)]), Undecided);
    check("a sign", query(vec![door("exit", AHEAD)]), Undecided);
    check("nothing", query(vec![]), Undecided);
    check("no word in common", query(vec![door("901", AHEAD)]).words(&[(9, 1.0)]), Loop);
    check("no word at all", query(vec![]).words(&[]), Undecided);
    check("shared map points", query(vec![door("901", AHEAD)]).observes(6..=20), NoLoop);
    let by_points = || thing("door_number", "901").on([101, 102]);
    let points = query(vec![by_points()]).points(&[(101, [-1.0, 0.0, 2.0]), (102, [1.0, 0.0, 2.0])]);
    check("map points of its own", points.clone(), Loop);
    check("of another session", points.session("other-day"), Loop);
}

#[test]
fn an_inline_keyframe_tracks_what_its_neighbours_saw() {
    let mut scene = passage();
    let at = || keyframe().words(&[(1, 1.0)]).at([1.0, 0.0, 0.0]);
    scene.put("new", at().sees([door("901", [1.0, 0.0, 2.0])]));
    let sights = [door("901", [1.0, 0.0, 2.0]), door("Gauss", [9.0, 0.0, 2.0])];
    check("tracked, and a new one", scene, at().covisible(&["new"]).sees(sights), Decision::Loop);
}

#[test]
fn an_inline_anchor_counts_itself_among_the_places_of_its_description() {
    let mut scene = Scene::with(Settings { description_min_information_level: 2, ..Settings::default() });
    let see = |x: f64, text: &str| {
        let sights = [thing("sign", "exit").at([x, 0.0, 2.0]), door(text, [x + 2.0, 0.0, 0.0])];
        keyframe().at([x, 0.0, 0.0]).sees(sights)
    };
    scene.put("old-1", see(0.0, "901"));
    scene.put("old-2", see(10.0, "901"));
    // M6: p counts the places of the anchor itself and of those it matches; stored, it would stand at a third.
    check("a third place", scene, see(20.0, "777"), Decision::NoLoop);
}

#[test]
fn an_inline_sight_adds_nothing_to_what_it_tracks_and_what_it_founds_stands_for_itself() {
    let mut scene = passage();
    let known = scene.put("new", keyframe().words(&[(9, 1.0)]).sees([door("901", AHEAD)]));
    // 0.5 m beside it, read otherwise: stored, it would move the anchor's box and take part in its vote. The other one
    // is too far for tracking.
    let sights = [door("950", [0.5, 0.0, 2.0]).confidence(0.9), door("room 902", [0.0, -0.75, 1.75])];
    let verdict = scene.ask_inline(&keyframe().covisible(&["new"]).sees(sights));
    let found = candidate_of(&verdict, "old").expect("it shares a word");
    assert_eq!(anchors(&found).in_query, 2);
    let pair = &anchors(&found).matches[0];
    assert_eq!(pair.query_anchor, AnchorName::Stored(scene.fed(&known)[0].public()));
    close_to("angle", pair.angle_difference_rad, 0.0);
    close_to("weight", pair.weight, 1.0);
}
