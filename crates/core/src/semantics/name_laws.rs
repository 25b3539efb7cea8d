//! Laws of names, for random names of random schemes.

use proptest::prelude::*;

use super::lexicon::dictionary;
use super::lexicon::role;
use super::{Numbering, Text, conflict, similarity_level};

/// A part of a name: what it is made of follows from its characters.
type Parts = Vec<String>;

/// Words that the lexicon does not have, and digits that no reader takes for noise.
fn part() -> impl Strategy<Value = String> {
    let letter = "[A-EG-Z]";
    let word = "[B-DF-HJ-NP-TV-Z]{3,5}".prop_filter("unlisted", |word| is_unlisted(word));
    prop_oneof![2 => letter, 1 => word, 2 => "[1-9][0-9]{0,3}"]
}

fn is_unlisted(word: &str) -> bool {
    let stem = dictionary::stem(&word.to_lowercase());
    let is_unit = !Text::parse(&format!("1 {word}")).has_name();
    dictionary::listed(&stem).is_none()
        && role::role_of(&stem).is_none()
        && !dictionary::negates(&stem)
        && !is_unit
}

/// A name with a number of its own, and no more parts than plates have.
fn name() -> impl Strategy<Value = Parts> {
    let has_digits = |parts: &Parts| parts.iter().any(|part| is_digits(part));
    // Three groups of digits may be a date.
    let is_short = |parts: &Parts| parts.iter().filter(|part| is_digits(part)).count() <= 2;
    // 12 m2 and 12 m3 measure.
    let measures =
        |parts: &Parts| parts.windows(2).any(|pair| pair[0] == "M" && ["2", "3"].contains(&pair[1].as_str()));
    prop::collection::vec(part(), 1..5)
        .prop_filter("numbered", move |parts| has_digits(parts) && is_short(parts) && !measures(parts))
}

fn is_digits(part: &str) -> bool {
    part.starts_with(|c: char| c.is_ascii_digit())
}

/// Writes a name. Groups of digits have one mark between them, whatever is at the other borders.
fn written(parts: &[String], border: impl Fn(&str, &str) -> &'static str) -> String {
    let mut text = parts[0].clone();
    for pair in parts.windows(2) {
        let between = match (is_digits(&pair[0]), is_digits(&pair[1])) {
            (true, true) => ".",
            (false, false) => " ",
            _ => border(&pair[0], &pair[1]),
        };
        text = text + between + &pair[1];
    }
    text
}

fn plain(parts: &[String]) -> String {
    written(parts, |_, _| " ")
}

/// Replaces a letter by another one, or a digit.
fn changed(parts: &[String], at: usize, by: usize) -> Option<Parts> {
    let mut other = parts.to_vec();
    let part = &mut other[at % parts.len()];
    let place = by % part.len();
    let old = part.as_bytes()[place];
    let new = match old {
        b'0'..=b'9' => b'1' + (old - b'0' + by as u8 % 8) % 9,
        _ => b'A' + (old - b'A' + 1 + by as u8 % 25) % 26,
    };
    part.replace_range(place..=place, std::str::from_utf8(&[new]).ok()?);
    let is_word = part.len() > 1 && !is_digits(part);
    (new != old && (!is_word || is_unlisted(part)) && part != "F").then_some(other)
}

/// Writes letters and digits as other scripts and keyboards do.
fn respelt(text: &str, how: usize) -> String {
    let confusable = |c: char| match c {
        'A' => 'А',
        'B' => 'Β',
        'C' => 'С',
        'E' => 'Е',
        'H' => 'Η',
        'K' => 'К',
        'M' => 'М',
        'P' => 'Ρ',
        'T' => 'Т',
        'X' => 'Χ',
        _ => c,
    };
    let wide =
        |c: char| if c.is_ascii_alphanumeric() { char::from_u32(c as u32 + 0xfee0).unwrap_or(c) } else { c };
    let arabic = |c: char| c.to_digit(10).and_then(|digit| char::from_u32(0x660 + digit)).unwrap_or(c);
    match how % 6 {
        0 => text.to_lowercase(),
        1 => text.chars().map(confusable).collect(),
        2 => text.chars().map(wide).collect(),
        3 => text.chars().map(arabic).collect(),
        4 => format!("Room No. {text}"),
        _ => format!("  {}\u{200b} ", text.replace(' ', "  ")),
    }
}

fn level(a: &str, b: &str) -> u8 {
    similarity_level(&Text::parse(a), &Text::parse(b)).0
}

fn conflicts(a: &str, b: &str) -> bool {
    conflict(&Text::parse(a), &Text::parse(b)).is_some()
}

fn config() -> ProptestConfig {
    ProptestConfig { cases: 2048, failure_persistence: None, ..ProptestConfig::default() }
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn a_character_that_differs_excludes(parts in name(), at in 0_usize..8, by in 0_usize..64) {
        let Some(other) = changed(&parts, at, by) else { return Ok(()) };
        let (a, b) = (plain(&parts), plain(&other));
        prop_assert_eq!(level(&a, &b), 1, "{} | {}", a, b);
        prop_assert!(conflicts(&a, &b) && conflicts(&b, &a), "{} | {}", a, b);
    }

    #[test]
    fn spellings_of_one_name_are_the_same(parts in name(), hows in prop::array::uniform2(0_usize..24)) {
        let borders = |how: usize| move |_: &str, _: &str| ["", " ", "-", "."][how % 4];
        let spelt = hows.map(|how| respelt(&written(&parts, borders(how / 6)), how));
        let [a, b] = &spelt;
        prop_assert!(level(a, b) >= 4, "{} | {}: {}", a, b, level(a, b));
        let (of_a, of_b) = (Text::parse(a), Text::parse(b));
        prop_assert_eq!(of_a.keys(), of_b.keys());
        prop_assert_eq!(of_a.gist(), of_b.gist());
    }

    #[test]
    fn a_name_that_lacks_a_part_is_open(parts in name(), at in 0_usize..8) {
        let mut fewer = parts.clone();
        fewer.remove(at % parts.len());
        if fewer.is_empty() {
            return Ok(());
        }
        let (a, b) = (plain(&parts), plain(&fewer));
        prop_assert!(level(&a, &b) <= 3, "{} | {}: {}", a, b, level(&a, &b));
        prop_assert!(!conflicts(&a, &b), "{} | {}", a, b);
    }

    #[test]
    fn a_shared_word_explains_nothing(a in name(), b in name(), word in "[B-DF-HJ-NP-TV-Z]{4}") {
        let (of_a, of_b) = (plain(&a), plain(&b));
        let [with_a, with_b] = [&of_a, &of_b].map(|text| format!("{text} {word}"));
        if is_unlisted(&word) && level(&of_a, &of_b) < 4 {
            let with = level(&with_a, &with_b);
            prop_assert!(with < 4, "{} | {}: {}", with_a, with_b, with);
            prop_assert!(!conflicts(&of_a, &of_b) || with == 1, "{} | {}: {}", with_a, with_b, with);
        }
    }

    #[test]
    fn a_conflict_under_a_numbering_is_one_or_open_without_it(a in name(), b in name(), of in name()) {
        let shape = Text::parse(&plain(&of)).shape();
        let numbering = Numbering::learned(&shape.into_iter().map(|shape| (shape, 20)).collect());
        let under = |parts: &[String]| Text::under(&plain(parts), numbering.as_ref());
        if conflict(&under(&a), &under(&b)).is_some() {
            prop_assert!(level(&plain(&a), &plain(&b)) <= 3);
        }
    }
}
