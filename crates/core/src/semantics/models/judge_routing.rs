//! The router: which questions the built-in judge decides alone, and what binds a model's answer to the others.
//!
//! A model is asked only about texts that tell objects apart by words. Where a text has an identifier, the identifier
//! decides: no model is asked, and none could raise the pair.

use crate::semantics::judge::evidence::Source;
use crate::semantics::judge::similarity::{Judgement, similarity};
use crate::semantics::lexicon::words;
use crate::semantics::names::relation::{Relation, is_conflict, relate};
use crate::semantics::parsing::direction::Bearing;
use crate::semantics::text::Text;

/// Levels of InformationLevel that a model may have a better opinion of: some specific words, no identifier.
const OPEN_INFORMATION_LEVELS: std::ops::RangeInclusive<u8> = 3..=4;

/// Whose question it is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Route {
    /// The built-in judge is sure.
    Decided(Judgement),
    /// A model may know better; this stands in for it.
    Open(Judgement),
}

impl Route {
    /// Returns what the built-in judge says, sure or not.
    pub fn judgement(&self) -> &Judgement {
        match self {
            Route::Decided(judgement) | Route::Open(judgement) => judgement,
        }
    }
}

/// Routes SimilarityLevel.
pub fn route_similarity(a: &Text, b: &Text) -> Route {
    let judgement = similarity(a, b);
    if similarity_is_open(a, b) && judgement.source == Source::Lexical && judgement.level < 5 {
        Route::Open(judgement)
    } else {
        Route::Decided(judgement)
    }
}

/// Whether a model may be asked whether two texts describe the same object.
///
/// Not where a text says nothing or has an identifier of its own, not where they are on different floors, and not where
/// they point opposite ways.
pub fn similarity_is_open(a: &Text, b: &Text) -> bool {
    [a, b].iter().all(|text| text.is_told_by_words())
        && containers_agree(a, b)
        && a.directions.bearing(b.directions) != Bearing::Clash
}

/// Whether two texts name the same floors, wings and buildings, or neither names any.
fn containers_agree(a: &Text, b: &Text) -> bool {
    match relate(a, b) {
        Some(relation) => matches!(relation, Relation::Same(..) | Relation::SameButZeros(..)),
        None => !(a.has_name() || b.has_name()),
    }
}

/// Returns what a model's SimilarityLevel is worth: nothing where the question was not its own.
pub fn bound_similarity(a: &Text, b: &Text, level: u8) -> u8 {
    match route_similarity(a, b) {
        Route::Decided(judgement) => judgement.level,
        Route::Open(_) => level.clamp(1, 5),
    }
}

/// Whether a model may be asked how much a text tells.
pub fn information_is_open(text: &Text) -> bool {
    !text.has_name() && OPEN_INFORMATION_LEVELS.contains(&text.information_level())
}

/// Whether this may stand as MergeText of the two. It must have the numbers of both, no name that differs, and no digit of its own.
pub fn accepts_merge(a: &str, b: &str, merged: &str) -> bool {
    let text = Text::parse(merged);
    let has_name_of = |source: &str| {
        let source = Text::parse(source);
        !source.has_name() || (text.has_name() && !is_conflict(&source, &text))
    };
    !text.normalised().is_empty()
        && [a, b].into_iter().all(|source| has_name_of(source) && has_no_new_digits(source, &[merged]))
        && has_no_new_digits(merged, &[a, b])
}

/// Whether each group of digits of a text is in one of its sources.
pub fn has_no_new_digits(text: &str, sources: &[&str]) -> bool {
    let groups = |text: &str| -> Vec<String> {
        let clean = crate::semantics::parsing::normalise::clean(text);
        clean.split(|c: char| !c.is_numeric()).filter(|group| !group.is_empty()).map(str::to_owned).collect()
    };
    let known: Vec<String> = sources.iter().flat_map(|source| groups(source)).collect();
    groups(text).iter().all(|group| known.contains(group))
}

/// Weighted likeness of the words of two texts, in percent.
pub fn likeness_percent(a: &Text, b: &Text) -> u32 {
    words::overlap(&a.words, &b.words).percent()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn route(a: &str, b: &str) -> Route {
        route_similarity(&Text::parse(a), &Text::parse(b))
    }

    #[test]
    fn identifiers_are_decided_and_words_are_open() {
        for (a, b, level) in [
            ("901", "901", 5),
            ("room 901", "door 901", 5),
            ("room 901", "room 910", 1),
            ("9O1", "901", 3),
            ("901-905", "903", 1),
            ("", "a red boat", 1),
            ("arrow left pool", "arrow right pool", 2),
            ("a boat at sea", "painting 12", 1),
            ("Level 5", "Level 5", 3),
            ("museum shop, level 5", "gift store, level 4", 1),
        ] {
            let Route::Decided(judgement) = route(a, b) else { panic!("{a} | {b} is open") };
            assert_eq!(judgement.level, level, "{a} | {b}");
        }
        for (a, b) in [
            ("a portrait of a smiling lady", "the Mona Lisa"),
            ("a boat on a stormy sea", "a ship in a storm"),
            ("museum shop, level 5", "gift store, level 5"),
        ] {
            assert!(matches!(route(a, b), Route::Open(_)), "{a} | {b} is decided");
        }
    }

    #[test]
    fn no_model_raises_what_was_not_its_question() {
        for (a, b) in [("room 901", "room 910"), ("9O1", "901"), ("901-905", "903"), ("EXIT", "exit 3")] {
            assert!(bound_similarity(&Text::parse(a), &Text::parse(b), 5) < 4, "{a} | {b}");
        }
        assert_eq!(bound_similarity(&Text::parse("a red boat"), &Text::parse("a ship in a storm"), 5), 5);
    }

    #[test]
    fn a_merged_text_has_the_identifiers_of_both_and_no_digit_of_its_own() {
        for (a, b, merged, accepted) in [
            ("room 901", "brass door", "room 901, a brass door", true),
            ("room 901", "brass door", "a brass door", false),
            ("room 901", "brass door", "room 910, a brass door", false),
            ("a boat", "a red boat", "a red boat of 1888", false),
            ("a boat", "a red boat", "", false),
            ("a boat", "a red boat", "two boats, 3 of them red", false),
        ] {
            assert_eq!(accepts_merge(a, b, merged), accepted, "{merged}");
        }
    }
}
