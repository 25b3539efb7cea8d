//! §IV-C.2, the end: a confirmed loop merges what matched, and its revocation parts it again (M12).

use revisit_core::domain::change::{Merge, MergeCause};
use revisit_core::domain::event::{Event, EventKind};
use revisit_core::domain::ids::{AnchorSeq, LoopId};
use revisit_core::domain::loop_warning::LoopWarningCode;
use revisit_core::{Decision, ReasonCode, Settings, Verdict};

use super::scene::{Keyframe, NAMES, Scene, Sign, door, ids, keyframe, to_the_letter};

/// A passage that sees 901, Turing, and one more.
fn passage(more: &str) -> Keyframe {
    keyframe().sees([
        door("901", [0.0, 0.0, 2.0]),
        door(NAMES[0], [2.0, 0.0, 2.0]),
        door(more, [-2.0, 0.0, 2.0]),
    ])
}

/// Two passages of one place; the anchors of each.
fn two_passages() -> (Scene, Vec<AnchorSeq>, Vec<AnchorSeq>) {
    let mut scene = Scene::new();
    let old = scene.put("kf-1", passage(NAMES[1]));
    let new = scene.put("kf-9", passage(NAMES[2]));
    let (old, new) = (scene.fed(&old), scene.fed(&new));
    (scene, old, new)
}

/// What a map says of its anchors and keyframes.
#[derive(Debug, PartialEq)]
struct Standing {
    anchors: Vec<Sign>,
    covisible: [Vec<String>; 2],
    verdicts: [Verdict; 2],
}

fn standing(scene: &Scene) -> Standing {
    let all = scene.map().anchors_from(AnchorSeq(0));
    Standing {
        anchors: all.map(|anchor| scene.anchor(anchor)).collect(),
        covisible: ["kf-1", "kf-9"].map(|id| scene.covisible(id)),
        verdicts: ["kf-9", "kf-1"].map(|id| scene.ask(id)),
    }
}

fn pair(into: AnchorSeq, from: AnchorSeq) -> Merge {
    Merge { into, from, cause: MergeCause::Loop("l-1".parse().expect("an id")) }
}

/// The loop and its two keyframes that an event tells of.
fn told(events: &[Event], kind: EventKind) -> [String; 3] {
    let event = events.iter().find(|event| event.kind == kind).expect("it is told");
    let loop_id = event.loop_id.as_ref().map(ToString::to_string);
    let [keyframe, candidate] =
        [&event.keyframe, &event.candidate].map(|id| id.as_ref().map(ToString::to_string));
    [loop_id, keyframe, candidate].map(Option::unwrap_or_default)
}

/// The loops that a verdict says are confirmed already, each with its other end.
fn closed(verdict: &Verdict) -> Vec<(&str, &str)> {
    verdict.closed.iter().map(|closed| (closed.id.as_str(), closed.keyframe.as_str())).collect()
}

#[test]
fn a_confirmed_loop_merges_the_pairs_that_matched_and_no_others() {
    let (mut scene, old, new) = two_passages();
    let (_, decided) = scene.close("l-1", "kf-9", "kf-1");
    let loops: Vec<&str> = scene.map().loops().keys().map(LoopId::as_str).collect();
    assert_eq!(loops, ["l-1"]);
    assert_eq!(scene.merged_by("l-1"), [pair(old[0], new[0]), pair(old[1], new[1])]);

    for (into, from) in [(old[0], new[0]), (old[1], new[1])] {
        assert_eq!(scene.anchor(into).keyframes, ["kf-1", "kf-9"]);
        assert_eq!(scene.anchor(from).merged_into, Some(into));
    }
    for alone in [old[2], new[2]] {
        assert_eq!(scene.anchor(alone).keyframes.len(), 1);
    }
    assert_eq!(scene.anchors().len(), 4);
    let merged = decided.events.iter().filter(|event| event.kind == EventKind::AnchorsMerged);
    assert_eq!(merged.count(), 2);
    assert_eq!(told(&decided.events, EventKind::LoopConfirmed), ["l-1", "kf-9", "kf-1"]);
}

#[test]
fn a_confirmed_loop_makes_its_two_keyframes_covisible() {
    let (mut scene, ..) = two_passages();
    assert_eq!(ids(&scene.ask("kf-9").best), ["kf-1"]);
    scene.close("l-1", "kf-9", "kf-1");
    assert_eq!(scene.covisible("kf-9"), ["kf-1"]);
    assert_eq!(scene.covisible("kf-1"), ["kf-9"]);
    for query in ["kf-9", "kf-1"] {
        let verdict = scene.ask(query);
        assert_eq!(verdict.excluded_covisible, 1, "{query}");
        assert_eq!(verdict.candidates, [], "{query}");
    }
}

#[test]
fn after_a_confirmed_loop_the_same_question_names_it() {
    let (mut scene, ..) = two_passages();
    // A third place that is alike and bears other names: a candidate that is rejected.
    scene.put("kf-5", keyframe().sees([door(NAMES[3], [0.0, 0.0, 2.0])]));
    assert_eq!(closed(&scene.ask("kf-9")), []);
    scene.close("l-1", "kf-9", "kf-1");
    for (query, other) in [("kf-9", "kf-1"), ("kf-1", "kf-9")] {
        let verdict = scene.ask(query);
        assert_eq!(verdict.decision, Decision::NoLoop, "{query}");
        assert_eq!(closed(&verdict), [("l-1", other)], "{query}");
        let reason = verdict.reason.as_ref().expect("a reason");
        assert_eq!(reason.code, ReasonCode::AlreadyClosed, "{query}");
        let detail = &reason.detail;
        assert!(detail.contains(other) && detail.contains("l-1"), "{detail}");
        assert_eq!(verdict.candidates.len(), 1, "{query}");
    }
    // Another loop is still a loop.
    scene.put("kf-20", passage(NAMES[4]).session("another"));
    let verdict = scene.ask("kf-9");
    assert_eq!((verdict.decision, ids(&verdict.best)), (Decision::Loop, vec!["kf-20".to_owned()]));
    assert_eq!(verdict.reason, None);
    scene.close("l-0", "kf-20", "kf-9");
    assert_eq!(closed(&scene.ask("kf-9")), [("l-0", "kf-20"), ("l-1", "kf-1")]);
    scene.revoke("l-1");
    assert_eq!(closed(&scene.ask("kf-1")), []);
}

#[test]
fn a_loop_that_the_map_speaks_against_is_closed_with_a_warning() {
    let mut scene = Scene::new();
    let at = [0.0, 0.0, 2.0];
    scene.put("901", keyframe().sees([door("901", at)]));
    scene.put("901-again", keyframe().sees([door("901", at)]));
    scene.put("910", keyframe().sees([door("910", at)]));
    scene.put("904", keyframe().sees([door("904", at)]));
    scene.put("blank", keyframe());
    scene.put("901-next", keyframe().covisible(&["901"]));
    let contradict = Some(LoopWarningCode::AnchorsContradict);
    let covisible = Some(LoopWarningCode::AlreadyCovisible);
    let table = [
        ("901-again", "901", None, ""),
        ("904", "901", contradict, "reads 904 where 901"),
        // A loop makes 904 stand around 901, too: either of the two contradicts.
        ("910", "901", contradict, "reads 910 where 90"),
        ("blank", "901", Some(LoopWarningCode::NotSupported), "no_anchors"),
        ("901-next", "901", covisible, "the present place"),
        ("901-again", "901", covisible, "loop-0"),
    ];
    for (number, (keyframe, candidate, code, says)) in table.into_iter().enumerate() {
        let (warning, decided) = scene.close(&format!("loop-{number}"), keyframe, candidate);
        assert_eq!(warning.as_ref().map(|warning| warning.code), code, "{keyframe}, {candidate}");
        let detail = warning.map(|warning| warning.detail);
        assert!(detail.as_deref().unwrap_or_default().contains(says), "{detail:?}");
        let confirmed = decided.events.iter().find(|event| event.kind == EventKind::LoopConfirmed);
        assert_eq!(confirmed.expect("it is told").detail, detail);
    }
    assert_eq!(scene.map().loops().len(), table.len());
}

#[test]
fn a_revoked_loop_leaves_everything_as_it_was() {
    let (mut scene, old, new) = two_passages();
    let before = standing(&scene);
    assert_eq!(before.verdicts[0].decision, Decision::Loop);
    scene.close("l-1", "kf-9", "kf-1");
    assert_ne!(standing(&scene), before);
    let (parted, decided) = scene.revoke("l-1");
    assert_eq!(parted, [pair(old[0], new[0]), pair(old[1], new[1])]);
    assert_eq!(standing(&scene), before);
    assert!(scene.map().loops().is_empty());
    assert_eq!(told(&decided.events, EventKind::LoopRevoked), ["l-1", "kf-9", "kf-1"]);
}

#[test]
fn anchors_seen_while_a_loop_stands_stay_with_their_own_passage_when_it_falls() {
    let (mut scene, old, new) = two_passages();
    scene.close("l-1", "kf-9", "kf-1");
    for (id, before) in [("kf-2", "kf-1"), ("kf-10", "kf-9")] {
        scene.put(id, keyframe().covisible(&[before]).sees([door("901", [0.0, 0.0, 2.0])]));
    }
    // In order of arrival: kf-2 came after kf-9.
    assert_eq!(scene.anchor(old[0]).keyframes, ["kf-1", "kf-9", "kf-2", "kf-10"]);
    scene.revoke("l-1");
    assert_eq!(scene.anchor(old[0]).keyframes, ["kf-1", "kf-2"]);
    assert_eq!(scene.anchor(new[0]).keyframes, ["kf-9", "kf-10"]);
}

#[test]
fn covisibility_that_was_declared_outlives_a_revoked_loop() {
    let mut scene = Scene::new();
    scene.put("kf-1", passage(NAMES[1]));
    scene.put("kf-9", keyframe().covisible(&["kf-1"]));
    scene.close("l-1", "kf-9", "kf-1");
    scene.revoke("l-1");
    assert_eq!(scene.covisible("kf-9"), ["kf-1"]);
}

#[test]
fn a_loop_merges_one_to_one_even_where_the_map_reads_the_equation_to_the_letter() {
    // Three EXIT signs in view of each other, all of them in reach of each of the other three.
    let mut scene = Scene::with(Settings { description_min_information_level: 2, ..to_the_letter() });
    let signs =
        || [[0.6, 0.0, 0.8], [0.0, 0.6, 0.8], [2.0 / 3.0, 2.0 / 3.0, 1.0 / 3.0]].map(|at| door("EXIT", at));
    let old = scene.put("kf-1", keyframe().sees(signs()));
    let new = scene.put("kf-9", keyframe().sees(signs()));
    let (old, new) = (scene.fed(&old), scene.fed(&new));
    scene.close("l-1", "kf-9", "kf-1");
    let merged = scene.merged_by("l-1");
    let mut into: Vec<AnchorSeq> = merged.iter().map(|merge| merge.into).collect();
    let mut from: Vec<AnchorSeq> = merged.iter().map(|merge| merge.from).collect();
    into.sort();
    from.sort();
    assert_eq!(into, old);
    assert_eq!(from, new);
}
