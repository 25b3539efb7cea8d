//! Quantities: numbers that measure, count, date or price, and so name nothing.

use crate::semantics::lexicon::dictionary::{self, Class};
use crate::semantics::lexicon::role;
use crate::semantics::lexicon::word_list::WordList;
use crate::semantics::parsing::context::Around;
use crate::semantics::parsing::token::Kind;

static UNITS: WordList = WordList::of(
    "% \u{b0} m cm mm km g kg mg l ml v kv w kw mw hz khz mhz ghz px ft feet foot inch inche inches meter meters metre \
    metres centimeter centimeters centimetre centimetres kilometer kilometers kilogram kilograms litre litres liter liters volt volts \
    watt watts percent degree degrees second seconds minute minutes hour hours day days week weeks month months year years \
    sec min h am pm uhr lb lbs oz mph db gb mb tb mah m2 m3 meters² mio million times",
);

static CURRENCIES: WordList =
    WordList::of("$ \u{20ac} \u{a3} \u{a5} euro euros eur usd dollar dollars chf yen");

/// Units that people glue to the number. "12a" and "3g" are rooms, so most single letters are missing.
static GLUED_UNITS: WordList = WordList::of(
    "m cm mm km kg ml v kv w kw hz khz px ft gb mb tb mah am pm min sec db lbs oz mph m2 m3 st nd rd th",
);

/// Words before a year; 2014 alone may be a room.
static DATED: WordList =
    WordList::of("in since est established anno circa year built founded \u{a9} seit depuis copyright");

/// Returns how many tokens from `at` form a quantity, 0 if none. `numbered`: a role word such as "room" stands right before.
/// A caption may also count things.
pub fn tokens_at(around: &Around<'_>, at: usize, numbered: bool, is_caption: bool) -> usize {
    let unbroken = |i: usize| i == 0 || around.tokens.get(at + i).is_some_and(|token| !token.after_break);
    let word =
        |i: usize| around.bare.get(at + i).filter(|_| (0..=i).all(unbroken)).map_or("", String::as_str);
    let (first, next) = (word(0), word(1));
    if CURRENCIES.has(first) && is_number(next) {
        return 2;
    }
    if around.tokens[at].kind != Kind::Code {
        return 0;
    }
    // "101 M" may be a door: one letter is a unit before a word, as in "2 m wide".
    let goes_on = |unit: &str, after: usize| {
        let is_listed =
            || matches!(dictionary::listed(word(after)), Some(Class::Descriptive | Class::Function));
        unit.len() > 1 || !unit.is_ascii() || (word(after).chars().nth(1).is_some() && is_listed())
    };
    if is_number(first) && ((UNITS.has(next) && goes_on(next, 2)) || CURRENCIES.has(next)) {
        return 2;
    }
    let before = || at.checked_sub(1).map_or("", |before| around.bare[before].as_str());
    let is_year = || first.len() == 4 && is_number(first) && DATED.has(before());
    let is_count = || is_caption && first.len() <= 2 && is_number(first) && is_plural(next);
    let is_measure = || unit_of(first).is_some_and(|unit| goes_on(unit, 1));
    usize::from(is_time_or_date(first) || (!numbered && (is_measure() || is_year() || is_count())))
}

fn is_number(word: &str) -> bool {
    word.starts_with(|c: char| c.is_ascii_digit())
        && word.ends_with(|c: char| c.is_ascii_digit())
        && word.bytes().all(|b| b.is_ascii_digit() || b".,-".contains(&b))
}

/// 10:30, 24/7, 2024-05-12, 12.05.2024.
fn is_time_or_date(code: &str) -> bool {
    let is_digits = |part: &str| !part.is_empty() && part.bytes().all(|b| b.is_ascii_digit());
    let is_date = |mark: char| {
        let lengths: Vec<usize> = code.split(mark).filter(|part| is_digits(part)).map(str::len).collect();
        matches!(lengths[..], [4, 1..=2, 1..=2] | [1..=2, 1..=2, 4])
    };
    code == "24/7"
        || (code.contains(':') && code.split(':').all(is_digits))
        || ['-', '.', '/'].into_iter().any(is_date)
}

/// Returns the unit that is glued to a number: 2m, 230v, 10am, 1st.
fn unit_of(code: &str) -> Option<&str> {
    let unit = code.trim_start_matches(|c: char| c.is_ascii_digit() || ".,".contains(c));
    let digits = code.len() - unit.len();
    let fits = unit.len() > 1 || digits <= if unit == "m" { 2 } else { 3 };
    Some(unit).filter(|unit| digits > 0 && fits && GLUED_UNITS.has(unit))
}

/// Whether a word is one that small numbers count: "3 boats", "2 people".
fn is_plural(word: &str) -> bool {
    let is_one = word.len() > 3 && word.ends_with('s') && !word.ends_with("ss");
    (is_one && word.is_ascii() && role::role_of(word).is_none())
        || ["people", "men", "women", "children"].contains(&word)
}
