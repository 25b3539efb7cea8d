//! Naming: assembles the names of a text from what its tokens say.
//!
//! Everything counts, unless it is known not to: the words "room" and "number", grammar, measures, arrows, and the looks of a
//! door. Of a caption only what stands beside the number is known to be on the sign.

use std::collections::BTreeMap;

use crate::semantics::lexicon::dictionary::{self, Class};
use crate::semantics::lexicon::generic;
use crate::semantics::lexicon::role::{self, Role};
use crate::semantics::lexicon::words::Word;
use crate::semantics::names::name::{Name, NameBuilder};
use crate::semantics::parsing::direction;
use crate::semantics::parsing::normalise::bare;
use crate::semantics::parsing::reading::{Mention, Reading, What};
use crate::semantics::parsing::token::Token;

/// The names in a text.
#[derive(Debug, Default)]
pub struct Names {
    /// The object's own.
    pub own: Option<Name>,
    /// Those of the parts of a building around it, by role; ascending, each role once.
    pub containers: Vec<(Role, Name)>,
}

/// Assembles the names. Without a number or code of its own, a text has none of the object.
pub fn names(reading: &Reading, tokens: &[Token<'_>]) -> Names {
    let mut own = NameBuilder::default();
    let mut numbers: Vec<&str> = Vec::new();
    let mut containers: BTreeMap<Role, NameBuilder> = BTreeMap::new();
    for (at, mention) in reading.mentions.iter().enumerate() {
        match &mention.what {
            What::Number(role, number) if role.is_container() => {
                let name = containers.entry(*role).or_insert_with(|| NameBuilder::after(role.as_str()));
                name.code(number, canonical);
            }
            // "901, room 901" says one number twice, "1 C 1" has two.
            What::Number(Role::Room, number) if numbers.contains(&number.as_str()) => {}
            What::Number(role, number) => {
                numbers.push(number);
                if let Role::Place(word) = role
                    && !own.ends_with(word)
                {
                    own.word(word, word);
                }
                own.code(number, canonical);
            }
            What::Word { word, negated: false } if counts(word, reading, at) => {
                let written: Vec<&str> =
                    tokens[mention.first..mention.end].iter().map(|token| token.text).collect();
                let said = if word.class == Class::Specific { written.concat() } else { word.text.clone() };
                own.word(&canonical(&said), &written.join(" "));
            }
            What::Word { .. } => {}
        }
    }
    let own = if numbers.is_empty() { None } else { own.build() };
    let containers = containers.into_iter().filter_map(|(role, name)| Some((role, name.build()?)));
    Names { own, containers: containers.collect() }
}

/// Whether a word is part of the name.
fn counts(word: &Word, reading: &Reading, at: usize) -> bool {
    let next = reading.mentions.get(at + 1);
    let is_before_role = |is_meant: fn(Role) -> bool| {
        let role = next.and_then(|next| match &next.what {
            What::Word { word, .. } => role::role_of(&word.text),
            What::Number(..) => None,
        });
        role.is_some_and(is_meant)
    };
    match word.class {
        _ if reading.is_caption => is_beside_number(word, &reading.mentions, at),
        // Grammar that was read is a letter.
        Class::Letter | Class::Function | Class::Specific => true,
        // "Brown door 901" tells the looks of a door, "red 901" the wing.
        Class::Look | Class::Descriptive => !word.is_location() && !is_before_role(|role| role == Role::Room),
        Class::Generic => match role::role_of(&word.text) {
            Some(Role::Room) => false,
            // Its number is the container's.
            Some(role) if role.is_container() => {
                let is_of_role =
                    |mention: &Mention| matches!(mention.what, What::Number(of, _) if of == role);
                !reading.mentions.iter().any(is_of_role)
            }
            None if direction::is_direction(&word.text) && direction::compass(&word.text).is_none() => {
                is_before_role(Role::is_container)
            }
            _ => true,
        },
        Class::Quantity => false,
    }
}

/// Whether a word of a caption leads to a number, with nothing but words for names between them ("ML D 28"), or is a letter
/// behind one.
fn is_beside_number(word: &Word, mentions: &[Mention], at: usize) -> bool {
    let is_for_names = |word: &Word| {
        matches!(word.class, Class::Letter | Class::Specific) || direction::compass(&word.text).is_some()
    };
    let is_straight = |pair: &&[Mention]| pair[0].end == pair[1].first;
    let is_number = |what: &What| matches!(what, What::Number(..));
    let goes_on = |what: &&What| matches!(what, What::Word { word, .. } if is_for_names(word));
    let mut following = mentions[at..].windows(2).take_while(is_straight).map(|pair| &pair[1].what);
    let mut preceding = mentions[at.saturating_sub(1)..=at].windows(2).filter(is_straight);
    (is_for_names(word) && following.find(|what| !goes_on(what)).is_some_and(is_number))
        || (word.class == Class::Letter && preceding.any(|pair| is_number(&pair[0].what)))
}

/// Returns one word for all languages where the lexicon has it.
fn canonical(word: &str) -> String {
    let bare = bare(word);
    let stem = dictionary::stem(&bare);
    let role = role::role_of(&stem).map(Role::as_str);
    let known = role.or_else(|| generic::concept(&stem)).or_else(|| direction::compass(&stem));
    known.map_or(bare, str::to_owned)
}
