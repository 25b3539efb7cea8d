//! Closed returns: a loop that would say what a confirmed one has said already (M63).
//!
//! A confirmed loop makes the signs around its two keyframes one. The next keyframes of the same return see these signs again:
//! closing them too adds nothing, and a robot that closes whatever it is told closes one place again and again. A sign that no
//! loop has joined yet is new, and so is the loop that joins it.

use std::cell::LazyCell;
use std::collections::BTreeSet;
use std::ops::Deref;

use super::passage::share_passage;
use super::returning::is_tracked;
use crate::domain::change::{Loop, Merge, MergeCause};
use crate::domain::ids::{AnchorSeq, KeyframeSeq};
use crate::domain::verdict::ClosedLoop;
use crate::recognition::loops::comparison::{Comparison, Matched};
use crate::recognition::loops::query::Query;
use crate::recognition::map::index::{Anchor, MapIndex};

/// Returns the confirmed loop of this passage that a loop between the two would repeat: every sign that matches is one in the
/// map already, and this loop joined one of them; or none matches, and it joins the two passages. None if there is none.
pub fn repeated_loop(
    index: &MapIndex,
    comparison: &Comparison<'_>,
    query: &Query<'_>,
    candidate: KeyframeSeq,
) -> Option<ClosedLoop> {
    if index.loops().is_empty() {
        return None;
    }
    if comparison.matches.is_empty() {
        return joined_return(index, query, candidate);
    }
    let sign_of =
        |pair: &Matched<'_>| pair.query.name.object().filter(|_| pair.query.name == pair.candidate.name);
    if comparison.matches.iter().any(|pair| sign_of(pair).is_none()) {
        return None;
    }
    // As far as the query's local anchor map reaches, but through no loop.
    let passage = LazyCell::new(|| around_by_sight(index, query));
    let nearest = query.nearest()?;
    let mut returns = comparison.matches.iter().filter(|pair| !is_tracked(index, pair, nearest, candidate));
    let joined = returns.find_map(|pair| merging_loop(index, sign_of(pair)?, &passage));
    joined.map(|closed| of_query(query, closed))
}

/// Returns the confirmed loop between the passages of the query and of a candidate.
fn joined_return(index: &MapIndex, query: &Query<'_>, candidate: KeyframeSeq) -> Option<ClosedLoop> {
    joining_loop(index, &query.centre.covisible, candidate).map(|closed| of_query(query, closed))
}

fn of_query(query: &Query<'_>, closed: &Loop) -> ClosedLoop {
    let starts_here = query.centre.covisible.contains(&closed.keyframe);
    let other = if starts_here { &closed.candidate_id } else { &closed.keyframe_id };
    ClosedLoop { id: closed.id.clone(), keyframe: other.clone() }
}

/// Returns the confirmed loop that joins the passages of the query and of a candidate: somebody knows that it is one place.
fn joining_loop<'m>(
    index: &'m MapIndex,
    around_query: &BTreeSet<KeyframeSeq>,
    candidate: KeyframeSeq,
) -> Option<&'m Loop> {
    let mut closed = around_query.iter().flat_map(|keyframe| index.loops_of(*keyframe)).peekable();
    closed.peek()?;
    let around: BTreeSet<KeyframeSeq> = index.covisibility().with_itself(candidate).collect();
    closed.find(|closed| {
        let joins = |here, there| around_query.contains(&here) && around.contains(&there);
        joins(closed.keyframe, closed.candidate) || joins(closed.candidate, closed.keyframe)
    })
}

/// Returns the loop of a passage that made a sign one: it merged what this passage saw of it with what others did.
fn merging_loop<'m>(
    index: &'m MapIndex,
    sign: AnchorSeq,
    passage: &impl Deref<Target = BTreeSet<KeyframeSeq>>,
) -> Option<&'m Loop> {
    let object = index.objects().get(sign)?;
    let loop_of = |merge: &Merge| match &merge.cause {
        MergeCause::Loop(id) => index.loops().get(id),
        MergeCause::Covisible => None,
    };
    let links = |member: &AnchorSeq| index.objects().links(*member).filter_map(loop_of);
    // Most signs were joined by no loop: then nothing more is asked.
    object.members.iter().find_map(|member| links(member).next())?;
    let mut sightings = BTreeSet::new();
    let mut own = BTreeSet::new();
    for member in &object.members {
        let seen_by = index.anchor(*member).into_iter().flat_map(Anchor::keyframes);
        let here: Vec<KeyframeSeq> = seen_by.filter(|keyframe| passage.contains(keyframe)).collect();
        if !here.is_empty() {
            own.extend(index.objects().same_passage(*member));
            sightings.extend(here);
        }
    }
    let is_here = |end| sightings.iter().any(|seen| *seen == end || share_passage(index, sign, *seen, end));
    let of_passage = |closed: &&Loop| is_here(closed.keyframe) || is_here(closed.candidate);
    own.iter().flat_map(links).filter(of_passage).min_by(|a, b| a.id.cmp(&b.id))
}

/// Returns the keyframes at most two steps of covisibility away from a query, loops left out.
fn around_by_sight(index: &MapIndex, query: &Query<'_>) -> BTreeSet<KeyframeSeq> {
    let near: Vec<KeyframeSeq> =
        query.centre.covisible.iter().copied().filter(|near| query.passes_with(index, *near)).collect();
    let beyond = near.iter().flat_map(|near| index.covisibility().neighbours_by_sight(*near));
    beyond.chain(near.iter().copied()).collect()
}
