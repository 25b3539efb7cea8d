//! A parsed description: parsed once, compared often.

use std::hash::{Hash, Hasher};

use crate::named::named;
use crate::semantics::lexicon::dictionary::Class;
use crate::semantics::lexicon::role::Role;
use crate::semantics::lexicon::words::Word;
use crate::semantics::names::code;
use crate::semantics::names::name::Name;
use crate::semantics::names::numbering::Standing;
use crate::semantics::names::shape::Shape;
use crate::semantics::parsing::direction::Directions;

/// From this many specific words on, a text without identifier or name is worth an anchor.
pub const ENOUGH_SPECIFIC_WORDS: usize = 3;

named! {
    /// The kind of text that a description is. A description by a model or by hand is one, whatever its words.
    TextKind {
        /// A name with a number: "901", "ML D 28", "HUB 10", also of a floor.
        Name = "name",
        /// A proper name beside a word for what it names: "Meeting Room Turing".
        ProperName = "proper_name",
        /// A sentence or an instruction: "Please keep this door closed".
        Notice = "notice",
        /// A sign of every building: EXIT.
        CommonSign = "common_sign",
        /// A description of a thing by a sentence: "a painting of a boat".
        Description = "description",
        /// A code: a fiducial marker, a UUID, a link, or any text of the map's `code_classes`.
        Code = "code",
        /// None of these for all that is known: a word that the lexicon does not have may be a name, a notice, a brand or noise.
        Unknown = "unknown",
    }
}

impl TextKind {
    /// Returns the kind of a text of this kind that a model or a person wrote: what has no name describes a thing.
    pub fn described(self) -> Self {
        match self {
            Self::Name | Self::Code | Self::CommonSign => self,
            Self::ProperName | Self::Notice | Self::Description | Self::Unknown => Self::Description,
        }
    }
}

/// The worth of a text.
#[derive(Clone, Debug, Default)]
pub struct Information {
    /// 1 to 5.
    pub level: u8,
    /// Whether it only numbers parts of a building that hold many objects: "Level 5".
    pub is_container_alone: bool,
    pub(super) name: Option<String>,
}

/// A parsed description. Two are equal when their normalised forms are.
///
/// Everything but the information level follows from the normalised form; that level also sees capital letters,
/// which tell proper names.
#[derive(Clone, Debug)]
pub struct Text {
    pub(super) normalised: String,
    /// The object's own name, unless it has none or its number is none of the building's.
    pub(super) own: Option<Name>,
    /// Names of the parts of a building around the object, by role.
    pub(super) containers: Vec<(Role, Name)>,
    /// The object's own name, where its number is none of the building's.
    pub(super) foreign: Option<Name>,
    pub(super) standing: Standing,
    pub(super) kind: TextKind,
    pub(super) gist: Box<str>,
    /// Sorted, without duplicates.
    pub(super) words: Vec<Word>,
    /// Those of `words` that a "no" or "not" bears on.
    pub(super) negated: Vec<Word>,
    pub(super) directions: Directions,
    pub(super) information: Information,
    pub(super) keys: Vec<u64>,
}

impl Text {
    /// Whether a description reads like this one: it has the same [gist](Self::gist).
    pub fn reads_as(&self, raw: &str) -> bool {
        match self.kind {
            TextKind::Code => code::exact(raw) == self.normalised,
            _ => *Text::parse(raw).gist == *self.gist,
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
}

/// The names and directions of a text that is judged by these alone.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Identity {
    own: Box<str>,
    containers: Vec<(Role, Box<str>)>,
    directions: Directions,
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
