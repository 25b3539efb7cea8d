//! Quantities: numbers that measure, count, date, price or dial, and so name nothing.

use crate::semantics::lexicon::dictionary::{self, Class};
use crate::semantics::lexicon::role;
use crate::semantics::lexicon::word_list::WordList;
use crate::semantics::parsing::token::{Kind, Token};

/// Returns how many tokens from `at` form a quantity, 0 if none. `bare`: the tokens in lower case, without diacritics.
/// `numbered`: a role word such as "room" stands right before. `is_caption`: a sentence about a sign, which may count things.
pub fn tokens_at(
    tokens: &[Token<'_>],
    bare: &[String],
    at: usize,
    numbered: bool,
    is_caption: bool,
) -> usize {
    let unbroken = |i: usize| i == 0 || tokens.get(at + i).is_some_and(|t| !t.after_break);
    let word = |i: usize| bare.get(at + i).filter(|_| (0..=i).all(unbroken)).map_or("", String::as_str);
    let before = at.checked_sub(1).map_or("", |i| bare[i].as_str());
    let (first, next) = (word(0), word(1));
    if is_currency(first) && is_number(next) {
        return 2;
    }
    if (first == "+" && is_number(next)) || (DIALLED.contains(&before) && tokens[at].kind == Kind::Code) {
        return 1 + tokens[at + 1..].iter().take_while(|t| t.kind == Kind::Code && !t.after_break).count();
    }
    if tokens[at].kind != Kind::Code {
        return 0;
    }
    // "1 X 1" may be a door, too.
    if is_number(first)
        && ["x", "*"].contains(&next)
        && is_number(word(2))
        && (is_caption || (is_unit(word(3)) && word(3).len() > 1))
    {
        return 3 + usize::from(is_unit(word(3)));
    }
    // "101 M" may be a door: one letter is a unit before a word, as in "2 m wide".
    let goes_on = |unit: &str, after: usize| {
        let is_listed =
            || matches!(dictionary::listed(word(after)), Some(Class::Descriptive | Class::Function));
        unit.len() > 1 || !unit.is_ascii() || (word(after).chars().nth(1).is_some() && is_listed())
    };
    if is_number(first) && ((is_unit(next) && goes_on(next, 2)) || is_currency(next)) {
        return 2 + usize::from(next == "\u{b0}" && ["c", "f"].contains(&word(2)));
    }
    let unit = unit_of(first);
    let alone = is_time_or_date(first)
        || (is_dimensions(first) && (is_caption || (is_unit(next) && next.len() > 1)))
        || (!numbered
            && ((!unit.is_empty() && goes_on(unit, 1))
                || is_year(first, before)
                || (is_caption && is_count(first, next))));
    usize::from(alone)
}

const DIALLED: [&str; 7] = ["tel", "phone", "telephone", "telefon", "call", "fax", "mobile"];

static UNITS: WordList = WordList::of(
    "% \u{b0} m cm mm km g kg mg l ml v kv w kw mw hz khz mhz ghz px ft feet foot inch inche inches meter meters metre \
    metres centimeter centimeters centimetre centimetres kilometer kilometers kilogram kilograms litre litres liter liters volt volts \
    watt watts percent degree degrees second seconds minute minutes hour hours day days week weeks month months year years \
    sec min h am pm uhr lb lbs oz mph db gb mb tb mah m2 m3 meters² mio million times euro euros eur usd dollar dollars chf yen",
);

/// Units that people glue to the number. "12a" and "3g" are rooms, so most single letters are missing.
static GLUED_UNITS: WordList = WordList::of(
    "m cm mm km kg ml v kv w kw hz khz px ft gb mb tb mah am pm min sec db lbs oz mph m2 m3 st nd rd th",
);

const COUNTED: [&str; 7] = ["people", "men", "women", "children", "person", "different", "other"];

fn is_unit(word: &str) -> bool {
    UNITS.has(word)
}

fn is_currency(word: &str) -> bool {
    ["$", "\u{20ac}", "\u{a3}", "\u{a5}", "eur", "usd", "chf"].contains(&word)
}

fn is_number(word: &str) -> bool {
    word.starts_with(|c: char| c.is_ascii_digit())
        && word.ends_with(|c: char| c.is_ascii_digit())
        && word.bytes().all(|b| b.is_ascii_digit() || b".,-".contains(&b))
}

/// 10:30, 24/7, 2024-05-12, 12.05.2024, 12/05/24.
fn is_time_or_date(code: &str) -> bool {
    let is_digits = |part: &str| !part.is_empty() && part.bytes().all(|b| b.is_ascii_digit());
    if code == "24/7" || (code.contains(':') && code.split(':').all(is_digits)) {
        return true;
    }
    ['-', '.', '/'].iter().any(|separator| {
        let parts: Vec<&str> = code.split(*separator).filter(|part| is_digits(part)).collect();
        let [a, b, c] = parts[..] else { return false };
        let number = |part: &str| part.parse::<u32>().unwrap_or(u32::MAX);
        let (day, month) = match [a.len(), b.len(), c.len()] {
            [4, 1..=2, 1..=2] => (c, b),
            [1..=2, 1..=2, 4] => (a, b),
            [1..=2, 1..=2, 2] if *separator == '/' => (a, b),
            _ => return false,
        };
        let (day, month) = (number(day), number(month));
        (1..=31).contains(&day.max(month)) && (1..=12).contains(&day.min(month))
    })
}

/// 2x3, 1920x1080.
fn is_dimensions(code: &str) -> bool {
    code.split_once('x').is_some_and(|(a, b)| is_number(a) && is_number(b))
}

/// Returns the unit that is glued to a number: 2m, 230v, 10am, 1st. Empty if there is none.
fn unit_of(code: &str) -> &str {
    let unit = code.trim_start_matches(|c: char| c.is_ascii_digit() || ".,".contains(c));
    let digits = code.len() - unit.len();
    let fits = unit.len() > 1 || digits <= if unit == "m" { 2 } else { 3 };
    if digits > 0 && fits && GLUED_UNITS.has(unit) { unit } else { "" }
}

/// Returns a year only where a word says so: 2014 alone may be a room.
fn is_year(code: &str, before: &str) -> bool {
    let dated = [
        "in",
        "since",
        "est",
        "established",
        "anno",
        "circa",
        "year",
        "built",
        "founded",
        "\u{a9}",
        "seit",
        "depuis",
        "copyright",
    ];
    code.len() == 4
        && (code.starts_with("20") || code.starts_with('1'))
        && is_number(code)
        && dated.contains(&before)
}

/// "3 boats", "2 people": a small number before a plural.
fn is_count(code: &str, next: &str) -> bool {
    let plural = next.len() > 3
        && next.ends_with('s')
        && !next.ends_with("ss")
        && next.bytes().all(|b| b.is_ascii_alphabetic());
    code.len() <= 2
        && is_number(code)
        && ((plural && role::role_of(next).is_none()) || COUNTED.contains(&next))
}
