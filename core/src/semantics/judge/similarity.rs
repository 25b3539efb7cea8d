//! SimilarityLevel, §IV-A.2: do two texts describe the same object?

use crate::semantics::identifiers::agreement::{Agreement, Extra, agreement};
use crate::semantics::identifiers::identifier::{Identifier, Relation};
use crate::semantics::judge::evidence::{Evidence, Source};
use crate::semantics::judge::reason;
use crate::semantics::lexicon::role::{self, Role};
use crate::semantics::lexicon::words::{self, Word};
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
    Judgement { level, source: evidence.source(), reason: reason::sentence(a, b, &evidence) }
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
    if let Some(container) = container_alone(a).or_else(|| container_alone(b)) {
        return judge_container(a, b, container);
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
    let (level, evidence) = match (agreement, a.own.first(), b.own.first()) {
        (Some(agreement), Some(_), Some(_)) => judge_identifiers(a, b, agreement),
        (_, Some(only), None) | (_, None, Some(only)) => {
            return (level_with_one_identifier(a, b, only), Evidence::OneIdentifier(only));
        }
        (agreement, ..) => judge_words(a, b, agreement),
    };
    // An arrow sign to room 901 is not the door of room 901.
    if bearing == Bearing::OneSided && level > 3 { (3, Evidence::Directions) } else { (level, evidence) }
}

/// Returns the floor or building that a text numbers, if it says nothing else.
fn container_alone(text: &Text) -> Option<&Identifier> {
    text.identifiers.first().filter(|_| text.information.is_container_alone)
}

/// "Level 5" never says which object of level 5: level 3 with its equal, 1 with another (M23).
fn judge_container<'t>(a: &'t Text, b: &'t Text, container: &'t Identifier) -> (u8, Evidence<'t>) {
    let agreement = agreement(&a.identifiers, &b.identifiers);
    let both_alone = container_alone(a).is_some() && container_alone(b).is_some();
    match agreement {
        Some(conflict @ Agreement::Conflict(..)) => (1, Evidence::Identifiers(conflict)),
        Some(Agreement::Agree { .. }) if both_alone => (3, Evidence::Container(container)),
        Some(differ @ Agreement::RolesDiffer(..)) => (2, Evidence::Identifiers(differ)),
        Some(_) => (2, Evidence::Container(container)),
        None => (level_with_one_identifier(a, b, container).min(2), Evidence::OneIdentifier(container)),
    }
}

/// Returns the objects' own identifiers decide; those of the parts of a building around them lift nothing.
fn judge_identifiers<'t>(a: &'t Text, b: &'t Text, all: Agreement<'t>) -> (u8, Evidence<'t>) {
    match agreement(&a.own, &b.own) {
        // "9" may be the floor of "901, 9F".
        Some(Agreement::Conflict(..)) => (level_of(&all).min(2), Evidence::Identifiers(all)),
        Some(Agreement::Agree { .. }) | None => (level_of(&all), Evidence::Identifiers(all)),
        Some(own) => (level_of(&own), Evidence::Identifiers(own)),
    }
}

/// Judges the words: they must agree without the containers; a container that only one text names leaves it open at most.
fn judge_words<'t>(a: &'t Text, b: &'t Text, containers: Option<Agreement<'t>>) -> (u8, Evidence<'t>) {
    let (level, evidence) = level_of_words(a, b);
    let has_containers = !a.identifiers.is_empty() || !b.identifiers.is_empty();
    let at_most = match &containers {
        Some(agreement) => level_of(agreement),
        None if has_containers => 3,
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

fn level_of_words<'t>(a: &'t Text, b: &'t Text) -> (u8, Evidence<'t>) {
    let overlap = words::overlap(&a.words, &b.words);
    let (at_most, evidence) = match () {
        () if a.negated != b.negated => (2, Evidence::DifferentNegations),
        () if overlap.colours_clash() => (2, Evidence::Colours),
        () if overlap.quantities_differ() => (3, Evidence::Quantities),
        () => a.looks.clash(&b.looks).map_or((5, Evidence::Words), |thing| (3, Evidence::Looks(thing))),
    };
    let level = overlap.level();
    if level > at_most { (at_most, evidence) } else { (level, Evidence::Words) }
}
