//! MergeText, §IV-A.2: one text that says what two texts say.

use std::collections::BTreeSet;

use crate::semantics::lexicon::dictionary;
use crate::semantics::lexicon::role::{self, Role};
use crate::semantics::lexicon::words::Word;
use crate::semantics::names::identifier::Identifier;
use crate::semantics::parsing::frame;
use crate::semantics::parsing::normalise;
use crate::semantics::parsing::reading::{self, Mention, What};
use crate::semantics::parsing::token;
use crate::semantics::parsing::token::Token;
use crate::semantics::text::Text;

/// A merged text grows no further than this, as merging goes on for the life of a map.
const MAX_MERGED_BYTES: usize = 4096;

/// Returns the more informative text, followed by what only the other one says, in its own words. Symmetric; `merge(a,
/// a) == a`.
pub fn merge(a: &str, b: &str) -> String {
    let (a, b) = (Part::new(a), Part::new(b));
    let (base, other) = if a.rank() >= b.rank() { (a, b) } else { (b, a) };
    if other.text.information_level() == 1 || base.says_all_of(&other) {
        return base.raw.to_owned();
    }
    if other.says_all_of(&base) {
        return other.raw.to_owned();
    }
    let start = base.clean.trim_end_matches([' ', '.', ',', ';']);
    let merged = join(start, &base.missing_phrases(&other));
    // A phrase out of its sentence can read otherwise ("3" of "3 boats"); then the whole sentence must do.
    if Part::new(&merged).says_just(&base, &other) { merged } else { join(start, &[&other.clean]) }
}

fn join(start: &str, phrases: &[&str]) -> String {
    phrases.iter().fold(start.to_owned(), |mut merged, phrase| {
        if merged.len() + phrase.len() + 2 <= MAX_MERGED_BYTES {
            merged.push_str(", ");
            merged.push_str(phrase);
        }
        merged
    })
}

struct Part<'t> {
    raw: &'t str,
    clean: String,
    text: Text,
}

impl<'t> Part<'t> {
    fn new(raw: &'t str) -> Part<'t> {
        Part { raw, clean: normalise::clean(raw), text: Text::parse(raw) }
    }

    /// Total order on raw texts, the most informative last.
    fn rank(&self) -> impl Ord + '_ {
        let content = self.text.identifiers.len() + self.text.words.len();
        let with_role =
            self.text.identifiers.iter().filter(|identifier| identifier.role != Role::Neutral).count();
        // Which text leads is about what it says: a floor's number does, though it is worth less alone.
        let level = if with_role > 0 { 5 } else { self.text.information_level() };
        (level, with_role, content, self.text.normalised(), self.raw)
    }

    fn says_all_of(&self, other: &Part<'_>) -> bool {
        let identifiers = other.text.identifiers.iter().all(|identifier| self.identifies(identifier));
        let words = other.text.words.iter().all(|word| other.is_mere_role(word) || self.says(word, false));
        identifiers && words && other.text.negated.iter().all(|word| self.text.negated.contains(word))
    }

    /// Both, and no identifier besides.
    fn says_just(&self, a: &Part<'_>, b: &Part<'_>) -> bool {
        let known = |found: &Identifier| {
            let mut both = a.text.identifiers.iter().chain(&b.text.identifiers);
            both.any(|identifier| {
                identifier.value == found.value && identifier.role.is_compatible(&found.role)
            })
        };
        self.says_all_of(a) && self.says_all_of(b) && self.text.identifiers.iter().all(known)
    }

    /// A bare 10 does not say "floor 10", but floor 10 says 10, and a bare 901 is a room's.
    fn identifies(&self, identifier: &Identifier) -> bool {
        let is_bare_room = |role: &Role| matches!(role, Role::Neutral | Role::Room);
        let says = |known: &Identifier| {
            let covers = known.role != Role::Neutral || is_bare_room(&identifier.role);
            covers && known.role.is_compatible(&identifier.role)
        };
        self.text.identifiers.iter().any(|known| known.value == identifier.value && says(known))
    }

    /// Returns the "Zimmer" of "Zimmer 901" adds nothing to "room 901".
    fn is_mere_role(&self, word: &Word) -> bool {
        !self.text.identifiers.is_empty() && role::role_of(&word.text).is_some()
    }

    fn says(&self, word: &Word, negated: bool) -> bool {
        if negated {
            self.text.negated.contains(word)
        } else {
            self.text.words.contains(word) || self.frames(word)
        }
    }

    /// The "painting" of "a painting of a boat" is said, though it does not count.
    fn frames(&self, word: &Word) -> bool {
        let is_word = |token: &Token<'_>| dictionary::stem(&normalise::bare(token.text)) == word.text;
        frame::is_noun(&word.text) && token::tokenise(self.text.normalised()).iter().any(is_word)
    }

    /// Returns the phrases of `other` that say something new, as written there; neighbours stay together.
    fn missing_phrases<'o>(&self, other: &'o Part<'_>) -> Vec<&'o str> {
        let tokens = token::tokenise(&other.clean);
        let mut said = BTreeSet::new();
        let mut spans: Vec<(usize, usize)> = Vec::new();
        for Mention { what, first, end } in reading::read(&tokens).mentions {
            let (missing, key) = match &what {
                What::Identifier(identifier) => (!self.identifies(identifier), identifier.value.clone()),
                What::Word { word, negated } => (
                    !self.says(word, *negated) && (*negated || !other.is_mere_role(word)),
                    format!("{negated} {}", word.text),
                ),
                What::Article(_) => continue,
            };
            if !missing || !said.insert((matches!(what, What::Word { .. }), key)) {
                continue;
            }
            match spans.last_mut() {
                Some((_, last)) if first <= *last && !tokens[first].after_break => *last = end.max(*last),
                _ => spans.push((first, end)),
            }
        }
        spans
            .into_iter()
            .map(|(first, end)| &other.clean[tokens[first].start..tokens[end - 1].end()])
            .collect()
    }
}
