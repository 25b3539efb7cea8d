//! The return of an identifier (M10): whether what agrees was merely tracked through one passage.

use std::collections::BTreeSet;

use super::passage::{is_seen_once, share_passage};
use crate::domain::ids::{AnchorSeq, KeyframeSeq};
use crate::recognition::loops::anchor_map::LocalAnchor;
use crate::recognition::loops::comparison::{Comparison, Matched};
use crate::recognition::loops::query::Query;
use crate::recognition::map::index::MapIndex;

/// The way in which two keyframes know an identifier that matches and was not merely tracked through this same passage.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Returning {
    /// None matches.
    No,
    /// It is around them: a covisible keyframe sees it.
    Around,
    /// Both see it themselves.
    InView,
}

/// Whether a matched pair is one object of which the two keyframes are in one passage, or that was seen in one alone.
pub fn is_tracked(index: &MapIndex, pair: &Matched<'_>, query: KeyframeSeq, candidate: KeyframeSeq) -> bool {
    let one = pair.query.name.object().filter(|_| pair.query.name == pair.candidate.name);
    one.is_some_and(|one| share_passage(index, one, query, candidate) || is_seen_once(index, one))
}

/// Returns how an identifier that matches is known, unless it was merely tracked from the candidate to the query (M41).
pub fn returning_identifier(
    index: &MapIndex,
    comparison: &Comparison<'_>,
    query: &Query<'_>,
    nearest: Option<KeyframeSeq>,
    candidate: KeyframeSeq,
) -> Returning {
    let names = |anchor: &LocalAnchor| anchor.text.as_ref().is_some_and(|text| text.has_name());
    let tracked = |pair: &Matched<'_>| nearest.is_some_and(|query| is_tracked(index, pair, query, candidate));
    let returns = |pair: &&Matched<'_>| names(pair.query) && names(pair.candidate) && !tracked(pair);
    let seen_by_candidate = index.objects_seen_by(candidate);
    let known = |pair: &Matched<'_>| {
        if is_in_view(pair, &query.seen, &seen_by_candidate) { Returning::InView } else { Returning::Around }
    };
    comparison.matches.iter().filter(returns).map(known).max().unwrap_or(Returning::No)
}

/// Whether two keyframes see a matched pair themselves; `by_query` and `by_candidate` are the objects that they see.
pub fn is_in_view(
    pair: &Matched<'_>,
    by_query: &BTreeSet<AnchorSeq>,
    by_candidate: &BTreeSet<AnchorSeq>,
) -> bool {
    let sees = |anchor: &LocalAnchor, seen: &BTreeSet<AnchorSeq>| {
        anchor.name.object().is_none_or(|root| seen.contains(&root))
    };
    sees(pair.query, by_query) && sees(pair.candidate, by_candidate)
}
