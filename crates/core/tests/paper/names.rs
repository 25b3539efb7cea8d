//! Names: wings whose plates differ in one part, and notices that hang at every door.

use revisit_core::{CandidateDecision, Settings};

use super::scene::{Scene, door, keyframe, thing};

/// Doors of a wing.
const DOORS: usize = 8;

/// How a building names a door, by the number of the wing (0 to 2) and of the door.
type Naming = fn(usize, usize) -> String;

const LETTERS: [char; 3] = ['A', 'B', 'C'];

/// Ways to name the doors of three wings.
const NAMINGS: [Naming; 14] = [
    |wing, door| format!("{} {}", LETTERS[wing], 101 + door),
    |wing, door| format!("{}{}", LETTERS[wing], 101 + door),
    |wing, door| format!("{} {}", 101 + door, LETTERS[wing]),
    |wing, door| format!("3-{}{}", 114 + door, LETTERS[wing]),
    |wing, door| format!("ML {} {}", LETTERS[wing], 21 + door),
    |wing, door| format!("{} 1.{:02}", LETTERS[wing], door + 1),
    |wing, door| format!("{}.{:02}", wing + 1, door + 1),
    |wing, door| format!("{} {}", ["North", "East", "South"][wing], 101 + door),
    |wing, door| format!("{}bau {}", ["Alt", "Neu", "Mittel"][wing], 101 + door),
    |wing, door| format!("Wing {}, room {}", LETTERS[wing], 101 + door),
    |wing, door| format!("{}棟{}号室", LETTERS[wing], 301 + door),
    |wing, door| format!("корпус {} каб. {}", ['А', 'Б', 'В'][wing], 201 + door),
    |wing, door| format!("Building {} {}", ["II", "III", "IV"][wing], 101 + door),
    |wing, door| format!("{} {}", ["Turing", "Curie", "Noether"][wing], door + 1),
];

/// Drives past the doors of a wing, all of which look alike.
fn drive(scene: &mut Scene, session: &str, texts: impl Iterator<Item = String>) {
    for (at, text) in texts.enumerate() {
        let x = 10.0 * at as f64;
        let seen =
            keyframe().session(session).stamp(at as i64).at([x, 0.0, 0.0]).words(&[(1, 1.0), (2, 1.0)]);
        scene.put(&format!("{session}-{at}"), seen.sees([door(&text, [x, 0.0, 2.0])]));
    }
}

/// Counts the keyframes of a drive that close a loop.
fn loops(scene: &Scene, session: &str) -> usize {
    let closes = |at: &usize| {
        let verdict = scene.ask(&format!("{session}-{at}"));
        verdict.candidates.iter().any(|found| found.decision == CandidateDecision::Loop)
    };
    (0..DOORS).filter(closes).count()
}

#[test]
fn wings_that_one_part_tells_apart_are_never_one_and_each_is_found_again() {
    for naming in NAMINGS {
        let mut scene = Scene::new();
        let wing = |wing: usize| (0..DOORS).map(move |door| naming(wing, door));
        for (session, number) in [("a", 0), ("a-again", 0), ("b", 1), ("c", 2)] {
            drive(&mut scene, session, wing(number));
        }
        let example = naming(1, 3);
        assert_eq!(loops(&scene, "a-again"), DOORS, "{example}");
        assert_eq!((loops(&scene, "b"), loops(&scene, "c")), (0, 0), "{example}");
        drive(&mut scene, "b-again", wing(1));
        assert_eq!(loops(&scene, "b-again"), DOORS, "{example}");
    }
}

#[test]
fn a_plate_of_which_the_reader_dropped_a_part_closes_no_loop() {
    let mut scene = Scene::new();
    drive(&mut scene, "a", (0..DOORS).map(|door| format!("ML D {}", 21 + door)));
    drive(&mut scene, "cut", (0..DOORS).map(|door| (21 + door).to_string()));
    assert_eq!(loops(&scene, "cut"), 0);
}

/// Notices of many doors, in as many languages.
const NOTICES: [&str; 16] = [
    "请随手关门保持安静",
    "本室設備使用後請歸還原位",
    "関係者以外立入禁止の倉庫",
    "문을 조용히 닫아 주시기 바랍니다",
    "Prière de fermer doucement cette porte",
    "Kérjük az ajtót mindig csukva tartani",
    "Pidä tämä ovi aina suljettuna",
    "Παρακαλώ κρατήστε την πόρτα κλειστή",
    "Please keep this fire door closed at all times",
    "Diese Brandschutztür ist stets geschlossen zu halten",
    "Eine Haftung für Garderobe wird nicht übernommen",
    "Mantener esta puerta cerrada en todo momento",
    "Просьба закрывать дверь плотно и тихо",
    "Videoövervakat område dygnet runt",
    "يرجى إغلاق الباب بعد الدخول",
    "กรุณาปิดประตูทุกครั้งหลังใช้งาน",
];

#[test]
fn a_notice_that_hangs_at_every_door_closes_no_loop() {
    for notice in NOTICES {
        let mut scene = Scene::with(Settings { description_min_information_level: 2, ..Settings::default() });
        for at in 0..DOORS {
            let x = 10.0 * at as f64;
            let seen = keyframe().at([x, 0.0, 0.0]).stamp(at as i64).words(&[(1, 1.0)]);
            scene.put(&format!("doors-{at}"), seen.sees([thing("sign", notice).at([x, 0.0, 2.0])]));
        }
        assert_eq!(loops(&scene, "doors"), 0, "{notice}");
    }
}
