//! Agreement of two sets of identifiers, and the conflict that excludes one object.

use crate::semantics::identifiers::identifier::{Identifier, Relation};
use crate::semantics::lexicon::role::Role;
use crate::semantics::text::{MAX_IDENTIFIERS, Text};

/// Two identifiers that cannot be of one object: 901 is not 910.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Conflict<'a> {
    /// Of the first text.
    pub a: &'a Identifier,
    /// Of the second text.
    pub b: &'a Identifier,
    /// Levenshtein distance of the canonical values: 2 for 901 and 910.
    pub differing_characters: usize,
}

/// Returns the identifiers of compatible roles that exclude each other, if any. A role clash (floor 9, room 9) is no
/// conflict.
pub fn conflict<'a>(a: &'a Text, b: &'a Text) -> Option<Conflict<'a>> {
    // Of several conflicts both orders must name the same one.
    let swapped = b.normalised() < a.normalised();
    let (first, second) = if swapped { (b, a) } else { (a, b) };
    let Some(Agreement::Conflict(x, y)) = agreement(&first.identifiers, &second.identifiers) else {
        return None;
    };
    let (a, b) = if swapped { (y, x) } else { (x, y) };
    Some(Conflict { a, b, differing_characters: strsim::levenshtein(&a.value, &b.value) })
}

/// Whether identifiers of two texts exclude each other, as [`conflict`] tells with which.
pub fn is_conflict(a: &Text, b: &Text) -> bool {
    // Nearly every sign has one identifier: then nothing can settle the difference.
    if let ([x], [y]) = (&a.identifiers[..], &b.identifiers[..]) {
        return x.relation(y) == Relation::Different;
    }
    matches!(agreement(&a.identifiers, &b.identifiers), Some(Agreement::Conflict(..)))
}

/// What two sets of identifiers say of each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Agreement<'a> {
    /// These two exclude each other: level 1.
    Conflict(&'a Identifier, &'a Identifier),
    /// They number different kinds of things: level 2.
    RolesDiffer(&'a Identifier, &'a Identifier),
    /// The best two are alike, no more: level 2 (several misread letters) or 3.
    Alike(&'a Identifier, &'a Identifier, Relation),
    /// These two agree.
    Agree {
        /// Of the first set.
        a: &'a Identifier,
        /// Of the second set.
        b: &'a Identifier,
        /// What one side says more.
        extra: Extra<'a>,
    },
}

/// What remains of two sets that agree on some identifier.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extra<'a> {
    /// Nothing, and each pair is the same number of the same thing: level 5.
    None,
    /// Nothing that matters: zeros, or a role only one side states. Level 4.
    Spelling,
    /// An identifier of another kind on one side: "room 901 floor 9", "room 901". Level 4.
    OtherRole(&'a Identifier),
    /// An identifier that could have agreed: a list of rooms is not one of them. Level 3.
    SameRole(&'a Identifier),
}

/// The best counterpart of an identifier.
#[derive(Clone, Copy)]
struct Best<'a> {
    relation: Relation,
    counterpart: Option<&'a Identifier>,
}

impl<'a> Best<'a> {
    fn improve(&mut self, relation: Relation, counterpart: &'a Identifier) {
        if relation > self.relation {
            *self = Best { relation, counterpart: Some(counterpart) };
        }
    }
}

/// Compares two sets of identifiers; nothing if one is empty.
pub fn agreement<'a>(a: &'a [Identifier], b: &'a [Identifier]) -> Option<Agreement<'a>> {
    if a.is_empty() || b.is_empty() {
        return None;
    }
    let mut best_of_a = [Best { relation: Relation::Unrelated, counterpart: None }; MAX_IDENTIFIERS];
    let mut best_of_b = best_of_a;
    for (x, best_of_x) in a.iter().zip(&mut best_of_a) {
        for (y, best_of_y) in b.iter().zip(&mut best_of_b) {
            let relation = x.relation(y);
            best_of_x.improve(relation, y);
            best_of_y.improve(relation, x);
        }
    }
    let (paired_a, paired_b) = (a.iter().zip(&best_of_a), b.iter().zip(&best_of_b));
    if let Some((x, y)) = exclusive(paired_a.clone(), &paired_b) {
        return Some(Agreement::Conflict(x, y));
    }
    // The first of the most alike, so that the reason names what a reader sees first.
    let best = paired_a.clone().filter(|(_, best)| best.relation > Relation::Different);
    let best = best.rev().max_by_key(|(_, best)| best.relation);
    let Some((x, y, relation)) = best.and_then(|(x, best)| Some((x, best.counterpart?, best.relation)))
    else {
        let same = a.iter().find_map(|x| b.iter().find(|y| x.value == y.value).map(|y| (x, y)));
        let (x, y) = same.or_else(|| a.first().zip(b.first()))?;
        return Some(Agreement::RolesDiffer(x, y));
    };
    if relation < Relation::EqualButZeros {
        return Some(Agreement::Alike(x, y, relation));
    }
    Some(Agreement::Agree { a: x, b: y, extra: extra(paired_a, paired_b) })
}

type Paired<'s, 'a> = std::iter::Zip<std::slice::Iter<'a, Identifier>, std::slice::Iter<'s, Best<'a>>>;

/// Two left-over identifiers that exclude each other.
fn exclusive<'a>(
    paired_a: Paired<'_, 'a>,
    paired_b: &Paired<'_, 'a>,
) -> Option<(&'a Identifier, &'a Identifier)> {
    let left_over =
        |(x, best): (&'a Identifier, &Best<'a>)| (best.relation == Relation::Different).then_some(x);
    let (pairs, mut left_over_a) = (paired_a.clone(), paired_a.filter_map(left_over));
    left_over_a.find_map(|x| {
        let mut left_over_b = paired_b.clone().filter_map(left_over);
        left_over_b
            .find(|y| x.role.is_compatible(&y.role) && !is_settled(pairs.clone(), x, y))
            .map(|y| (x, y))
    })
}

/// Whether something of either role agrees, or may: then the sets are lists that overlap, and what is left over is no conflict.
fn is_settled(mut pairs: Paired<'_, '_>, x: &Identifier, y: &Identifier) -> bool {
    let neutral = x.role == Role::Neutral || y.role == Role::Neutral;
    pairs.any(|(p, best)| {
        best.relation > Relation::Different
            && (neutral || best.counterpart.is_some_and(|q| [&x.role, &y.role].contains(&stated_role(p, q))))
    })
}

/// Returns what the left-over identifiers, and the spelling of the agreeing ones, take from a perfect agreement.
fn extra<'a>(paired_a: Paired<'_, 'a>, paired_b: Paired<'_, 'a>) -> Extra<'a> {
    let agrees = |best: &Best<'a>| best.relation >= Relation::EqualButZeros;
    let pairs = paired_a
        .clone()
        .filter(|(_, best)| agrees(best))
        .filter_map(|(p, best)| Some((p, best.counterpart?, best.relation)));
    let is_other_role = |x: &Identifier| {
        x.role != Role::Neutral && pairs.clone().all(|(p, q, _)| stated_role(p, q) != &x.role)
    };
    let mut other_role = None;
    for (x, best) in paired_a.chain(paired_b).filter(|(_, best)| !agrees(best)) {
        if best.relation > Relation::Different || !is_other_role(x) {
            return Extra::SameRole(x);
        }
        other_role = other_role.or(Some(x));
    }
    let respelt = |(p, q, relation): (&Identifier, &Identifier, Relation)| {
        // A bare number on a door is the room's.
        let same_thing = p.role == q.role || stated_role(p, q) == &Role::Room;
        relation != Relation::Equal || !same_thing
    };
    let spelling = pairs.clone().any(respelt);
    other_role.map_or(if spelling { Extra::Spelling } else { Extra::None }, Extra::OtherRole)
}

/// Returns the role that two compatible identifiers have together.
fn stated_role<'a>(p: &'a Identifier, q: &'a Identifier) -> &'a Role {
    // Roles sort from the firmest to none.
    (&p.role).min(&q.role)
}
