//! Relations of two names: the same, different, unsure or open.

use crate::semantics::lexicon::role::Role;
use crate::semantics::names::name::{Name, Part, PartKind, look_alike_digit};
use crate::semantics::text::Text;

/// Relation of two names. Of several names, the one of the lowest level decides.
#[derive(Clone, Copy, Debug)]
pub enum Relation<'n> {
    /// A part that both have differs: they exclude each other (level 1).
    Different(Conflict<'n>),
    /// Characters, or the marks between groups of digits, may be misread (level 3).
    Unsure(&'n Name, &'n Name),
    /// One lacks what the other has, or nobody can tell which parts are to be compared (level 3).
    Open(Option<&'n Name>, Option<&'n Name>),
    /// Equal but for leading zeros (level 4).
    SameButZeros(&'n Name, &'n Name),
    /// Every part is equal (level 5).
    Same(&'n Name, &'n Name),
}

/// Two names that cannot be of one object, 901 and 910, with the parts that exclude each other.
#[derive(Clone, Copy, Debug)]
pub struct Conflict<'n> {
    /// Of the first text.
    pub a: &'n Name,
    /// Of the second text.
    pub b: &'n Name,
    pub(in crate::semantics) part_a: &'n Part,
    pub(in crate::semantics) part_b: &'n Part,
}

impl Relation<'_> {
    /// Returns the SimilarityLevel that the names alone give.
    pub fn level(&self) -> u8 {
        match self {
            Self::Different(_) => 1,
            Self::Unsure(..) | Self::Open(..) => 3,
            Self::SameButZeros(..) => 4,
            Self::Same(..) => 5,
        }
    }
}

/// Compares all names of two texts: of the objects, and of the parts of a building around them. None if one text has no name.
pub fn relate<'n>(a: &'n Text, b: &'n Text) -> Option<Relation<'n>> {
    if !(a.has_name() && b.has_name()) {
        return None;
    }
    let own = match (&a.own, &b.own) {
        (None, None) => None,
        (Some(a), Some(b)) => Some(compare(a, b)),
        (a, b) => Some(Relation::Open(a.as_ref(), b.as_ref())),
    };
    let of = |text: &'n Text, role: &Role| {
        text.containers.iter().find(|(other, _)| other == role).map(|(_, name)| name)
    };
    let containers = a.containers.iter().map(|(role, name)| match of(b, role) {
        Some(other) => compare(name, other),
        None => Relation::Open(Some(name), None),
    });
    let only_b = b.containers.iter().filter(|(role, _)| of(a, role).is_none());
    let only_b = only_b.map(|(_, name)| Relation::Open(None, Some(name)));
    own.into_iter().chain(containers).chain(only_b).min_by_key(Relation::level)
}

/// Compares two names of objects, or of parts of a building of one kind. Symmetric.
pub fn compare<'n>(a: &'n Name, b: &'n Name) -> Relation<'n> {
    if a.key() == b.key() {
        return if a.spelt() == b.spelt() { Relation::Same(a, b) } else { Relation::SameButZeros(a, b) };
    }
    if let ([part_a], [part_b]) = (a.parts(), b.parts())
        && part_a.kind == PartKind::Code
        && part_b.kind == PartKind::Code
    {
        return Relation::Different(Conflict { a, b, part_a, part_b });
    }
    if a.parts() == b.parts() {
        return Relation::Unsure(a, b);
    }
    if a.is_part_of(b) || b.is_part_of(a) {
        return Relation::Open(Some(a), Some(b));
    }
    let misread = if a.look_alike() == b.look_alike() { misread_characters(a, b) } else { None };
    if misread.is_some_and(|count| count > 0 || borders_are_among(a, b) || borders_are_among(b, a)) {
        return Relation::Unsure(a, b);
    }
    match differing(a.parts(), b.parts()) {
        Some((part_a, part_b)) => Relation::Different(Conflict { a, b, part_a, part_b }),
        None => Relation::Open(Some(a), Some(b)),
    }
}

/// Returns how many letters stand for a look-alike digit; none if anything else differs.
fn misread_characters(a: &Name, b: &Name) -> Option<usize> {
    let (mut of_a, mut of_b) = (a.characters(), b.characters());
    let mut misread = 0;
    loop {
        match (of_a.next(), of_b.next()) {
            (None, None) => return Some(misread),
            (Some(x), Some(y)) if x == y => {}
            (Some(x), Some(y)) => {
                let is_misread =
                    x.is_alphabetic() != y.is_alphabetic() && look_alike_digit(x) == look_alike_digit(y);
                misread += is_misread.then_some(1)?;
            }
            _ => return None,
        }
    }
}

/// Whether every border between groups of digits is one of the other's, too.
fn borders_are_among(a: &Name, b: &Name) -> bool {
    let mut of_b = b.borders();
    a.borders().all(|border| of_b.any(|other| other == border))
}

/// Returns the first two parts that stand in one slot and differ: a slot is a kind of part and a place relative to the groups
/// of digits.
fn differing<'n>(a: &'n [Part], b: &'n [Part]) -> Option<(&'n Part, &'n Part)> {
    let is_digits = |part: &&Part| part.kind == PartKind::Digits;
    let digits = |parts: &'n [Part]| parts.iter().filter(is_digits);
    let (count_a, count_b) = (digits(a).count(), digits(b).count());
    if count_a != count_b {
        // Where the groups of one are not among the other's, some group differs however they are laid side by side.
        let apart = |few: &'n [Part], many: &'n [Part]| -> Option<(&'n Part, &'n Part)> {
            let mut rest = digits(many);
            let odd = digits(few).find(|part| !rest.any(|other| other == *part))?;
            let other = digits(many).find(|other| !digits(few).any(|part| part == *other))?;
            Some((odd, other))
        };
        return if count_a < count_b { apart(a, b) } else { apart(b, a).map(|(y, x)| (x, y)) };
    }
    if let Some(pair) = digits(a).zip(digits(b)).find(|(x, y)| x != y) {
        return Some(pair);
    }
    let (mut of_a, mut of_b) = (a.split(|part| is_digits(&part)), b.split(|part| is_digits(&part)));
    (0..=count_a).find_map(|gap| {
        let (a, b) = (of_a.next()?, of_b.next()?);
        [PartKind::Letter, PartKind::Word].into_iter().find_map(|kind| {
            let of_kind = |parts: &'n [Part]| parts.iter().filter(move |part| part.kind == kind);
            let differs = |(x, y): &(&Part, &Part)| x != y;
            // Counted from the number outwards; behind the last one that is forwards.
            if gap < count_a || count_a == 0 {
                of_kind(a).rev().zip(of_kind(b).rev()).find(differs)
            } else {
                of_kind(a).zip(of_kind(b)).find(differs)
            }
        })
    })
}

/// Returns the names of two texts that exclude each other, if any.
pub fn conflict<'a>(a: &'a Text, b: &'a Text) -> Option<Conflict<'a>> {
    match relate(a, b)? {
        Relation::Different(conflict) => Some(conflict),
        _ => None,
    }
}

/// Whether the names of two texts exclude each other, as [`conflict`] tells with which.
pub fn is_conflict(a: &Text, b: &Text) -> bool {
    conflict(a, b).is_some()
}
