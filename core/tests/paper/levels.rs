//! §IV-A.2 and M14: the levels of the built-in judge, as the golden pairs ask for them.

use revisit_core::semantics::{Judgement, Text, information, merge, similarity};

fn alike(a: &str, b: &str) -> Judgement {
    similarity(&Text::parse(a), &Text::parse(b))
}

#[test]
fn similarity_level_of_the_golden_pairs_both_ways_round() {
    // (one, other, lowest level, highest level)
    let table = [
        ("room 901", "Room 901", 5, 5),
        ("901", "910", 1, 1),
        ("B1-03", "B1-08", 1, 1),
        ("B1-3", "B1-03", 4, 5),
        ("\u{ff19}\u{ff10}\u{ff11}", "901", 5, 5),
        ("901\u{53f7}\u{5ba4}", "room 901", 5, 5),
        ("901", "901A", 1, 1),
        ("9O1", "901", 3, 3),
        ("floor 9", "room 9", 1, 2),
        ("exit left", "exit right", 2, 2),
        ("no entry", "entry", 2, 2),
        ("door number 901 in black letters", "room 901", 5, 5),
        ("2 m wide door 901", "door 901", 5, 5),
        ("901-905", "903", 3, 3),
        ("3.14", "3.41", 1, 1),
        ("", "", 1, 1),
        ("unknown", "unknown", 1, 1),
        ("brown door", "room 901", 2, 2),
        // Of the paper's Table I, what needs no knowledge of the world.
        ("a black cat", "a white cat", 2, 2),
        ("a gray pillow", "a green tree", 1, 1),
        ("a red ball", "a black and white ball", 2, 2),
    ];
    for (a, b, lowest, highest) in table {
        for (a, b) in [(a, b), (b, a)] {
            let judged = alike(a, b);
            assert!((lowest..=highest).contains(&judged.level), "{a:?} / {b:?}: {judged:?}");
            assert!(!judged.reason.is_empty() && !judged.source.as_str().is_empty(), "{judged:?}");
        }
    }
}

#[test]
fn a_text_is_like_itself_however_it_is_written() {
    for (a, b) in [
        ("901", "901"),
        ("HUB 10", "hub 10"),
        (" Room  901 ", "room 901"),
        ("B1\u{2013}03", "B1-03"),
        ("exit", "EXIT"),
    ] {
        assert_eq!(alike(a, b).level, 5, "{a:?} / {b:?}");
    }
}

#[test]
fn information_level_from_identifier_with_context_down_to_nothing() {
    let table: [(u8, &[&str]); 5] = [
        (5, &["room 901", "901\u{53f7}\u{5ba4}", "HUB 10", "brown door 901"]),
        (4, &["901", "3", "B1-03", "Mona Lisa", "Turing", "a painting of a red boat on a lake"]),
        (3, &["brown door", "Sunflowers in a vase"]),
        (2, &["exit", "Push", "pull", "toilet", "stairs", "lift", "extinguisher", "a painting"]),
        (1, &["", "  ", "unknown", "illegible", "N/A"]),
    ];
    for (level, texts) in table {
        for text in texts {
            let judged = information(&Text::parse(text));
            assert_eq!(judged.0, level, "{text:?}: {judged:?}");
        }
    }
}

#[test]
fn merge_text_says_what_both_texts_say() {
    for (a, b, words) in [
        ("901", "room 901", &["room", "901"][..]),
        ("unknown", "room 901", &["room 901"]),
        ("room 901", "brown door", &["901", "brown"]),
    ] {
        for (a, b) in [(a, b), (b, a)] {
            let text = merge(a, b);
            assert!(words.iter().all(|word| text.contains(word)), "{a:?} + {b:?}: {text:?}");
            assert!(!text.contains("unknown"), "{text:?}");
        }
    }
}
