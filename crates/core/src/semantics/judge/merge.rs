//! MergeText, §IV-A.2: one text that says what two texts say.

use std::collections::BTreeSet;

use crate::semantics::lexicon::dictionary::{self, Class};
use crate::semantics::lexicon::role::{self, Role};
use crate::semantics::names::name::NameBuilder;
use crate::semantics::parsing::reading::{self, What};
use crate::semantics::parsing::{normalise, token};
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
    let read = Part::new(&merged);
    let is_said = |phrase: &Phrase| base.knows.contains(&phrase.says) || other.knows.contains(&phrase.says);
    let is_faithful = read.says_all_of(&base) && read.says_all_of(&other) && read.phrases.iter().all(is_said);
    if is_faithful { merged } else { join(start, &[&other.clean]) }
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

/// One thing that a text says.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Said {
    /// A number, and what it is of.
    Number(Role, String),
    /// A word, stated or denied.
    Word(String, bool),
}

/// A stretch of a text that says one thing: its bytes, and whether it goes on from the one before.
struct Phrase {
    says: Said,
    start: usize,
    end: usize,
    goes_on: bool,
}

struct Part<'t> {
    raw: &'t str,
    clean: String,
    text: Text,
    phrases: Vec<Phrase>,
    /// All that it need not be told, be it only in passing.
    knows: BTreeSet<Said>,
}

impl<'t> Part<'t> {
    fn new(raw: &'t str) -> Part<'t> {
        let (clean, text) = (normalise::clean(raw), Text::parse(raw));
        let tokens = token::tokenise(&clean);
        let mut phrases = Vec::new();
        // The "painting" of "a painting of a boat" is said, though it does not count.
        let stems = tokens.iter().map(|token| dictionary::stem(&normalise::bare(token.text)));
        let generic = stems.filter(|stem| dictionary::listed(stem) == Some(Class::Generic));
        let mut knows: BTreeSet<Said> = generic.map(|stem| Said::Word(stem, false)).collect();
        let mut last = 0;
        for mention in reading::read(&tokens).mentions {
            let says = match mention.what {
                What::Number(role, number) => {
                    let mut name = NameBuilder::default();
                    name.code(&number, str::to_owned);
                    let number = name.build().map_or(number, |name| name.key().to_owned());
                    // Floor 10 says 10, too; a bare 10 is a room's, and no floor's.
                    let bare = if role == Role::Neutral { Role::Room } else { Role::Neutral };
                    knows.insert(Said::Number(bare, number.clone()));
                    Said::Number(role, number)
                }
                What::Word { word, .. } if word.class == Class::Function => continue,
                // The "Zimmer" of "Zimmer 901" adds nothing to "room 901".
                What::Word { word, negated: false }
                    if text.has_name() && role::role_of(&word.text).is_some() =>
                {
                    continue;
                }
                What::Word { word, negated } => {
                    knows.insert(Said::Word(word.text.clone(), false));
                    Said::Word(word.text, negated)
                }
            };
            knows.insert(says.clone());
            let (first, end) = (mention.first, mention.end);
            let goes_on = first <= last && !tokens[first].after_break;
            phrases.push(Phrase { says, start: tokens[first].start, end: tokens[end - 1].end(), goes_on });
            last = end;
        }
        Part { raw, clean, text, phrases, knows }
    }

    /// Total order on raw texts, the most informative last.
    fn rank(&self) -> impl Ord + '_ {
        let is_of_something =
            |phrase: &&Phrase| matches!(phrase.says, Said::Number(role, _) if role != Role::Neutral);
        let with_role = self.phrases.iter().filter(is_of_something).count();
        // Which text leads is about what it says: a floor's number does, though it is worth less alone.
        let level = if with_role > 0 { 5 } else { self.text.information_level() };
        (level, with_role, self.phrases.len(), self.text.normalised(), self.raw)
    }

    fn says_all_of(&self, other: &Part<'_>) -> bool {
        other.phrases.iter().all(|phrase| self.knows.contains(&phrase.says))
    }

    /// Returns the phrases of `other` that say something new, as written there; neighbours stay together.
    fn missing_phrases<'o>(&self, other: &'o Part<'_>) -> Vec<&'o str> {
        let mut said = BTreeSet::new();
        let mut spans: Vec<(usize, usize)> = Vec::new();
        let mut is_open = false;
        for phrase in &other.phrases {
            let is_new = !self.knows.contains(&phrase.says) && said.insert(&phrase.says);
            match spans.last_mut() {
                Some((_, end)) if is_new && is_open && phrase.goes_on => *end = phrase.end.max(*end),
                _ if is_new => spans.push((phrase.start, phrase.end)),
                _ => {}
            }
            is_open = is_new;
        }
        spans.into_iter().map(|(start, end)| &other.clean[start..end]).collect()
    }
}
