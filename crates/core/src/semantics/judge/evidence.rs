//! Evidence for a similarity level, and the sentence that tells a person of it.

use std::sync::Arc;

use crate::semantics::lexicon::words::{self, Word};
use crate::semantics::names::name::Name;
use crate::semantics::names::relation::{Conflict, Relation};
use crate::semantics::text::Text;

/// Words named before the rest is only counted.
const MAX_NAMED_WORDS: usize = 4;
const MAX_QUOTED_CHARS: usize = 40;

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

    /// One sentence for the evidence about two texts in canonical order.
    pub fn sentence(&self, a: &Text, b: &Text) -> String {
        match self {
            Evidence::Uninformative(text) if text.normalised().is_empty() => "one text is empty".to_owned(),
            Evidence::Uninformative(text) => format!("\"{}\" says nothing about the object", quoted(text)),
            Evidence::Identical => format!("both say \"{}\"", quoted(a)),
            Evidence::Names(relation) => of_names(relation),
            Evidence::Partial(name) => {
                format!("{} is only part of how this building writes its names", name.as_str())
            }
            Evidence::OneName(only) => format!("only one of them has an identifier, {}", only.as_str()),
            Evidence::Container(container) => {
                format!("both are of {}, and nothing says which object of it", container.as_str())
            }
            Evidence::Denied(word) => format!("one denies \"{}\", the other states it", word.text),
            Evidence::DifferentNegations => "they deny different things".to_owned(),
            Evidence::Directions => of_directions(&a.directions.phrase(), &b.directions.phrase()),
            Evidence::Details => "they state different colours, materials or numbers".to_owned(),
            Evidence::Words => of_words(&a.words, &b.words),
        }
    }
}

fn of_names(relation: &Relation<'_>) -> String {
    match relation {
        Relation::Different(Conflict { a, b, part_a, part_b }) => {
            let names = format!("{} is not {}", a.as_str(), b.as_str());
            // The part that decided, unless it is all there is.
            let is_all = a.parts().len() == 1 && b.parts().len() == 1;
            if is_all { names } else { format!("{names}: {} here, {} there", part_a.text, part_b.text) }
        }
        Relation::Unsure(a, b) => of_misreading(a, b),
        Relation::Open(Some(a), Some(b)) => {
            format!("{} and {} may be one name, of which one lacks a part", a.as_str(), b.as_str())
        }
        Relation::Open(only, other) => {
            let only = only.or(*other).map_or("", |name| name.as_str());
            format!("only one of them says {only}")
        }
        Relation::SameButZeros(a, b) | Relation::Same(a, b) if a.as_str() != b.as_str() => {
            format!("{} and {} are the same name", a.as_str(), b.as_str())
        }
        Relation::SameButZeros(a, _) | Relation::Same(a, _) => format!("both say {}", a.as_str()),
    }
}

/// Names the characters that a reader takes for each other, which look alike on a screen, too.
fn of_misreading(a: &Name, b: &Name) -> String {
    let kind = |c: char| if c.is_ascii_digit() { "digit" } else { "letter" };
    let differing = a.characters().zip(b.characters()).find(|(x, y)| x != y);
    let detail = differing.map_or_else(String::new, |(x, y)| {
        format!(": {} {}, {} {}", kind(x), x.to_uppercase(), kind(y), y.to_uppercase())
    });
    format!("{} may be a misreading of {}{detail}", a.as_str(), b.as_str())
}

fn of_directions(a: &str, b: &str) -> String {
    match (a, b) {
        ("", way) | (way, "") => format!("only one of them points {way}"),
        (a, b) => format!("one points {a}, the other {b}"),
    }
}

fn of_words(a: &[Word], b: &[Word]) -> String {
    let (mut common, mut different) = (Vec::new(), Vec::new());
    words::walk(a, b, |word, side| {
        if side == 0 { &mut common } else { &mut different }.push(word.text.as_str());
    });
    match (common.is_empty(), different.is_empty()) {
        (true, _) => "they have no word in common".to_owned(),
        (false, true) => format!("both say {}", named(&common)),
        (false, false) => format!("both say {}, they differ in {}", named(&common), named(&different)),
    }
}

fn named(words: &[&str]) -> String {
    match words.len().checked_sub(MAX_NAMED_WORDS) {
        None | Some(0) => words.join(", "),
        Some(more) => format!("{} and {more} more", words[..MAX_NAMED_WORDS].join(", ")),
    }
}

fn quoted(text: &Text) -> String {
    let text = text.normalised();
    match text.char_indices().nth(MAX_QUOTED_CHARS) {
        None => text.to_owned(),
        Some((end, _)) => format!("{}...", &text[..end]),
    }
}
