//! The sentence that tells a person what a similarity level rests on.

use crate::semantics::identifiers::agreement::{Agreement, Extra};
use crate::semantics::identifiers::identifier::{Identifier, Relation};
use crate::semantics::judge::evidence::Evidence;
use crate::semantics::lexicon::role::Role;
use crate::semantics::lexicon::words::{self, Word};
use crate::semantics::text::Text;

/// Words named before the rest is only counted.
const MAX_NAMED_WORDS: usize = 4;
const MAX_QUOTED_CHARS: usize = 40;

/// One sentence for the evidence about two texts in canonical order.
pub fn sentence(a: &Text, b: &Text, evidence: &Evidence<'_>) -> String {
    match evidence {
        Evidence::Uninformative(text) if text.normalised().is_empty() => "one text is empty".to_owned(),
        Evidence::Uninformative(text) => format!("\"{}\" says nothing about the object", quoted(text)),
        Evidence::Identical => format!("both say \"{}\"", quoted(a)),
        Evidence::Identifiers(agreement) => of_identifiers(agreement),
        Evidence::OneIdentifier(only) => format!("only one of them has an identifier, {}", only.phrase()),
        Evidence::Container(number) if number.role == Role::Bare => {
            format!("{} is not how this building writes its numbers", number.as_str())
        }
        Evidence::Container(container) => {
            format!("both are of {}, and nothing says which object of it", container.phrase())
        }
        Evidence::Denied(word) => format!("one denies \"{}\", the other states it", word.text),
        Evidence::DifferentNegations => "they deny different things".to_owned(),
        Evidence::Directions => of_directions(&a.directions.phrase(), &b.directions.phrase()),
        Evidence::Colours => "they name different colours".to_owned(),
        Evidence::Looks(thing) => format!("they state different looks of \"{thing}\""),
        Evidence::Quantities => "they state different quantities".to_owned(),
        Evidence::Words => of_words(&a.words, &b.words),
    }
}

fn of_identifiers(agreement: &Agreement<'_>) -> String {
    match agreement {
        Agreement::Conflict(x, y) => format!("{} is not {}", x.as_str(), y.as_str()),
        Agreement::RolesDiffer(x, y) => format!("{} is not {}", x.phrase(), y.phrase()),
        Agreement::Alike(x, y, Relation::Overlap) => format!("{} and {} overlap", x.as_str(), y.as_str()),
        Agreement::Alike(x, y, _) => format!("{} may be a misreading of {}", x.as_str(), y.as_str()),
        Agreement::Agree { a, b, extra } => match extra {
            Extra::SameRole(more) => format!("both say {}, but only one says {}", a.as_str(), more.phrase()),
            Extra::OtherRole(more) => format!("both say {}, and one adds {}", a.as_str(), more.phrase()),
            Extra::None | Extra::Spelling => of_equal(a, b),
        },
    }
}

fn of_equal(a: &Identifier, b: &Identifier) -> String {
    if a.as_str() != b.as_str() {
        format!("{} and {} are the same number", a.as_str(), b.as_str())
    } else if a.role == b.role {
        format!("both say {}", a.phrase())
    } else {
        format!("both say {}", a.as_str())
    }
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
