//! M62 and M63: neighbours along the drive, of clients that send no map points and no list; and returns that are closed once.

use revisit_core::{Decision, ReasonCode, Settings};

use super::scene::{Keyframe, Scene, Thing, door, keyframe, to_the_letter};

const PLATE: [f64; 3] = [0.0, 0.0, 3.0];

/// Three keyframes at these seconds and metres, each of which sees one plate; how many are covisible with the last.
fn neighbours(settings: Settings, at: [(i64, f64); 3], like: impl Fn(Keyframe) -> Keyframe) -> usize {
    let mut scene = Scene::with(settings);
    for (number, (second, metre)) in at.into_iter().enumerate() {
        let new = keyframe().unlinked().stamp(second).at([metre, 0.0, 0.0]).sees([door("901", PLATE)]);
        scene.put(&format!("kf-{number}"), if number == 2 { like(new) } else { new });
    }
    let verdict = scene.ask("kf-2");
    assert_eq!(verdict.excluded_covisible, scene.covisible("kf-2").len());
    verdict.excluded_covisible
}

#[test]
fn what_is_near_along_the_drive_is_covisible_where_the_client_does_not_know() {
    let default = Settings::default;
    let as_it_is = |keyframe: Keyframe| keyframe;
    let near = [(0, 0.0), (1, 0.1), (2, 0.2)];
    let check = |what: &str, settings: Settings, at, like: &dyn Fn(Keyframe) -> Keyframe, expected: usize| {
        assert_eq!(neighbours(settings, at, like), expected, "{what}");
    };
    check("one second and ten centimetres apart", default(), near, &as_it_is, 2);
    check("3 m are near, 3.1 m are not", default(), [(0, 0.0), (1, 0.1), (2, 3.1)], &as_it_is, 1);
    check("there and back is driven, too", default(), [(0, 0.0), (1, 2.0), (2, 0.0)], &as_it_is, 1);
    check("20 s are near, 21 s are not", default(), [(0, 0.0), (1, 0.0), (21, 0.0)], &as_it_is, 1);
    check("a list says who is", default(), near, &|keyframe| keyframe.covisible(&["kf-0"]), 1);
    check("an empty list says that none is", default(), near, &|keyframe| keyframe.covisible(&[]), 0);
    check("another session is another drive", default(), near, &|keyframe| keyframe.session("other"), 0);
    check("the paper knows map points alone", to_the_letter(), near, &as_it_is, 0);
    let off = Settings { covisibility_max_way_m: 0.0, ..default() };
    check("a setting turns it off", off, near, &as_it_is, 0);
}

#[test]
fn one_plate_seen_from_three_neighbours_is_one_anchor_and_no_loop() {
    let mut scene = Scene::new();
    for (number, metre) in [0.0, 0.1, 0.2].into_iter().enumerate() {
        let new = keyframe().unlinked().stamp(number as i64).at([metre, 0.0, 0.0]);
        scene.put(&format!("kf-{number}"), new.sees([door("901", PLATE)]));
        let verdict = scene.ask(&format!("kf-{number}"));
        assert_ne!(verdict.decision, Decision::Loop, "{number}: {verdict:#?}");
    }
    assert_eq!(scene.anchors().len(), 1);
}

/// A corridor once around a block of 4 m by 4 m: a keyframe each second and metre, a plate in the middle of each side.
fn lap(number: usize) -> impl Iterator<Item = (String, Keyframe)> {
    const PLATES: [(&str, [f64; 3]); 4] = [
        ("901", [2.0, 0.0, 1.0]),
        ("903", [5.0, 0.0, -2.0]),
        ("905", [2.0, 0.0, -5.0]),
        ("907", [-1.0, 0.0, -2.0]),
    ];
    (0..16_usize).map(move |step| {
        let along = (step % 4) as f64;
        let (x, z) = match step / 4 {
            0 => (along, 0.0),
            1 => (4.0, -along),
            2 => (4.0 - along, -4.0),
            _ => (0.0, along - 4.0),
        };
        let distance = |at: [f64; 3]| ((at[0] - x).powi(2) + (at[2] - z).powi(2)).sqrt();
        let seen = PLATES.into_iter().filter(|(_, at)| distance(*at) < 2.2);
        let seen: Vec<Thing> = seen.map(|(text, at)| door(text, at)).collect();
        let second = (16 * number + step) as i64;
        (format!("kf-{number}-{step:02}"), keyframe().unlinked().stamp(second).at([x, 0.0, z]).sees(seen))
    })
}

#[test]
fn a_robot_that_closes_what_it_is_told_closes_each_place_once_a_lap() {
    let mut scene = Scene::new();
    let mut closed: Vec<(usize, String)> = Vec::new();
    for number in 0..3 {
        for (id, keyframe) in lap(number) {
            scene.put(&id, keyframe);
            let verdict = scene.ask(&id);
            if let Some(best) = &verdict.best {
                assert!(number > 0, "{id} is of the first lap: {verdict:#?}");
                scene.close(&format!("l-{id}"), &id, best.as_str());
                closed.push((number, id));
            }
        }
        assert_eq!(
            scene.anchors().iter().filter(|anchor| anchor.merged_into.is_none()).count(),
            4,
            "{number}"
        );
    }
    for number in [1, 2] {
        let of_lap = closed.iter().filter(|(lap, _)| *lap == number).count();
        // Of 16 keyframes: one for each plate, and one that stands between two of them.
        assert!((1..=5).contains(&of_lap), "{closed:?}");
    }
}

#[test]
fn the_next_keyframe_of_a_closed_return_names_the_loop_and_can_be_closed_too_by_who_wants_it() {
    let mut scene = Scene::new();
    for (number, (second, metre)) in [(0, 0.0), (60, 0.0), (61, 0.1)].into_iter().enumerate() {
        let new = keyframe().unlinked().stamp(second).at([metre, 0.0, 0.0]).sees([door("901", PLATE)]);
        scene.put(&format!("kf-{number}"), new);
    }
    assert_eq!(scene.ask("kf-2").decision, Decision::Loop);
    scene.close("l-1", "kf-1", "kf-0");
    let verdict = scene.ask("kf-2");
    assert_eq!((verdict.decision, verdict.best), (Decision::NoLoop, None));
    let reason = verdict.reason.expect("a reason");
    assert_eq!(reason.code, ReasonCode::AlreadyClosed);
    assert!(reason.detail.contains("l-1") && reason.detail.contains("kf-0"), "{}", reason.detail);
    assert_eq!(verdict.closed.iter().map(|closed| closed.keyframe.as_str()).collect::<Vec<_>>(), ["kf-0"]);
    assert_eq!(
        verdict.candidates[0].reason.as_ref().map(|reason| reason.code),
        Some(ReasonCode::AlreadyClosed)
    );
    assert_eq!(scene.ask_again("kf-2").decision, Decision::Loop);
    // A plate that no loop has joined is new.
    scene.put(
        "kf-3",
        keyframe()
            .unlinked()
            .stamp(62)
            .at([0.2, 0.0, 0.0])
            .sees([door("901", PLATE), door("903", [2.0, 0.0, 3.0])]),
    );
    scene.put("kf-4", keyframe().unlinked().stamp(300).sees([door("903", [2.0, 0.0, 3.0])]));
    assert_eq!(scene.ask("kf-4").decision, Decision::Loop);
    scene.cull("kf-4");
    scene.revoke("l-1");
    assert_eq!(scene.ask("kf-2").decision, Decision::Loop);
}
