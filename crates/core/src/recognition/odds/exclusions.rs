//! Which names of two places exclude each other; each pair is compared once.

use std::cell::Cell;
use std::collections::BTreeSet;

use crate::recognition::loops::anchor_map::{LocalAnchor, LocalName};

/// Signs with other names that are compared, the nearest first.
pub(super) const DIFFERING_MAX: usize = 24;

/// The signs of two places, and what is known of their pairs.
#[derive(Debug)]
pub(super) struct Exclusions<'a> {
    query: &'a [&'a LocalAnchor],
    candidate: &'a [&'a LocalAnchor],
    /// Of each sign of the query in turn, whether it excludes each of the candidate; none where nobody asked.
    known: Vec<Cell<Option<bool>>>,
}

impl<'a> Exclusions<'a> {
    pub(super) fn between(query: &'a [&'a LocalAnchor], candidate: &'a [&'a LocalAnchor]) -> Self {
        Self { query, candidate, known: vec![Cell::new(None); query.len() * candidate.len()] }
    }

    /// Whether a sign of the query excludes one of the candidate.
    pub(super) fn has(&self, of_query: usize, of_candidate: usize) -> bool {
        let cell = &self.known[of_query * self.candidate.len() + of_candidate];
        let is_excluded =
            cell.get().unwrap_or_else(|| self.query[of_query].excludes(self.candidate[of_candidate]));
        cell.set(Some(is_excluded));
        is_excluded
    }

    /// Returns, class by class, as many names of either side as the side with fewer has that exclude all names of their class at
    /// the other place; the nearest first, and each name once. `only` are the places of the signs that are called like none of the
    /// other side.
    pub(super) fn strange(
        &self,
        [only_query, only_candidate]: &[Vec<usize>; 2],
    ) -> Vec<(LocalName, LocalName)> {
        let of_query = strange(only_query, [self.query, self.candidate], |own, other| self.has(own, other));
        let mut of_candidate =
            strange(only_candidate, [self.candidate, self.query], |own, other| self.has(other, own));
        let paired = of_query.into_iter().filter_map(|of_query| {
            let at = of_candidate.iter().position(|other| other.class == of_query.class)?;
            Some((of_query.name, of_candidate.remove(at).name))
        });
        paired.collect()
    }
}

/// Returns those of the signs at these places that exclude all of their class among the nearest of the other side.
fn strange<'a>(
    only: &[usize],
    [own, others]: [&[&'a LocalAnchor]; 2],
    excludes: impl Fn(usize, usize) -> bool,
) -> Vec<&'a LocalAnchor> {
    let nearest = others.len().min(DIFFERING_MAX);
    let is_strange = |place: &usize| {
        let mut of_class = (0..nearest).filter(|other| others[*other].class == own[*place].class).peekable();
        of_class.peek().is_some() && of_class.all(|other| excludes(*place, other))
    };
    let mut known = BTreeSet::new();
    let mut is_new =
        |sign: &&LocalAnchor| known.insert(sign.text.as_ref().map(|text| text.gist().to_owned()));
    only.iter()
        .filter(|place| is_strange(place))
        .map(|place| own[*place])
        .filter(|sign| is_new(sign))
        .collect()
}
