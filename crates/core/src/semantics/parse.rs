//! Parsing a description: from its characters to its names, its words, its worth and its kind.

use crate::semantics::judge::{information, kind};
use crate::semantics::lexicon::dictionary::Class;
use crate::semantics::lexicon::role::{self, Role};
use crate::semantics::lexicon::stable_hash::hash;
use crate::semantics::lexicon::words::{self, Word};
use crate::semantics::names::code;
use crate::semantics::names::name::{Name, PartKind};
use crate::semantics::names::numbering::{Numbering, Standing};
use crate::semantics::parsing::direction::Directions;
use crate::semantics::parsing::naming::{self, Names};
use crate::semantics::parsing::reading::{self, Reading};
use crate::semantics::parsing::{normalise, token};
use crate::semantics::text::{Information, Text, TextKind};

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
