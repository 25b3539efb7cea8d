//! A parsed description: parsed once, compared often.

use std::hash::{Hash, Hasher};

use crate::semantics::judge::blocking_keys;
use crate::semantics::judge::information::{self, ENOUGH_SPECIFIC_WORDS, Information};
use crate::semantics::judge::kind::{self, TextKind};
use crate::semantics::lexicon::dictionary::Class;
use crate::semantics::lexicon::role::{self, Role};
use crate::semantics::lexicon::words::Word;
use crate::semantics::names::code;
use crate::semantics::names::identifier::Identifier;
use crate::semantics::names::name::{Name, NameBuilder, PartKind};
use crate::semantics::names::numbering::{Numbering, Standing};
use crate::semantics::names::shape::Shape;
use crate::semantics::parsing::direction::Directions;
use crate::semantics::parsing::looks::Looks;
use crate::semantics::parsing::naming::{self, Names};
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
    /// The object's own name, unless it has none or its number is none of the building's.
    pub(super) own: Option<Name>,
    /// Names of the parts of a building around the object, by role.
    pub(super) containers: Vec<(Role, Name)>,
    /// The object's own name, where its number is none of the building's.
    pub(super) foreign: Option<Name>,
    standing: Standing,
    kind: TextKind,
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
        let code = if numbering.is_some_and(Numbering::is_of_codes) {
            Some(code::exact(raw))
        } else {
            code::by_form(raw)
        };
        if let Some(code) = code.filter(|code| !code.is_empty()) {
            return Text::of_code(code);
        }
        let clean = normalise::clean(raw);
        let normalised = normalise::fold(&clean);
        let tokens = token::tokenise(&normalised);
        let reading = reading::read(&tokens);
        let looks = Looks::among(&reading.mentions, &tokens);
        let Names { mut own, containers } = naming::names(&reading, &tokens);
        let mut identifiers = identifiers_of(&reading.mentions);
        let gist = gist(&normalised, own.as_ref(), &containers);
        let mut standing = Standing::Whole;
        if let Some(numbering) = numbering {
            if numbering.matches_whole(&normalised) {
                own = whole(&normalised);
                identifiers.retain(|identifier| !identifier.role.is_container());
                if identifiers.is_empty() {
                    identifiers.push(Identifier::new(Role::Neutral, &normalised));
                }
            } else if let Some(name) = &own {
                standing = numbering.standing(name);
            }
        }
        let foreign = if standing == Standing::Foreign { own.take() } else { None };
        if foreign.is_some() {
            identifiers.retain(|identifier| identifier.role.is_container());
        }
        let (mut words, mut negated) = (Vec::new(), Vec::new());
        for mention in reading.mentions {
            if let What::Word { word, negated: denied } = mention.what {
                if denied {
                    negated.push(word.clone());
                }
                words.push(word);
            }
        }
        for set in [&mut words, &mut negated] {
            if !containers.is_empty() {
                // The "level" of "Level 5" is in its name.
                set.retain(|word| !role::names_container(&word.text));
            }
            set.sort_unstable();
            set.dedup();
        }
        let directions = Directions::among(&words);
        let directions = if own.is_some() { directions.without_compass() } else { directions };
        let information =
            information::assess(&clean, &normalised, &identifiers, own.is_some(), &words, &negated);
        let kind = kind::kind(&kind::Found {
            clean: &clean,
            name: own.as_ref(),
            has_containers: !containers.is_empty(),
            is_doubtful: standing == Standing::Doubtful,
            is_of_picture: reading.is_of_picture,
            words: &words,
            negated: &negated,
            information: &information,
        });
        // It names nothing here, and is still a difference: "Turing 12" is not "Turing 14".
        words.extend(foreign.iter().map(|name| Word::of_class(Class::Quantity, name.spelt().to_owned())));
        words.sort_unstable();
        words.dedup();
        let keys = blocking_keys::of_text(own.as_ref(), &containers, &words);
        Text {
            normalised,
            identifiers,
            own,
            containers,
            foreign,
            standing,
            kind,
            gist,
            words,
            negated,
            directions,
            looks,
            information,
            keys,
        }
    }

    fn of_code(code: String) -> Text {
        let own = code::name(&code);
        let keys = blocking_keys::of_text(own.as_ref(), &[], &[]);
        Text {
            identifiers: vec![Identifier::exactly(&code)],
            own,
            containers: Vec::new(),
            foreign: None,
            standing: Standing::Whole,
            kind: TextKind::Code,
            gist: code.as_str().into(),
            normalised: code,
            words: Vec::new(),
            negated: Vec::new(),
            directions: Directions::default(),
            looks: Looks::default(),
            information: Information::of_code(),
            keys,
        }
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

    /// Returns the identifiers, sorted, without duplicates.
    pub fn identifiers(&self) -> &[Identifier] {
        &self.identifiers
    }

    /// InformationLevel, §IV-A.2: 1 to 5.
    pub fn information_level(&self) -> u8 {
        self.information.level
    }

    /// Returns the names and directions, if they alone decide whether this text and another that has an identity, but reads
    /// differently, reach level 4. None where words decide as well.
    pub fn identity(&self) -> Option<Identity> {
        let own = self.own.as_ref().filter(|_| {
            self.negated.is_empty() && self.information.level > 1 && self.standing != Standing::Partial
        })?;
        let of_container = |(role, name): &(Role, Name)| (role.clone(), name.spelt().into());
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

    /// Whether it numbers the object itself: "room 901", "HUB 10", but not "Level 5" nor "kitchen, wing B".
    pub fn has_own_identifier(&self) -> bool {
        self.own.is_some()
    }

    /// Whether it names the object, or a part of a building.
    pub(super) fn has_name(&self) -> bool {
        self.own.is_some() || !self.containers.is_empty()
    }

    /// Whether words tell the object: it says something, has no identifier of its own nor a number that is none of the
    /// building's, and more than a floor or building.
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

    /// Blocking keys, sorted, without duplicates: two informative texts of level 4 or more share one.
    pub fn keys(&self) -> &[u64] {
        &self.keys
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

/// Returns the name of a text that is compared whole.
fn whole(normalised: &str) -> Option<Name> {
    let mut name = NameBuilder::default();
    name.exactly(PartKind::Word, normalised);
    name.build()
}

/// "room 901, number 901" numbers one thing: the reading with a role stays.
fn identifiers_of(mentions: &[Mention]) -> Vec<Identifier> {
    let found = mentions.iter().filter_map(|mention| match &mention.what {
        What::Identifier(identifier) => Some(identifier.clone()),
        What::Word { .. } | What::Article(_) => None,
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
