//! A parsed description: parsed once, compared often.

use std::hash::{Hash, Hasher};

use crate::semantics::judge::information::{self, ENOUGH_SPECIFIC_WORDS, Information};
use crate::semantics::judge::kind::{self, TextKind};
use crate::semantics::lexicon::dictionary::Class;
use crate::semantics::lexicon::role::{self, Role};
use crate::semantics::lexicon::stable_hash::hash;
use crate::semantics::lexicon::words::{self, Word};
use crate::semantics::names::code;
use crate::semantics::names::name::{Name, PartKind};
use crate::semantics::names::numbering::{Numbering, Standing};
use crate::semantics::names::shape::Shape;
use crate::semantics::parsing::direction::Directions;
use crate::semantics::parsing::naming::{self, Names};
use crate::semantics::parsing::reading::{self, Reading};
use crate::semantics::parsing::{normalise, token};

/// A parsed description. Two are equal when their normalised forms are.
///
/// Everything but the information level follows from the normalised form; that level also sees capital letters,
/// which tell proper names.
#[derive(Clone, Debug)]
pub struct Text {
    normalised: String,
    /// The object's own name, unless it has none or its number is none of the building's.
    pub(super) own: Option<Name>,
    /// Names of the parts of a building around the object, by role.
    pub(super) containers: Vec<(Role, Name)>,
    /// The object's own name, where its number is none of the building's.
    pub(super) foreign: Option<Name>,
    pub(super) standing: Standing,
    kind: TextKind,
    gist: Box<str>,
    /// Sorted, without duplicates.
    pub(super) words: Vec<Word>,
    /// Those of `words` that a "no" or "not" bears on.
    pub(super) negated: Vec<Word>,
    pub(super) directions: Directions,
    pub(super) information: Information,
    keys: Vec<u64>,
}

impl Text {
    /// Parses a description. Any text will do; only the first 256 tokens count.
    pub fn parse(raw: &str) -> Text {
        Text::under(raw, None)
    }

    /// Parses a description in a building whose numbering may be known.
    pub fn under(raw: &str, numbering: Option<&Numbering>) -> Text {
        let is_code = numbering.is_some_and(Numbering::is_of_codes);
        let code = if is_code { Some(code::exact(raw)) } else { code::by_form(raw) };
        if let Some(code) = code.filter(|code| !code.is_empty()) {
            let names = Names { own: Name::exactly(PartKind::Code, &code), containers: Vec::new() };
            return Text::of(&code, code.clone(), &Reading::default(), names, None);
        }
        let clean = normalise::clean(raw);
        let normalised = normalise::fold(&clean);
        let tokens = token::tokenise(&normalised);
        let reading = reading::read(&tokens);
        let names = naming::names(&reading, &tokens);
        Text::of(&clean, normalised.clone(), &reading, names, numbering)
    }

    fn of(clean: &str, normalised: String, read: &Reading, names: Names, under: Option<&Numbering>) -> Text {
        let Names { mut own, containers } = names;
        let gist = gist(&normalised, own.as_ref(), &containers);
        let mut standing = Standing::Whole;
        match (under, &own) {
            (Some(numbering), _) if numbering.matches_whole(&normalised) => {
                own = Name::exactly(PartKind::Word, &normalised);
            }
            (Some(numbering), Some(name)) => standing = numbering.standing(name),
            _ => {}
        }
        let foreign = if standing == Standing::Foreign { own.take() } else { None };
        let [words, negated] = [false, true].map(|negated_only| {
            let counts = |word: &&Word| {
                // The "level" of "Level 5" is in its name.
                word.class != Class::Function && (containers.is_empty() || !role::names_container(&word.text))
            };
            sorted(read.words(negated_only).filter(counts).cloned().collect())
        });
        let directions = Directions::among(&words);
        let mut text = Text {
            directions: if own.is_some() { directions.without_compass() } else { directions },
            normalised,
            own,
            containers,
            foreign,
            standing,
            kind: TextKind::Unknown,
            gist,
            words,
            negated,
            information: Information::default(),
            keys: Vec::new(),
        };
        text.information = information::assess(&text, clean, read);
        text.kind = kind::kind(&text, clean, read);
        // It names nothing here, and is still a difference: "Turing 12" is not "Turing 14".
        let foreign =
            text.foreign.as_ref().map(|name| Word::of_class(Class::Quantity, name.spelt().to_owned()));
        text.words.extend(foreign);
        text.words = sorted(text.words);
        text.keys = text.blocking_keys();
        text
    }

    /// Whether a description reads like this one: it has the same [gist](Self::gist). Parses it only where names are compared.
    pub fn reads_as(&self, raw: &str) -> bool {
        match (self.kind, self.own.is_some() || self.foreign.is_some()) {
            (TextKind::Code, _) => code::exact(raw) == self.normalised,
            (_, true) => *Text::parse(raw).gist == *self.gist,
            (_, false) => normalise::fold(&normalise::clean(raw)) == self.normalised,
        }
    }

    /// Returns the canonical form; equal forms are identical descriptions.
    pub fn normalised(&self) -> &str {
        &self.normalised
    }

    /// Returns what two readings share that are alike: the names in their one spelling if there are any, else the canonical
    /// form. No numbering changes it.
    pub fn gist(&self) -> &str {
        &self.gist
    }

    /// Returns how the object's own name is written; none if it has no number.
    pub fn shape(&self) -> Option<Shape> {
        self.own.as_ref().or(self.foreign.as_ref()).and_then(Shape::of)
    }

    /// Returns what kind of text it is.
    pub fn kind(&self) -> TextKind {
        self.kind
    }

    /// Whether it lacks parts that most names of the building have: it may be any of those with its parts.
    pub fn is_partial(&self) -> bool {
        self.standing == Standing::Partial
    }

    /// Whether all parts of its name are among those of a fuller reading, in their order.
    pub fn is_part_of(&self, fuller: &Text) -> bool {
        self.own.as_ref().zip(fuller.own.as_ref()).is_some_and(|(part, whole)| part.is_part_of(whole))
    }

    /// Returns the object's own name, if it has one of the building's, and those of the parts of a building around it.
    pub fn names(&self) -> impl Iterator<Item = &Name> {
        self.own.iter().chain(self.containers.iter().map(|(_, name)| name))
    }

    /// Whether it names the object, or a part of a building.
    pub fn has_name(&self) -> bool {
        self.names().next().is_some()
    }

    /// Whether it numbers the object itself: "room 901", "HUB 10", but not "Level 5" nor "kitchen, wing B".
    pub fn has_own_name(&self) -> bool {
        self.own.is_some()
    }

    /// InformationLevel, §IV-A.2: 1 to 5.
    pub fn information_level(&self) -> u8 {
        self.information.level
    }

    /// Returns the names and directions, if they alone decide whether this text and another that has an identity, but reads
    /// differently, reach level 4. None where words decide as well.
    pub fn identity(&self) -> Option<Identity> {
        let is_decisive = self.negated.is_empty() && self.information.level > 1 && !self.is_partial();
        let own = self.own.as_ref().filter(|_| is_decisive)?;
        let of_container = |(role, name): &(Role, Name)| (*role, name.spelt().into());
        Some(Identity {
            own: own.spelt().into(),
            is_code: own.is_code(),
            containers: self.containers.iter().map(of_container).collect(),
            directions: self.directions,
        })
    }

    /// Whether the text has a name, but no identity.
    pub fn is_undecided_by_identity(&self) -> bool {
        self.has_name() && self.identity().is_none()
    }

    /// Whether words tell the object: it says something, has no name of its own nor a number that is none of the building's,
    /// and more than a floor or building.
    pub fn is_told_by_words(&self) -> bool {
        self.own.is_none()
            && self.foreign.is_none()
            && self.information.level > 1
            && !self.information.is_container_alone
    }

    /// Whether a text of a kind, which its own kind may be or what described it makes of it, may hang in many places: it is
    /// neither a name with a number, nor a code, nor a description that says enough.
    pub fn needs_witness(&self, kind: TextKind) -> bool {
        match kind {
            TextKind::Name | TextKind::Code => self.own.is_none(),
            TextKind::Description => !self.is_described(),
            _ => true,
        }
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

    /// Blocking keys, sorted, without duplicates: two informative texts of level 4 or more share one, so that only texts
    /// sharing one need comparing.
    pub fn keys(&self) -> &[u64] {
        &self.keys
    }

    /// Of its own name if it has one, else of its most telling words, else of the floor or building: what is on one side only
    /// never gives level 4, so these kinds need not meet.
    fn blocking_keys(&self) -> Vec<u64> {
        sorted(match &self.own {
            Some(own) => vec![own.look_alike()],
            None if self.words.is_empty() => {
                self.containers.iter().map(|(_, name)| hash(b'c', name.key())).collect()
            }
            None => words::prefix(&self.words).iter().map(|word| hash(b'w', &word.text)).collect(),
        })
    }
}

/// The names and directions of a text that is judged by these alone.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Identity {
    own: Box<str>,
    is_code: bool,
    containers: Vec<(Role, Box<str>)>,
    directions: Directions,
}

/// Returns the gist of a text with these names.
fn gist(normalised: &str, own: Option<&Name>, containers: &[(Role, Name)]) -> Box<str> {
    let Some(own) = own else { return normalised.into() };
    let containers = containers.iter().map(|(role, name)| format!("{} {}", role.as_str(), name.spelt()));
    containers.chain([own.spelt().to_owned()]).collect::<Vec<_>>().join(", ").into()
}

fn sorted<T: Ord>(mut all: Vec<T>) -> Vec<T> {
    all.sort_unstable();
    all.dedup();
    all
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
