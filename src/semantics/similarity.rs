//! SimilarityLevel, §IV-A.2: do two texts describe the same object?

use std::sync::Arc;

use super::agreement::{Agreement, Extra, agreement};
use super::direction::Bearing;
use super::identifier::{Identifier, Relation};
use super::reason;
use super::role::{self, Role};
use super::text::Text;
use super::words::{self, Word};

/// What decided a similarity level.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Source {
    /// The texts are the same but for case, width, spaces and the like.
    Identical,
    /// Identifiers agree or conflict.
    Identifiers,
    /// Words, directions, negations.
    Lexical,
    /// A model, `model:<name>`; only where the built-in judge leaves the question open.
    Model(Arc<str>),
}

impl Source {
    /// The name in the contract.
    pub fn as_str(&self) -> &str {
        match self {
            Source::Identical => "identical",
            Source::Identifiers => "identifiers",
            Source::Lexical => "lexical",
            Source::Model(name) => name,
        }
    }
}

/// A similarity level with what decided it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Judgement {
    /// 1 to 5; from 4 on it is the same object.
    pub level: u8,
    /// What decided.
    pub source: Source,
    /// One sentence that names the evidence.
    pub reason: String,
}

/// SimilarityLevel of two texts, and why. Symmetric, also in the reason.
pub fn similarity(a: &Text, b: &Text) -> Judgement {
    let (a, b) = in_order(a, b);
    let (level, evidence) = judge(a, b);
    Judgement { level, source: evidence.source(), reason: reason::sentence(a, b, &evidence) }
}

/// The same answer without the reason. Allocates nothing: for the hot path.
pub fn similarity_level(a: &Text, b: &Text) -> (u8, Source) {
    let (a, b) = in_order(a, b);
    let (level, evidence) = judge(a, b);
    (level, evidence.source())
}

/// What a level rests on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Evidence<'t> {
    /// This text says nothing.
    Uninformative(&'t Text),
    /// Equal normalised forms.
    Identical,
    /// What the identifiers say.
    Identifiers(Agreement<'t>),
    /// Only one text has an identifier.
    OneIdentifier(&'t Identifier),
    /// One text denies a word that the other states.
    Denied(&'t Word),
    /// They deny different things.
    DifferentNegations,
    /// They point different ways.
    Directions,
    /// They name different colours.
    Colours,
    /// They state different quantities.
    Quantities,
    /// The likeness of the words.
    Words,
}

impl Evidence<'_> {
    fn source(&self) -> Source {
        match self {
            Evidence::Identical => Source::Identical,
            Evidence::Identifiers(_) => Source::Identifiers,
            _ => Source::Lexical,
        }
    }
}

fn in_order<'t>(a: &'t Text, b: &'t Text) -> (&'t Text, &'t Text) {
    if a.normalised() <= b.normalised() { (a, b) } else { (b, a) }
}

/// The rules, the strongest first.
fn judge<'t>(a: &'t Text, b: &'t Text) -> (u8, Evidence<'t>) {
    if let Some(text) = [a, b].into_iter().find(|text| text.information_level() == 1) {
        return (1, Evidence::Uninformative(text));
    }
    if a == b {
        return (5, Evidence::Identical);
    }
    let agreement = agreement(&a.identifiers, &b.identifiers);
    if let Some(conflict @ Agreement::Conflict(..)) = agreement {
        return (1, Evidence::Identifiers(conflict));
    }
    if let Some(word) = denied(a, b).or_else(|| denied(b, a)) {
        return (2, Evidence::Denied(word));
    }
    let bearing = a.directions.bearing(b.directions);
    if bearing == Bearing::Clash {
        return (2, Evidence::Directions);
    }
    let (level, evidence) = match (agreement, a.identifiers.first().or(b.identifiers.first())) {
        (Some(agreement), _) => (level_of(&agreement), Evidence::Identifiers(agreement)),
        (None, Some(only)) => return (level_with_one_identifier(a, b, only), Evidence::OneIdentifier(only)),
        (None, None) => level_of_words(a, b),
    };
    // An arrow sign to room 901 is not the door of room 901.
    if bearing == Bearing::OneSided && level > 3 { (3, Evidence::Directions) } else { (level, evidence) }
}

/// A word that `a` denies and `b` states.
fn denied<'t>(a: &'t Text, b: &Text) -> Option<&'t Word> {
    a.negated
        .iter()
        .find(|word| b.words.binary_search(word).is_ok() && b.negated.binary_search(word).is_err())
}

fn level_of(agreement: &Agreement<'_>) -> u8 {
    match agreement {
        Agreement::Conflict(..) => 1,
        Agreement::RolesDiffer(..) | Agreement::Alike(_, _, Relation::PoorlyRead) => 2,
        Agreement::Alike(..) => 3,
        Agreement::Agree { extra, .. } => match extra {
            Extra::None => 5,
            Extra::Spelling | Extra::OtherRole(_) => 4,
            Extra::SameRole(_) => 3,
        },
    }
}

/// At most 3, for nothing shows that it is *this* number: the blocking keys rely on it.
fn level_with_one_identifier(a: &Text, b: &Text, only: &Identifier) -> u8 {
    let same_kind = |word: &Word| {
        role::role_of(&word.text).is_some_and(|(role, _)| role == only.role || only.role == Role::Neutral)
    };
    let without = if a.identifiers.is_empty() { a } else { b };
    match words::overlap(&a.words, &b.words).level() {
        4.. => 3,
        2..=3 => 2,
        _ if without.words.iter().any(same_kind) => 2,
        _ => 1,
    }
}

fn level_of_words<'t>(a: &Text, b: &Text) -> (u8, Evidence<'t>) {
    let overlap = words::overlap(&a.words, &b.words);
    let (at_most, evidence) = match () {
        () if a.negated != b.negated => (2, Evidence::DifferentNegations),
        () if overlap.colours_clash() => (2, Evidence::Colours),
        () if overlap.quantities_differ() => (3, Evidence::Quantities),
        () => (5, Evidence::Words),
    };
    let level = overlap.level();
    if level > at_most { (at_most, evidence) } else { (level, Evidence::Words) }
}
