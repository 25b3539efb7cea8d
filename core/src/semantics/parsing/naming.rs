//! Naming: assembles the names of a text from what its tokens say.
//!
//! Everything counts, unless it is known not to: the words "room" and "number", grammar, measures, arrows, and the looks of a
//! door. Of a sentence about a sign only what stands beside the number is known to be on it.

use crate::semantics::lexicon::dictionary::{self, Class};
use crate::semantics::lexicon::generic;
use crate::semantics::lexicon::role::{self, Role};
use crate::semantics::lexicon::words::Word;
use crate::semantics::names::identifier::Identifier;
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
    let mentions = &reading.mentions;
    let mut own = NameBuilder::default();
    let mut numbers: Vec<&Identifier> = Vec::new();
    let mut containers: Vec<(Role, NameBuilder)> = Vec::new();
    for (at, mention) in mentions.iter().enumerate() {
        match &mention.what {
            What::Identifier(identifier) if identifier.role.is_container() => {
                let of_role = containers.iter().position(|(role, _)| *role == identifier.role);
                let of_role = of_role.unwrap_or_else(|| {
                    containers.push((identifier.role.clone(), NameBuilder::default()));
                    containers.len() - 1
                });
                containers[of_role].1.code(identifier.as_str(), &identifier.phrase(), canonical);
            }
            What::Identifier(identifier) => {
                let is_said = |said: &&Identifier| {
                    said.as_str() == identifier.as_str() && said.role.is_compatible(&identifier.role)
                };
                // "901, room 901" says one number twice, "1 C 1" has two.
                if identifier.role == Role::Room && numbers.iter().any(is_said) {
                    continue;
                }
                numbers.push(identifier);
                match &identifier.role {
                    Role::Place(word) if !own.ends_with(word) => own.word(word, &word.to_uppercase()),
                    // Elsewhere its own mention is part of the name.
                    Role::Named(_) if reading.is_caption => {
                        let word = tokens[mention.first].text;
                        own.word(&canonical(word), &word.to_uppercase());
                    }
                    _ => {}
                }
                own.code(identifier.as_str(), identifier.as_str(), canonical);
            }
            What::Word { word, negated: false } if counts(word, mentions, at, reading.is_caption) => {
                let written: Vec<&str> =
                    tokens[mention.first..mention.end].iter().map(|token| token.text).collect();
                let said = if word.class == Class::Specific { written.concat() } else { word.text.clone() };
                own.word(&canonical(&said), &written.join(" ").to_uppercase());
            }
            What::Article(letter) if !reading.is_caption || is_beside_number(mentions, at) => {
                own.word(letter, &letter.to_uppercase());
            }
            _ => {}
        }
    }
    let own = if numbers.is_empty() { None } else { own.build() };
    containers.sort_by(|a, b| a.0.cmp(&b.0));
    let containers = containers.into_iter().filter_map(|(role, name)| Some((role, name.build()?)));
    Names { own, containers: containers.collect() }
}

/// Whether a word is part of the name.
fn counts(word: &Word, mentions: &[Mention], at: usize, is_caption: bool) -> bool {
    let role = role::role_of(&word.text).map(|(role, _)| role);
    match word.class {
        Class::Letter => !is_caption || is_beside_number(mentions, at),
        _ if is_caption => false,
        Class::Specific => true,
        // "Brown door 901" tells the looks of a door, "red 901" the wing.
        Class::Colour | Class::Descriptive => {
            !word.is_location() && !is_followed_by(mentions, at, |role| *role == Role::Room)
        }
        Class::Generic => match role {
            Some(Role::Room) => false,
            // Its number is the container's.
            Some(role) if role.is_container() => !has_container(mentions, &role),
            None if direction::is_direction(&word.text) && direction::compass(&word.text).is_none() => {
                is_followed_by(mentions, at, Role::is_container)
            }
            _ => true,
        },
        Class::Quantity | Class::Function => false,
    }
}

/// Whether the next mention is a word of such a role.
fn is_followed_by(mentions: &[Mention], at: usize, is_meant: impl Fn(&Role) -> bool) -> bool {
    mentions.get(at + 1).is_some_and(|next| match &next.what {
        What::Word { word, .. } => role::role_of(&word.text).is_some_and(|(role, _)| is_meant(&role)),
        _ => false,
    })
}

fn has_container(mentions: &[Mention], role: &Role) -> bool {
    mentions.iter().any(|mention| matches!(&mention.what, What::Identifier(found) if found.role == *role))
}

fn is_beside_number(mentions: &[Mention], at: usize) -> bool {
    let is_number =
        |other: usize| mentions.get(other).is_some_and(|mention| matches!(mention.what, What::Identifier(_)));
    is_number(at + 1) || at.checked_sub(1).is_some_and(is_number)
}

/// Returns one word for all languages where the lexicon has it.
fn canonical(word: &str) -> String {
    let bare = bare(word);
    let stem = dictionary::stem(&bare);
    let role = role::role_of(&stem).map(|(role, _)| role.as_str().to_owned());
    let known = || generic::concept(&stem).or_else(|| direction::compass(&stem)).map(str::to_owned);
    role.or_else(known).unwrap_or(bare)
}
