//! Words on the signs of every building, in the languages that buildings use. They tell nothing of a place.

mod concepts;

use std::collections::HashMap;
use std::sync::LazyLock;

use self::concepts::CONCEPTS;
pub use self::concepts::{OTHERS, Reading};

/// No word of the table is longer.
pub const LETTERS_MAX: usize = 24;

/// Returns all words that are generic by themselves.
pub fn words() -> impl Iterator<Item = &'static str> {
    entries().map(|(_, entry)| entry).filter(|entry| !entry.contains('_'))
}

/// Returns the concept of a word that is generic by itself: one name for the word in all languages.
pub fn concept(word: &str) -> Option<&'static str> {
    static CONCEPT_OF: LazyLock<HashMap<&str, &str>> = LazyLock::new(|| {
        let words = CONCEPTS
            .iter()
            .flat_map(|(concept, _, words)| words.split_whitespace().map(|word| (word, *concept)));
        words.collect()
    });
    CONCEPT_OF.get(word).copied()
}

/// Returns how many words, read from the first, are a generic phrase of words that mean other things alone; 0 if none.
pub fn phrase(bare: &[String]) -> usize {
    static PHRASES: LazyLock<HashMap<&str, Vec<Vec<&str>>>> = LazyLock::new(|| {
        let mut phrases: HashMap<&str, Vec<Vec<&str>>> = HashMap::new();
        for (_, entry) in entries().filter(|(_, entry)| entry.contains('_')) {
            let words: Vec<&str> = entry.split('_').collect();
            phrases.entry(words[0]).or_default().push(words);
        }
        phrases
    });
    let Some(phrases) = bare.first().and_then(|first| PHRASES.get(first.as_str())) else { return 0 };
    let begins =
        |words: &&Vec<&str>| bare.len() >= words.len() && words.iter().zip(bare).all(|(a, b)| a == b);
    phrases.iter().filter(begins).map(Vec::len).max().unwrap_or(0)
}

/// Returns every word with whether a pictogram is drawn beside it.
pub fn entries() -> impl Iterator<Item = (Reading, &'static str)> {
    CONCEPTS.iter().flat_map(|(_, reading, words)| words.split_whitespace().map(|word| (*reading, word)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::semantics::parsing::normalise::{bare, clean, fold};

    #[test]
    fn every_entry_is_in_its_normal_form() {
        for (_, entry) in entries() {
            for word in entry.split('_') {
                assert_eq!(bare(&fold(&clean(word))), word);
            }
            assert!(entry.chars().count() <= LETTERS_MAX, "{entry}");
        }
    }

    #[test]
    fn every_word_stands_once_and_no_other_word_is_generic() {
        let mut seen = HashMap::new();
        for (concept, _, words) in CONCEPTS {
            for word in words.split_whitespace() {
                assert_eq!(seen.insert(word, concept), None, "{word}");
            }
        }
        assert_eq!(OTHERS.split_whitespace().find(|other| seen.contains_key(other)), None);
    }
}
