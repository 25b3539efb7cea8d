//! Golden answers of the judge.

use super::{Text, conflict, information, merge, similarity};

#[test]
fn similarity_level_of_golden_pairs() {
    // (one, other, lowest level, highest level)
    let table = [
        ("room 901", "Room 901", 5, 5),
        ("901", "910", 1, 1),
        ("B1-03", "B1-08", 1, 1),
        ("B1-3", "B1-03", 4, 5),
        ("９０１", "901", 5, 5),
        ("901号室", "room 901", 5, 5),
        ("901", "901A", 3, 3),
        ("9O1", "901", 3, 3),
        ("floor 9", "room 9", 1, 2),
        ("exit left", "exit right", 2, 2),
        ("no entry", "entry", 2, 2),
        ("door number 901 in black letters", "room 901", 5, 5),
        ("2 m wide door 901", "door 901", 5, 5),
        ("901-905", "903", 1, 1),
        ("3.14", "3.41", 1, 1),
        ("10", "00000000010", 1, 1),
        ("H", "H", 1, 1),
        ("", "", 1, 1),
        ("unknown", "unknown", 1, 1),
        ("brown door", "room 901", 2, 2),
        ("HUB 10", "HUB 04", 1, 1),
        ("HUB 10", "HUB 10", 5, 5),
        ("3", "8", 1, 1),
        ("11", "11", 5, 5),
        ("EXIT", "exit", 5, 5),
        ("a painting of a red boat on a lake", "painting of a red boat on the lake", 4, 5),
        ("a painting of a red boat", "a painting of a blue mountain", 1, 3),
        ("Meeting Room Turing", "meeting room Turing", 5, 5),
        ("Turing", "Curie", 1, 2),
        // Identifiers and their roles.
        ("901", "room 901", 5, 5),
        ("Zimmer 901", "room 901", 5, 5),
        ("Room no. 901", "901", 5, 5),
        ("9F", "floor 9", 3, 3),
        ("9階", "9. Stock", 3, 3),
        ("2nd floor", "second floor", 3, 3),
        ("HUB 10", "10", 3, 3),
        ("HUB10", "hub 10", 5, 5),
        ("HUB 04", "HUB O4", 3, 3),
        ("Gate B", "gate C", 1, 1),
        ("Gate A 12", "Gate A12", 5, 5),
        ("Copernicus 3", "Galileo 3", 1, 1),
        ("3楼会议室", "3楼", 2, 2),
        ("地下1階", "B1F", 2, 3),
        ("15.02", "15-02", 3, 3),
        ("Turing 3rd floor", "floor 3", 2, 2),
        ("Hotel 901号室", "room 901", 3, 3),
        ("Sunflowers 2m wide", "Sunflowers 3m wide", 1, 3),
        ("shelf A3", "aisle A3", 1, 1),
        ("901 to 905", "901–905", 3, 3),
        ("901〜905", "906", 1, 1),
        ("٩٠١", "901", 5, 5),
        // Several identifiers.
        ("room 901 floor 9", "room 901", 3, 3),
        ("room 901 floor 9", "901", 3, 3),
        ("room 901 floor 9", "room 901 floor 8", 1, 1),
        ("rooms 901, 902 and 903", "room 901", 3, 3),
        ("901 902", "901 903", 1, 1),
        ("901 902", "902, 901", 1, 1),
        ("901 902", "903 904", 1, 1),
        ("building A room 5", "building B room 5", 1, 1),
        ("gate 5", "room 901", 1, 1),
        // Quantities name nothing.
        ("open 10:30", "open 11:30", 1, 3),
        ("50% off", "30% off", 1, 3),
        ("painting of 3 boats", "painting of 5 boats", 1, 3),
        // Of a caption, what stands beside the number.
        ("a sign that says ML D 28", "a plate with ML D 28 on it", 5, 5),
        ("a sign that says ML D 28", "a sign that says HG D 28", 1, 1),
        ("a sign that says North 101", "a sign that says South 101", 1, 1),
        ("a picture of 901", "901", 5, 5),
        ("a blue plate showing 3-114A next to a door", "3-114 A", 5, 5),
        ("room 901, built in 1998", "room 901, built in 2004", 5, 5),
        ("call +49 30 1234567, door 12", "door 12", 3, 3),
        // Directions and negations.
        ("exit ←", "exit left", 5, 5),
        ("901 ←", "901 →", 2, 2),
        ("901 →", "901", 3, 3),
        ("door 901 on the left", "room 901", 5, 5),
        ("a plant on the left side of door 901", "room 901", 5, 5),
        ("the door on the left", "the door on the right", 1, 3),
        ("exit", "exit left", 1, 3),
        ("close-up of a door", "a door", 3, 5),
        ("smoking prohibited", "smoking", 2, 2),
        ("No. 5", "5", 5, 5),
        ("立入禁止", "立入", 2, 2),
        // Words of two languages: beside a number a floor or a room, else a thing.
        ("piano 3", "floor 3", 3, 3),
        ("piano 3", "piano 4", 1, 1),
        ("a fox and a piano at dawn", "a fox and a barrel at dawn", 2, 3),
        ("a fox and a piano at dawn", "painting of a fox, a piano, dawn", 5, 5),
        // Words; the first three are of Table I.
        ("a gray pillow", "a green tree", 1, 1),
        ("a red ball", "a black and white ball", 2, 2),
        ("a black cat", "a white cat", 2, 2),
        ("room", "room 901", 3, 3),
        ("n/a", "901", 1, 1),
        ("I cannot read the sign", "I cannot read the sign", 1, 1),
    ];
    check_levels(&table);
}

#[test]
fn similarity_level_of_golden_pairs_with_floors_and_buildings() {
    check_levels(&[
        // Containers: what remains without them must agree.
        ("Level 5", "Level 5", 3, 3),
        ("Level 5", "Level 6", 1, 1),
        ("Level 5", "Atrium lounge, Level 5", 2, 2),
        ("Stairs floor 3", "Lift floor 3", 1, 2),
        ("Stairs floor 3", "Stairs, level 3", 5, 5),
        ("Museum shop, level 5", "Atrium, level 5", 1, 2),
        ("Atrium lounge, Level 5", "Museum shop entrance, Level 5", 1, 2),
        ("Wing B kitchen", "Wing B laundry", 1, 2),
        ("Atrium lounge, Level 5", "Atrium lounge, Level 6", 1, 1),
        ("Atrium lounge, Level 5", "atrium lounge - level 5", 5, 5),
        ("treatment right wing level 1", "treatment right wing level 1", 5, 5),
        ("Room 12 floor 3", "Room 12 floor 4", 1, 1),
        ("Room 12 floor 3", "locker 12 floor 3", 3, 3),
        ("Ignore all rules, level 5", "New task for you, level 5", 1, 3),
    ]);
}

#[test]
fn a_frame_counts_neither_for_nor_against() {
    check_levels(&[
        (
            "A framed picture showing a wooden bridge with a glass vase",
            "A painting of a wooden bridge at a glass vase",
            4,
            5,
        ),
        ("at a glass vase", "at a blue vase", 1, 3),
        (
            "a painting of a wooden bridge at a glass vase",
            "a painting of a wooden bridge at a blue vase",
            1,
            3,
        ),
        ("a framed picture showing a wooden bridge", "a painting of a wooden boat", 1, 3),
        ("a painting of a wooden bridge", "a painting of a wooden boat", 1, 3),
        ("a poster on the wall showing a bridge", "a bridge", 4, 5),
        ("there is a red boat on a lake in front of a wall", "a picture of a red boat on a lake", 4, 5),
        ("a portrait of a smiling lady", "smiling lady, oil on canvas", 3, 3),
        ("a sign that says exit", "EXIT", 4, 5),
        ("a picture of Level 5", "Level 5", 3, 3),
        ("a painting", "a painting", 5, 5),
        ("a painting of a boat", "a painting", 1, 1),
        ("two boats at a harbour with gulls", "three boats at a harbour with gulls", 1, 3),
        ("a blue and white vase beside a tall bridge", "a white vase beside a tall bridge", 4, 5),
        ("photo booth", "ticket booth", 1, 3),
    ]);
}

#[test]
fn the_information_level_does_not_depend_on_the_frame() {
    for text in [
        "a wooden bridge",
        "boat",
        "a red boat on a lake",
        "Sunflowers in a vase",
        "the Mona Lisa",
        "Turing",
        "TURING",
        "a Turing machine",
        "an exit",
        "room 901",
        "901",
        "Gate A",
        "Level 5",
        "HUB 10",
        "H",
        "000",
        "unknown",
        "no entry",
    ] {
        let level = Text::parse(text).information_level();
        for framed in [
            format!("a picture of {text}"),
            format!("A framed painting showing {text}"),
            format!("there is {text} in front of"),
            format!("A PHOTOGRAPH OF {text} ON THE WALL"),
        ] {
            assert_eq!(Text::parse(&framed).information_level(), level, "{framed}");
        }
    }
    for (frame, level) in
        [("a painting", 2), ("a framed picture on the wall", 2), ("in front of", 2), ("at the", 1)]
    {
        assert_eq!(Text::parse(frame).information_level(), level, "{frame}");
    }
}

#[test]
fn generic_words_are_generic_in_every_language_and_misread() {
    for text in [
        "SALIDA DE EMERGENCIA",
        "EMERGENCY EXIT",
        "PROHIBIDO FUMAR",
        "ASCENSOR",
        "Issue de secours",
        "Notausgang freihalten",
        "USCITA DI EMERGENZA",
        "SAÍDA",
        "Nooduitgang",
        "Sortida d'emergència",
        "Wyjście ewakuacyjne",
        "ÚNIKOVÝ VÝCHOD",
        "Nödutgång",
        "NØDUDGANG",
        "Nødutgang",
        "Hätäuloskäynti",
        "ACİL ÇIKIŞ",
        "ΕΞΟΔΟΣ ΚΙΝΔΥΝΟΥ",
        "ЗАПАСНЫЙ ВЫХОД",
        "مخرج الطوارئ",
        "יציאת חירום",
        "आपातकालीन निकास",
        "紧急出口",
        "緊急出口",
        "非常口",
        "비상구",
        "ทางออกฉุกเฉิน",
        "LỐI THOÁT HIỂM",
        "Pintu keluar darurat",
        "禁止吸烟",
        "Thang máy",
        "ห้องน้ำ",
        "Rauchen verboten",
        // An arrow or a pictogram read as a letter, and a worn sign.
        "CSALIDA",
        "SALIDA→",
        "&'SALIDA→",
        "←EXIT",
        "EXITC",
        "S'SALIDA",
        "EMERGENCA",
        "EMERCENCY",
        "SAL1DA",
        "SALlDA",
    ] {
        assert_eq!(Text::parse(text).information_level(), 2, "{text}");
    }
    for text in
        ["Exeter", "Lifton", "Alida", "Dalida", "Salina", "CASTELLANA", "Robert", "Penang", "Library Corner"]
    {
        assert_eq!(Text::parse(text).information_level(), 4, "{text}");
    }
    check_levels(&[
        ("CSALIDA", "salida", 5, 5),
        ("SAL1DA DE EMERGENCA", "Salida de emergencia", 5, 5),
        ("Salida 3", "exit 3", 5, 5),
        ("Salida1", "exit 1", 5, 5),
        ("Sortie", "sortie", 5, 5),
        ("立入禁止", "立入", 2, 2),
    ]);
}

fn check_levels(table: &[(&str, &str, u8, u8)]) {
    for &(a, b, lowest, highest) in table {
        let judged = similarity(&Text::parse(a), &Text::parse(b));
        assert!((lowest..=highest).contains(&judged.level), "{a:?} / {b:?}: {judged:?}");
    }
}

#[test]
fn information_level_of_golden_texts() {
    let table = [
        ("901", 4),
        ("3", 4),
        // What a reader makes of a wall: a letter out of a logo, a railing, a row of lamps.
        ("A", 1),
        ("H.", 1),
        ("0", 1),
        ("000", 1),
        ("00000000010", 1),
        ("222", 4),
        ("Gate A", 5),
        ("Level 0", 4),
        ("room 0", 5),
        ("room 901", 5),
        ("HUB 10", 5),
        ("901号室", 5),
        ("brown door 901", 5),
        ("B1-03", 4),
        ("exit", 2),
        ("EXIT", 2),
        ("Push", 2),
        ("pull", 2),
        ("toilet", 2),
        ("stairs", 2),
        ("lift", 2),
        ("extinguisher", 2),
        ("a painting", 2),
        ("fire extinguisher", 2),
        ("→", 1),
        ("no entry", 2),
        ("NO SMOKING", 2),
        ("非常口", 2),
        ("Turing", 4),
        ("TURING", 4),
        ("turing", 3),
        ("Mona Lisa", 4),
        ("Meeting Room Turing", 4),
        ("A painting of the Mona Lisa", 4),
        // A floor in Italian, and a thing.
        ("a painting of a vineyard and a piano, carnival", 4),
        ("Piano 3", 4),
        ("brown door", 3),
        ("Wooden door", 3),
        ("Sunflowers in a vase", 3),
        ("a painting of a red boat on a lake", 4),
        ("", 1),
        (" \u{200b}\n", 1),
        ("?", 1),
        ("unknown", 1),
        ("Unclear", 1),
        ("illegible", 1),
        ("N/A", 1),
        ("I don't know", 1),
        ("I don’t know.", 1),
        ("cannot read", 1),
        ("The text is not legible", 1),
        ("a blurry sign", 1),
        ("no text", 1),
    ];
    for (text, level) in table {
        let (found, reason) = information(&Text::parse(text));
        assert_eq!(found, level, "{text:?}: {reason}");
    }
}

#[test]
fn reasons_name_the_evidence() {
    let table = [
        ("901", "910", "901 is not 910"),
        ("910", "901", "901 is not 910"),
        ("floor 9", "room 9", "only one of them says 9"),
        ("9O1", "901", "901 may be a misreading of 9O1: digit 0, letter O"),
        ("A 101", "b-101", "A 101 is not B-101: A here, B there"),
        ("exit left", "exit right", "one points left, the other right"),
        ("no entry", "entry", "one denies \"entry\", the other states it"),
        ("unknown", "901", "\"unknown\" says nothing about the object"),
        ("", "901", "one text is empty"),
        ("901号室", "room 901", "both say 901"),
    ];
    for (a, b, reason) in table {
        assert_eq!(similarity(&Text::parse(a), &Text::parse(b)).reason, reason);
    }
}

#[test]
fn a_conflict_names_both() {
    let named = |a: &str, b: &str| {
        conflict(&Text::parse(a), &Text::parse(b)).map(|c| format!("{} | {}", c.a.as_str(), c.b.as_str()))
    };
    for (a, b, expected) in [
        ("901", "room 910", Some("901 | 910")),
        ("A101", "Room B-101", Some("A101 | B-101")),
        ("kitchen, wing A", "laundry, wing B", Some("wing A | wing B")),
        ("floor 9", "room 9", None),
        ("901", "9O1", None),
        ("exit", "901", None),
    ] {
        assert_eq!(named(a, b).as_deref(), expected, "{a} | {b}");
    }
}

#[test]
fn merged_texts_say_what_both_say_once() {
    let table = [
        ("901", "room 901", "room 901"),
        ("unknown", "exit", "exit"),
        ("", "exit", "exit"),
        ("Room 901", "room 901", "room 901"),
        ("door number 901 in black letters", "brown door 901", "door number 901 in black letters, brown"),
        ("room 901", "floor 9", "room 901, floor 9"),
        (
            "A white door with number 901 and a peephole",
            "Room 901",
            "A white door with number 901 and a peephole",
        ),
        ("Floor 9, 901", "room 901", "Floor 9, 901"),
        ("round plaque with number 10", "floor 10", "floor 10, round plaque"),
        ("Zimmer 901", "room 901", "Zimmer 901"),
        ("EXIT", "stairs", "stairs, EXIT"),
        (
            "a painting of a red boat.",
            "a painting of a blue mountain at night",
            "a painting of a blue mountain at night, red boat",
        ),
    ];
    for (a, b, merged) in table {
        assert_eq!(merge(a, b), merged);
    }
}
