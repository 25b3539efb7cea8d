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
///
/// Two words differ in one character where they are equal without it, so one look-up for each character does, however many
/// words there are.
pub fn misread(stem: &str) -> Option<&'static str> {
    static KNOWN: LazyLock<HashSet<&str>> = LazyLock::new(|| OTHERS.split_whitespace().collect());
    let letters: Vec<char> = stem.chars().collect();
    let has_length = (EXTENDED_LETTERS_MIN..=LETTERS_MAX).contains(&letters.len());
    if !has_length || dictionary::listed(stem).is_some() || KNOWN.contains(stem) {
        return None;
    }
    let missing = spelt(stem).iter().filter(|(_, missing)| missing.is_some());
    let wrong_or_extra = (0..letters.len()).flat_map(|at| {
        let is_end = at == 0 || at + 1 == letters.len();
        spelt(&without(&letters, at)).iter().filter(move |(word, missing)| match missing {
            None => is_end || word.chars().count() >= MISREAD_LETTERS_MIN,
            Some(missing) => *missing == at,
        })
    });
    // The smallest of several, that the answer does not depend on the order of a table.
    missing.chain(wrong_or_extra).map(|(word, _)| *word).min()
}

/// Returns the generic word of which a code is a misreading, with a digit for a letter: "SAL1DA". Its last character is
/// none, for "salida1" is exit 1.
pub fn misread_code(code: &str) -> Option<&'static str> {
    let letters: Vec<char> = code.chars().collect();
    let mut digits = (0..letters.len()).filter(|at| !letters[*at].is_alphabetic());
    let (Some(at), None) = (digits.next(), digits.next()) else { return None };
    let is_inside = at > 0 && at + 1 < letters.len();
    let words = spelt(&without(&letters, at)).iter();
    words.filter(|(_, missing)| is_inside && *missing == Some(at)).map(|(word, _)| *word).min()
}

fn without(letters: &[char], at: usize) -> String {
    letters[..at].iter().chain(&letters[at + 1..]).collect()
}

/// A word that may be misread, with the place of the character that is missing.
type Spelt = (&'static str, Option<usize>);

/// Returns the words that may be misread so.
fn spelt(spelling: &str) -> &'static [Spelt] {
    static SPELLINGS: LazyLock<HashMap<String, Vec<Spelt>>> = LazyLock::new(|| {
        let mut spellings: HashMap<String, Vec<Spelt>> = HashMap::new();
        // Scripts without capitals have no letter that an arrow is taken for.
        let is_drawn =
            |(reading, word): &(Reading, &str)| *reading == Drawn && word.chars().all(char::is_lowercase);
        for (_, word) in entries().filter(is_drawn) {
            let letters: Vec<char> = word.chars().collect();
            if letters.len() >= EXTENDED_LETTERS_MIN || word == EXIT {
                spellings.entry(word.to_owned()).or_default().push((word, None));
            }
            let first = usize::from(letters.len() < FIRST_MISREAD_LETTERS_MIN);
            for at in (first..letters.len()).filter(|_| letters.len() >= MISREAD_LETTERS_MIN) {
                spellings.entry(without(&letters, at)).or_default().push((word, Some(at)));
            }
        }
        spellings
    });
    SPELLINGS.get(spelling).map_or(&[], Vec::as_slice)
}

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
