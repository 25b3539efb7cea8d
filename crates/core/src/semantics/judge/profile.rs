//! Profiles of texts: they decide which texts match, where two texts have no rare word in common.
//!
//! Thousands of signs that differ in a name have few profiles: the names count by their weight alone.

use crate::semantics::lexicon::dictionary::Class;
use crate::semantics::lexicon::words::{self, Word};
use crate::semantics::parsing::direction::{Bearing, Directions};
use crate::semantics::text::Text;

/// The frequent words of a text without a name, and the weight of its rare ones.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Profile {
    words: Vec<Word>,
    rare_weight: u32,
    negated: Vec<Word>,
    directions: Directions,
}

impl Text {
    /// Returns the profile, given which words are frequent. None if words alone do not decide about the text.
    pub fn profile(&self, is_frequent: impl Fn(&str) -> bool) -> Option<Profile> {
        if self.has_name() || self.words.is_empty() || self.information.level == 1 {
            return None;
        }
        // Looks and quantities that differ speak against a match, so they are never left out.
        let counts =
            |word: &&Word| matches!(word.class, Class::Look | Class::Quantity) || is_frequent(&word.text);
        let rare = self.words.iter().filter(|word| !counts(word));
        Some(Profile {
            rare_weight: rare.map(Word::weight).sum(),
            words: self.words.iter().filter(counts).cloned().collect(),
            negated: self.negated.clone(),
            directions: self.directions,
        })
    }

    /// Returns the stems of its words.
    pub fn stems(&self) -> impl Iterator<Item = &str> {
        self.words.iter().map(|word| word.text.as_str())
    }
}

impl Profile {
    /// Whether different texts of these profiles reach a level, 4 or 5, if no rare word is in both.
    /// With such a word they are at least as alike.
    pub fn reaches(&self, other: &Profile, level: u8) -> bool {
        let overlap =
            words::overlap(&self.words, &other.words).with_different(self.rare_weight + other.rare_weight);
        self.negated == other.negated
            && self.directions.bearing(other.directions) == Bearing::Same
            && overlap.level() >= level
            && !overlap.looks_clash()
            && !overlap.details_differ()
    }
}
