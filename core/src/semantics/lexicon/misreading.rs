//! Misreadings of words that are on the signs of every building.
//!
//! A reader takes the arrow or pictogram beside such a word for a letter ("CSALIDA"), and misses a letter of a worn sign
//! ("EMERGENCA"); both are still the word. A name is nobody's misreading, so the rules are narrow: only of words that are
//! drawn with a pictogram, only one character, in short words not the first, and never a word that is known otherwise.

use std::collections::{HashMap, HashSet};
use std::sync::LazyLock;

use crate::semantics::lexicon::dictionary::{self, Class};
use crate::semantics::lexicon::generic::Reading::{self, Drawn};
use crate::semantics::lexicon::generic::{LETTERS_MAX, OTHERS, entries};

/// A word of this length may have one letter too many at an end: a pictogram or an arrow.
const EXTENDED_LETTERS_MIN: usize = 5;
/// A word of this length may have one character wrong, missing or too many.
const MISREAD_LETTERS_MIN: usize = 6;
/// From this length on also the first character, which else makes another word: "alida", "valida".
const FIRST_MISREAD_LETTERS_MIN: usize = 8;
/// Shorter than [`EXTENDED_LETTERS_MIN`], but the running man is beside it on every wall.
const EXIT: &str = "exit";

/// Class of a [`dictionary::stem`], also of a misread one.
pub fn class_of(stem: &str) -> Class {
    dictionary::listed(misread(stem).unwrap_or(stem)).unwrap_or(Class::Specific)
}

/// Returns the generic word of which a stem is a misreading; none if it is a word itself.
pub fn misread(stem: &str) -> Option<&'static str> {
    let letters = stem.chars().count();
    if !(EXTENDED_LETTERS_MIN..=LETTERS_MAX).contains(&letters) || dictionary::listed(stem).is_some() {
        return None;
    }
    if MISREADINGS.others.contains(stem) {
        return None;
    }
    extended(stem).or_else(|| misspelt(stem, letters))
}

/// Returns the generic word of which a code is a misreading, with a digit for a letter: "SAL1DA". Its last character is
/// none, for "salida1" is exit 1.
pub fn misread_code(code: &str) -> Option<&'static str> {
    let mut digits = code.char_indices().filter(|(_, c)| !c.is_alphabetic());
    let (Some((at, digit)), None) = (digits.next(), digits.next()) else { return None };
    let rest = format!("{}{}", &code[..at], &code[at + digit.len_utf8()..]);
    let position = code[..at].chars().count();
    let is_inside = position > 0 && position < rest.chars().count();
    MISREADINGS
        .without_one(&rest)
        .iter()
        .find(|(_, missing)| is_inside && *missing == position)
        .map(|(word, _)| *word)
}

/// "csalida", "exitc".
fn extended(stem: &str) -> Option<&'static str> {
    let first = stem.chars().next()?.len_utf8();
    let last = stem.chars().next_back()?.len_utf8();
    [&stem[first..], &stem[..stem.len() - last]]
        .into_iter()
        .find_map(|word| MISREADINGS.words.get(word).copied())
}

/// "emergenca", "sallda", "emergenncia". Two words differ in one character where they are equal without it, so three
/// look-ups for each character do, however many words there are.
fn misspelt(stem: &str, letters: usize) -> Option<&'static str> {
    let missing =
        MISREADINGS.without_one(stem).iter().filter(|(word, at)| may_miss(word, *at)).map(|(word, _)| *word);
    let mut found: Option<&'static str> = missing.min();
    let mut without = String::with_capacity(stem.len());
    for (position, (at, letter)) in stem.char_indices().enumerate() {
        without.clear();
        without.push_str(&stem[..at]);
        without.push_str(&stem[at + letter.len_utf8()..]);
        let extra = MISREADINGS.words.get(without.as_str()).copied();
        let extra = extra.filter(|_| letters > MISREAD_LETTERS_MIN);
        let wrong = MISREADINGS.without_one(&without).iter();
        let wrong = wrong.filter(|(word, missing)| *missing == position && may_miss(word, position));
        // The smallest of several, that the answer does not depend on the order of a table.
        found = found.into_iter().chain(extra).chain(wrong.map(|(word, _)| *word)).min();
    }
    found
}

fn may_miss(word: &str, position: usize) -> bool {
    position > 0 || word.chars().count() >= FIRST_MISREAD_LETTERS_MIN
}

/// The words that may be misread.
struct Misreadings {
    words: HashMap<&'static str, &'static str>,
    /// By the spelling without one character: the word, and the position of that character. An edit distance to every
    /// word would cost as many comparisons for each word of each detection as there are words in the table.
    without_one: HashMap<String, Vec<(&'static str, usize)>>,
    others: HashSet<&'static str>,
}

impl Misreadings {
    fn without_one(&self, spelling: &str) -> &[(&'static str, usize)] {
        self.without_one.get(spelling).map_or(&[], Vec::as_slice)
    }
}

static MISREADINGS: LazyLock<Misreadings> = LazyLock::new(|| {
    // Scripts without capitals have no letter that an arrow is taken for.
    let is_drawn =
        |(reading, word): &(Reading, &str)| *reading == Drawn && word.chars().all(char::is_lowercase);
    let drawn = entries().filter(is_drawn).map(|(_, word)| word);
    let mut words = HashMap::new();
    let mut without_one: HashMap<String, Vec<(&'static str, usize)>> = HashMap::new();
    for word in drawn {
        let letters: Vec<char> = word.chars().collect();
        if letters.len() >= EXTENDED_LETTERS_MIN || word == EXIT {
            words.insert(word, word);
        }
        for at in (0..letters.len()).filter(|_| letters.len() >= MISREAD_LETTERS_MIN) {
            let rest = letters.iter().enumerate().filter(|(i, _)| *i != at).map(|(_, c)| *c).collect();
            without_one.entry(rest).or_default().push((word, at));
        }
    }
    Misreadings { words, without_one, others: OTHERS.split_whitespace().collect() }
});

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_wrong_character_leaves_a_generic_word() {
        for (misreading, word) in [
            ("csalida", "salida"),
            ("salidac", "salida"),
            ("exitc", "exit"),
            ("emergenca", "emergencia"),
            ("emergencla", "emergencia"),
            ("emercency", "emergency"),
            ("emergenncy", "emergency"),
            ("sallda", "salida"),
            ("salda", ""),
            ("salina", ""),
            ("toilot", "toilet"),
            ("ascensoor", "ascensor"),
            ("notausqang", "notausgang"),
        ] {
            let expected = Some(word).filter(|word| !word.is_empty());
            assert_eq!(misread(misreading), expected, "{misreading}");
        }
    }

    #[test]
    fn a_digit_inside_a_generic_word_is_a_letter_and_one_behind_it_is_a_number() {
        assert_eq!(misread_code("sal1da"), Some("salida"));
        assert_eq!(misread_code("emergenc1a"), Some("emergencia"));
        for code in ["salida1", "exit3", "lift12", "ex1t", "b1-03", "sal10a", "901", "0", "toilet5"] {
            assert_eq!(misread_code(code), None, "{code}");
        }
    }

    #[test]
    fn names_and_other_words_near_a_generic_one_are_none() {
        for word in [
            "exeter",
            "lifton",
            "alida",
            "dalida",
            "saliba",
            "salina",
            "valida",
            "exito",
            "sentry",
            "gentry",
            "robert",
            "alberto",
            "ranger",
            "pension",
            "penang",
            "anita",
            "ferrer",
            "donner",
            "castellana",
            "espada",
            "informatik",
            "trapper",
            "portrait",
            "turing",
            "evaluation",
        ] {
            assert!(misread(word).is_none(), "{word}");
        }
    }
}
