//! Evidence for a similarity level.

use std::sync::Arc;

use crate::semantics::lexicon::words::Word;
use crate::semantics::names::name::Name;
use crate::semantics::names::relation::Relation;
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
#[derive(Clone, Copy, Debug)]
pub enum Evidence<'t> {
    /// This text says nothing.
    Uninformative(&'t Text),
    /// Equal normalised forms.
    Identical,
    /// The relation of the names.
    Names(Relation<'t>),
    /// This name lacks parts that most names of the building have.
    Partial(&'t Name),
    /// Only one text has a name with a number.
    OneName(&'t Name),
    /// They share a floor, wing or building, and nothing that says which object of it.
    Container(&'t Name),
    /// One text denies a word that the other states.
    Denied(&'t Word),
    /// They deny different things.
    DifferentNegations,
    /// They point different ways.
    Directions,
    /// They state different colours, materials, numbers or quantities.
    Details,
    /// The likeness of the words.
    Words,
}

impl Evidence<'_> {
    /// Returns what decided.
    pub fn source(&self) -> Source {
        match self {
            Evidence::Identical => Source::Identical,
            Evidence::Names(_) | Evidence::Partial(_) | Evidence::Container(_) => Source::Identifiers,
            _ => Source::Lexical,
        }
    }
}
