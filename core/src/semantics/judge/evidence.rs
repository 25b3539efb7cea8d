//! Evidence for a similarity level.

use std::sync::Arc;

use crate::semantics::identifiers::agreement::Agreement;
use crate::semantics::identifiers::identifier::Identifier;
use crate::semantics::lexicon::words::Word;
use crate::semantics::text::Text;

/// Decider of a similarity level.
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
    /// Returns the name in the API document.
    pub fn as_str(&self) -> &str {
        match self {
            Source::Identical => "identical",
            Source::Identifiers => "identifiers",
            Source::Lexical => "lexical",
            Source::Model(name) => name,
        }
    }
}

/// Evidence for a level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Evidence<'t> {
    /// This text says nothing.
    Uninformative(&'t Text),
    /// Equal normalised forms.
    Identical,
    /// Agreement or conflict of the identifiers.
    Identifiers(Agreement<'t>),
    /// Only one text has an identifier of its own.
    OneIdentifier(&'t Identifier),
    /// They share a floor, wing or building, and nothing that says which object of it.
    Container(&'t Identifier),
    /// One text denies a word that the other states.
    Denied(&'t Word),
    /// They deny different things.
    DifferentNegations,
    /// They point different ways.
    Directions,
    /// They name different colours.
    Colours,
    /// They state different looks of this thing: a glass vase, a blue vase.
    Looks(&'t str),
    /// They state different quantities.
    Quantities,
    /// The likeness of the words.
    Words,
}

impl Evidence<'_> {
    /// Returns what decided.
    pub fn source(&self) -> Source {
        match self {
            Evidence::Identical => Source::Identical,
            Evidence::Identifiers(_) | Evidence::Container(_) => Source::Identifiers,
            _ => Source::Lexical,
        }
    }
}
