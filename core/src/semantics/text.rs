//! A parsed description: parsed once, compared often.

use std::collections::BTreeSet;
use std::hash::{Hash, Hasher};

use crate::semantics::identifiers::identifier::Identifier;
use crate::semantics::identifiers::numbering::{Numbering, Sorted};
use crate::semantics::judge::blocking_keys;
use crate::semantics::judge::information::{self, ENOUGH_SPECIFIC_WORDS, Information};
use crate::semantics::lexicon::dictionary::Class;
use crate::semantics::lexicon::role;
use crate::semantics::lexicon::words::Word;
use crate::semantics::parsing::direction::Directions;
use crate::semantics::parsing::looks::Looks;
use crate::semantics::parsing::reading::{self, Mention, What};
use crate::semantics::parsing::{normalise, token};

/// Identifiers kept of one text, so that comparing two hostile texts stays cheap.
pub const MAX_IDENTIFIERS: usize = 32;

/// A parsed description. Two are equal when their normalised forms are.
///
/// Everything but the information level follows from the normalised form; that level also sees capital letters,
/// which tell proper names.
#[derive(Clone, Debug)]
pub struct Text {
    normalised: String,
    pub(super) identifiers: Vec<Identifier>,
    /// Those of `identifiers` that number the object itself and not the floor, wing or building around it.
    pub(super) own: Vec<Identifier>,
    /// Numbers and codes that are none of the building's.
    pub(super) foreign: Vec<Identifier>,
    gist: Box<str>,
    /// Sorted, without duplicates.
    pub(super) words: Vec<Word>,
    /// Those of `words` that a "no" or "not" bears on.
    pub(super) negated: Vec<Word>,
    pub(super) directions: Directions,
    pub(super) looks: Looks,
    pub(super) information: Information,
    keys: Vec<u64>,
}

impl Text {
    /// Parses a description. Any text will do; only the first 256 tokens and
    /// 32 identifiers count.
    pub fn parse(raw: &str) -> Text {
        Text::under(raw, None)
    }

    /// Parses a description in a building whose numbering may be known.
    pub fn under(raw: &str, numbering: Option<&Numbering>) -> Text {
        let clean = normalise::clean(raw);
        let normalised = normalise::fold(&clean);
        let tokens = token::tokenise(&normalised);
        let mentions = reading::read(&tokens);
        let looks = Looks::among(&mentions, &tokens);
        let found = identifiers_of(&mentions);
        let gist = gist(&normalised, &found);
        let Sorted { identifiers, foreign } = match numbering {
            Some(numbering) => numbering.sort(&normalised, found),
            None => Sorted { identifiers: found, foreign: Vec::new() },
        };
        let (mut words, mut negated) = (Vec::new(), Vec::new());
        for mention in mentions {
            if let What::Word { word, negated: denied } = mention.what {
                if denied {
                    negated.push(word.clone());
                }
                words.push(word);
            }
        }
        for set in [&mut words, &mut negated] {
            if identifiers.iter().any(|identifier| identifier.role.is_container()) {
                // The "level" of "Level 5" is in its identifier.
                set.retain(|word| !role::names_container(&word.text));
            }
            set.sort_unstable();
            set.dedup();
        }
        let directions = Directions::among(&words);
        let information = information::assess(&clean, &normalised, &identifiers, &words, &negated);
        // It names nothing here, and is still a difference: "Turing 12" is not "Turing 14".
        words.extend(
            foreign.iter().map(|number| Word::of_class(Class::Quantity, number.value.to_lowercase())),
        );
        words.sort_unstable();
        words.dedup();
        let own: Vec<Identifier> =
            identifiers.iter().filter(|identifier| !identifier.role.is_container()).cloned().collect();
        let keys = blocking_keys::of_text(&identifiers, &own, &words);
        Text {
            normalised,
            identifiers,
            own,
            foreign,
            gist,
            words,
            negated,
            directions,
            looks,
            information,
            keys,
        }
    }

    /// Whether a description reads like this one: [`Self::parse`] would give it the same canonical form.
    pub fn reads_as(&self, raw: &str) -> bool {
        normalise::fold(&normalise::clean(raw)) == self.normalised
    }

    /// Returns the canonical form; equal forms are identical descriptions.
    pub fn normalised(&self) -> &str {
        &self.normalised
    }

    /// Returns the part that two readings share that are alike: the identifiers as written if there are any, else the
    /// canonical form. No numbering changes it.
    pub fn gist(&self) -> &str {
        &self.gist
    }

    /// Returns the identifiers, sorted, without duplicates.
    pub fn identifiers(&self) -> &[Identifier] {
        &self.identifiers
    }

    /// InformationLevel, §IV-A.2: 1 to 5.
    pub fn information_level(&self) -> u8 {
        self.information.level
    }

    /// Returns the identifiers and directions, if they alone decide whether this text and another that has an
    /// identity, but reads differently, reach level 4. None where words decide as well.
    ///
    /// Equal values of different roles ("floor 9, room 9") make the order of two texts count, so they have none.
    pub fn identity(&self) -> Option<Identity> {
        let repeats = |(at, identifier): (usize, &Identifier)| {
            self.identifiers[..at].iter().any(|before| before.value == identifier.value)
        };
        let decides = !self.own.is_empty()
            && self.negated.is_empty()
            && self.information.level > 1
            && !self.identifiers.iter().enumerate().any(repeats);
        decides.then(|| Identity { identifiers: self.identifiers.clone(), directions: self.directions })
    }

    /// Whether the text has an identifier, but no identity.
    pub fn is_undecided_by_identity(&self) -> bool {
        !self.identifiers.is_empty() && self.identity().is_none()
    }

    /// Whether it numbers the object itself: "room 901", "HUB 10", but not "Level 5" nor "kitchen, wing B".
    pub fn has_own_identifier(&self) -> bool {
        !self.own.is_empty()
    }

    /// Whether words tell the object: it says something, has no identifier of its own nor a number that is none of the
    /// building's, and more than a floor or building.
    pub fn is_told_by_words(&self) -> bool {
        self.own.is_empty()
            && self.foreign.is_empty()
            && self.information.level > 1
            && !self.information.is_container_alone
    }

    /// Whether it may hang in many places: no identifier of its own, and too few specific words for a description.
    pub fn needs_witness(&self) -> bool {
        self.own.is_empty() && !self.is_described()
    }

    /// Whether it has as many specific words as a description; no dots or window frames are read so.
    pub fn is_described(&self) -> bool {
        self.specific_words().count() >= ENOUGH_SPECIFIC_WORDS
    }

    /// Returns the words that tell one object from others.
    pub fn specific_words(&self) -> impl Iterator<Item = &str> {
        let specific = |word: &&Word| word.class == Class::Specific;
        self.words.iter().filter(specific).map(|word| word.text.as_str())
    }

    /// Blocking keys, sorted, without duplicates: two informative texts of level 4 or more share one.
    pub fn keys(&self) -> &[u64] {
        &self.keys
    }
}

/// The identifiers and directions of a text that is judged by these alone.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Identity {
    identifiers: Vec<Identifier>,
    directions: Directions,
}

/// Returns the gist of a text with these identifiers.
fn gist(normalised: &str, identifiers: &[Identifier]) -> Box<str> {
    let own = identifiers.iter().filter(|identifier| !identifier.role.is_container());
    let written: BTreeSet<&str> = own.map(Identifier::as_str).collect();
    if written.is_empty() {
        normalised.into()
    } else {
        written.into_iter().collect::<Vec<_>>().join(" ").into()
    }
}

/// "room 901, number 901" numbers one thing: the reading with a role stays.
fn identifiers_of(mentions: &[Mention]) -> Vec<Identifier> {
    let found = mentions.iter().filter_map(|mention| match &mention.what {
        What::Identifier(identifier) => Some(identifier.clone()),
        What::Word { .. } => None,
    });
    let mut found: Vec<Identifier> = found.take(MAX_IDENTIFIERS).collect();
    found.sort_unstable();
    // Roles sort before no role, so the first of equals is the one to keep.
    let mut kept: Vec<Identifier> = Vec::with_capacity(found.len());
    for identifier in found {
        let known = |k: &Identifier| k.value == identifier.value && k.role.is_compatible(&identifier.role);
        if !kept.iter().any(known) {
            kept.push(identifier);
        }
    }
    kept
}

impl PartialEq for Text {
    fn eq(&self, other: &Text) -> bool {
        self.normalised == other.normalised
    }
}

impl Eq for Text {}

impl Hash for Text {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.normalised.hash(state);
    }
}
