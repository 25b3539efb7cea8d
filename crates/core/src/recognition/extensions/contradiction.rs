//! Contradictions: different, sure identifiers at the same relative place (M7).
//!
//! Room 910's plate where room 901's hung is evidence against the loop, which the paper does not
//! use. An answer lists such pairs; the sum of evidence weighs them ([`crate::recognition::odds`]).

use std::collections::BTreeSet;

use crate::recognition::loops::anchor_map::LocalAnchor;
use crate::semantics;

/// A pair of anchors that cannot be the same object, though they stand at the same relative place.
#[derive(Clone, Copy, Debug)]
pub struct Contradiction<'a> {
    /// The anchor of the query's map.
    pub query: &'a LocalAnchor,
    /// The anchor of the candidate's map.
    pub candidate: &'a LocalAnchor,
}

impl Contradiction<'_> {
    /// Returns the two anchors' weights together.
    pub fn weight(&self) -> f64 {
        self.query.weight + self.candidate.weight
    }

    /// One sentence for a person: "reads 910 where 901 hung".
    pub fn reason(&self) -> String {
        let conflict = self.query.text.as_deref().zip(self.candidate.text.as_deref());
        match conflict.and_then(|(query, candidate)| semantics::conflict(query, candidate)) {
            Some(conflict) => format!("reads {} where {} hung", conflict.a.as_str(), conflict.b.as_str()),
            None => String::from("the identifiers differ"),
        }
    }
}

/// Returns the contradicting pairs among unmatched anchors, the heaviest first, and no anchor twice; `same_place` tells which
/// anchors stand at the same place.
pub fn contradict<'a>(
    query: &[&'a LocalAnchor],
    candidate: &[&'a LocalAnchor],
    same_place: impl Fn(&LocalAnchor, &LocalAnchor) -> bool,
) -> Vec<Contradiction<'a>> {
    let pairs =
        query.iter().flat_map(|a| candidate.iter().map(move |b| Contradiction { query: a, candidate: b }));
    let mut pairs: Vec<Contradiction<'a>> = pairs
        .filter(|pair| same_place(pair.query, pair.candidate) && pair.query.excludes(pair.candidate))
        .collect();
    let names = |pair: &Contradiction<'_>| (pair.query.name, pair.candidate.name);
    pairs.sort_by(|a, b| b.weight().total_cmp(&a.weight()).then_with(|| names(a).cmp(&names(b))));
    let (mut of_query, mut of_candidate) = (BTreeSet::new(), BTreeSet::new());
    pairs.retain(|pair| {
        let (a, b) = names(pair);
        let is_free = !of_query.contains(&a) && !of_candidate.contains(&b);
        is_free && of_query.insert(a) && of_candidate.insert(b)
    });
    pairs
}
