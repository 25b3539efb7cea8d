//! Lists of words, written with spaces between.

use std::collections::HashSet;
use std::sync::OnceLock;

/// A list of words, which is looked up by hash: a text asks several lists about each of its words.
pub struct WordList {
    written: &'static str,
    words: OnceLock<HashSet<&'static str>>,
}

impl WordList {
    /// Returns the list of these words.
    pub const fn of(written: &'static str) -> Self {
        Self { written, words: OnceLock::new() }
    }

    /// Whether it has a word.
    pub fn has(&self, word: &str) -> bool {
        self.words.get_or_init(|| self.iter().collect()).contains(word)
    }

    /// Returns the words, as written.
    pub fn iter(&self) -> impl Iterator<Item = &'static str> + use<> {
        self.written.split_whitespace()
    }
}
