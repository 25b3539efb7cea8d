//! SimilarityLevel, §IV-A.2: do two texts describe the same object?

use crate::semantics::judge::evidence::{Evidence, Source};
use crate::semantics::lexicon::role;
use crate::semantics::lexicon::words::{self, Word};
use crate::semantics::names::name::Name;
use crate::semantics::names::relation::{Relation, relate};
use crate::semantics::parsing::direction::Bearing;
use crate::semantics::text::Text;

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
    Judgement { level, source: evidence.source(), reason: evidence.sentence(a, b) }
}

/// Returns the same answer without the reason. Allocates nothing: for the hot path.
pub fn similarity_level(a: &Text, b: &Text) -> (u8, Source) {
    let (a, b) = in_order(a, b);
    let (level, evidence) = judge(a, b);
    (level, evidence.source())
}

fn in_order<'t>(a: &'t Text, b: &'t Text) -> (&'t Text, &'t Text) {
    if a.normalised() <= b.normalised() { (a, b) } else { (b, a) }
}

/// Returns the rules, the strongest first.
fn judge<'t>(a: &'t Text, b: &'t Text) -> (u8, Evidence<'t>) {
    if let Some(text) = [a, b].into_iter().find(|text| text.information_level() == 1) {
        return (1, Evidence::Uninformative(text));
    }
    let relation = relate(a, b);
    if let Some(difference @ Relation::Different(_)) = relation {
        return (1, Evidence::Names(difference));
    }
    if a.information.is_container_alone || b.information.is_container_alone {
        return judge_container(a, b, relation);
    }
    if let Some(partial) =
        [a, b].into_iter().filter(|text| text.is_partial()).find_map(|text| text.own.as_ref())
    {
        return (3, Evidence::Partial(partial));
    }
    if a == b {
        return (5, Evidence::Identical);
    }
    if let Some(word) = denied(a, b).or_else(|| denied(b, a)) {
        return (2, Evidence::Denied(word));
    }
    let bearing = a.directions.bearing(b.directions);
    if bearing == Bearing::Clash {
        return (2, Evidence::Directions);
    }
    let (level, evidence) = match (relation, &a.own, &b.own) {
        (Some(relation), Some(_), Some(_)) => (relation.level(), Evidence::Names(relation)),
        (_, Some(only), None) | (_, None, Some(only)) => {
            return (level_with_one_name(a, b, only), Evidence::OneName(only));
        }
        _ => judge_words(a, b, relation),
    };
    // An arrow sign to room 901 is not the door of room 901.
    if bearing == Bearing::OneSided && level > 3 { (3, Evidence::Directions) } else { (level, evidence) }
}

/// "Level 5" never says which object of level 5: level 3 with its equal, 1 with another (M23).
fn judge_container<'t>(a: &'t Text, b: &'t Text, relation: Option<Relation<'t>>) -> (u8, Evidence<'t>) {
    let alone = |text: &'t Text| text.containers.first().filter(|_| text.information.is_container_alone);
    let both = alone(a).is_some() && alone(b).is_some();
    let Some((_, container)) = alone(a).or_else(|| alone(b)) else { return (1, Evidence::Words) };
    match relation {
        Some(Relation::Same(..) | Relation::SameButZeros(..)) => {
            (2 + u8::from(both), Evidence::Container(container))
        }
        Some(relation) => (2, Evidence::Names(relation)),
        None => (level_with_one_name(a, b, container).min(2), Evidence::OneName(container)),
    }
}

/// Judges the words: they must agree without the containers; a container that only one text names leaves it open at most.
fn judge_words<'t>(a: &'t Text, b: &'t Text, containers: Option<Relation<'t>>) -> (u8, Evidence<'t>) {
    let (level, evidence) = level_of_words(a, b);
    let at_most = match &containers {
        Some(relation) => relation.level(),
        None if a.has_name() || b.has_name() => 3,
        None => 5,
    };
    (level.min(at_most), evidence)
}

/// Returns a word that `a` denies and `b` states.
fn denied<'t>(a: &'t Text, b: &Text) -> Option<&'t Word> {
    a.negated
        .iter()
        .find(|word| b.words.binary_search(word).is_ok() && b.negated.binary_search(word).is_err())
}

/// At most 3, for nothing shows that it is *this* number: the blocking keys rely on it.
fn level_with_one_name(a: &Text, b: &Text, only: &Name) -> u8 {
    let names_kind = |text: &Text| text.words.iter().any(|word| role::role_of(&word.text).is_some());
    let without = if a.own.as_ref().is_some_and(|own| std::ptr::eq(own, only)) { b } else { a };
    match words::overlap(&a.words, &b.words).level() {
        4.. => 3,
        2..=3 => 2,
        _ if names_kind(without) => 2,
        _ => 1,
    }
}

fn level_of_words<'t>(a: &'t Text, b: &'t Text) -> (u8, Evidence<'t>) {
    let overlap = words::overlap(&a.words, &b.words);
    let (at_most, evidence) = match () {
        () if a.negated != b.negated => (2, Evidence::DifferentNegations),
        () if overlap.looks_clash() => (2, Evidence::Details),
        () if overlap.details_differ() => (3, Evidence::Details),
        () => (5, Evidence::Words),
    };
    let level = overlap.level();
    if level > at_most { (at_most, evidence) } else { (level, Evidence::Words) }
}
