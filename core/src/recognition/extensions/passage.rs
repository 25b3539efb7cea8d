//! Passages: the sightings of one object in one drive past it (M7, M10).
//!
//! Three frames of one drive past a plate see one plate, and say nothing about a return. Two sightings in one session are of
//! one passage if a chain of keyframes that share map points, or are declared covisible, joins them, with no more than
//! `distinctive_place_radius_m` driven from one sighting to the next. Keyframes are taken in the order of their arrival. A
//! confirmed loop joins no passages: it says that the robot was here before.

use std::collections::BTreeSet;

use crate::domain::ids::{AnchorSeq, KeyframeSeq};
use crate::recognition::loops::anchor_map::{LocalAnchor, LocalName};
use crate::recognition::loops::comparison::{Comparison, Matched};
use crate::recognition::loops::query::Query;
use crate::recognition::map::index::{Certainty, MapIndex, MergedAnchor};
use crate::semantics::Text;

/// The passages in which a text must be read alike to be sure: they see it from where each drove, and do not err alike.
pub const SURE_PASSAGES: usize = 2;

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

/// Whether all that agrees are objects of which the two keyframes are in one passage.
pub fn is_tracked_only(
    index: &MapIndex,
    comparison: &Comparison<'_>,
    query: KeyframeSeq,
    candidate: KeyframeSeq,
) -> bool {
    comparison.matches.iter().all(|pair| is_tracked(index, pair, query, candidate))
}

/// Whether a matched pair is one object of which the two keyframes are in one passage.
pub fn is_tracked(index: &MapIndex, pair: &Matched<'_>, query: KeyframeSeq, candidate: KeyframeSeq) -> bool {
    match (&pair.query.name, &pair.candidate.name) {
        (LocalName::MergedAnchor(a), LocalName::MergedAnchor(b)) => {
            a == b && share_passage(index, *a, query, candidate)
        }
        _ => false,
    }
}

/// Returns how an identifier that matches is known, unless it was merely tracked from the candidate to the query (M41).
pub fn returning_identifier(
    index: &MapIndex,
    comparison: &Comparison<'_>,
    query: &Query<'_>,
    nearest: Option<KeyframeSeq>,
    candidate: KeyframeSeq,
) -> Returning {
    let names =
        |anchor: &LocalAnchor| anchor.text.as_ref().is_some_and(|text| !text.identifiers().is_empty());
    let tracked = |pair: &Matched<'_>| nearest.is_some_and(|query| is_tracked(index, pair, query, candidate));
    let returns = |pair: &&Matched<'_>| {
        names(pair.query) && names(pair.candidate) && !pair.is_disputed && !tracked(pair)
    };
    let seen_by_candidate = index.objects_seen_by(candidate);
    let sees = |anchor: &LocalAnchor, seen: &BTreeSet<AnchorSeq>| match anchor.name {
        LocalName::MergedAnchor(root) => seen.contains(&root),
        LocalName::Inline(_) => true,
    };
    let in_view =
        |pair: &Matched<'_>| sees(pair.query, &query.seen) && sees(pair.candidate, &seen_by_candidate);
    let known = |pair| if in_view(pair) { Returning::InView } else { Returning::Around };
    comparison.matches.iter().filter(returns).map(known).max().unwrap_or(Returning::No)
}

/// Whether what an anchor is called is sure: described by a model or by hand, or read alike in two passages.
pub fn is_sure(index: &MapIndex, anchor: &LocalAnchor) -> bool {
    match (anchor.certainty, anchor.name) {
        (Certainty::Sure, _) => true,
        (Certainty::ReadAlike, LocalName::MergedAnchor(root)) => {
            passages_read_alike(index, root) >= SURE_PASSAGES
        }
        _ => false,
    }
}

/// Settles what is known of an anchor, for what comes after without the map.
pub fn settle(index: &MapIndex, anchor: &mut LocalAnchor) {
    if is_sure(index, anchor) {
        anchor.certainty = Certainty::Sure;
    }
}

/// Counts the passages in which an object was read as it is called; counting ends where it is enough.
pub fn passages_read_alike(index: &MapIndex, root: AnchorSeq) -> usize {
    let Some(object) = index.objects().get(root) else { return 0 };
    let alike = read_alike(index, object);
    let Some((first, last)) = alike.first().zip(alike.last()) else { return 0 };
    let session = |seq: &KeyframeSeq| index.keyframe(*seq).map(|keyframe| keyframe.session);
    // What joins the first of a session to the last joins all between them.
    let are_of_one = alike.iter().all(|seq| session(seq) == session(first));
    1 + usize::from(!are_of_one || !share_passage(index, root, *first, *last))
}

/// Returns the keyframes that read an object as it is called, ascending.
fn read_alike(index: &MapIndex, object: &MergedAnchor) -> BTreeSet<KeyframeSeq> {
    let Some(description) = &object.description else { return BTreeSet::new() };
    let is_alike = |reading: &str| Text::parse(reading).normalised() == description.text.normalised();
    let anchors = object.members.iter().filter_map(|member| index.anchor(*member));
    let alike = anchors.flat_map(|anchor| anchor.observations.values()).filter(|observation| {
        let by_model = observation.crop_reading.as_ref().map(|read| &*read.text);
        observation.reading.as_deref().into_iter().chain(by_model).any(is_alike)
    });
    alike.map(|observation| observation.keyframe).collect()
}

/// Whether two keyframes are in one passage of an object; either may see it, or be next to one that does.
fn share_passage(index: &MapIndex, root: AnchorSeq, a: KeyframeSeq, b: KeyframeSeq) -> bool {
    let Some(object) = index.objects().get(root) else { return false };
    let mut sightings = index.keyframes_of(object);
    sightings.extend([a, b]);
    let session = |seq: KeyframeSeq| index.keyframe(seq).map(|keyframe| keyframe.session);
    let (Some(own), (first, last)) = (session(a), (a.min(b), a.max(b))) else { return false };
    if session(b) != Some(own) {
        return false;
    }
    let between: Vec<KeyframeSeq> =
        sightings.range(first..=last).copied().filter(|seq| session(*seq) == Some(own)).collect();
    between.windows(2).all(|pair| are_joined(index, pair[0], pair[1]))
}

/// Whether a chain joins a sighting and the next one of the session, with little driven between them.
fn are_joined(index: &MapIndex, first: KeyframeSeq, last: KeyframeSeq) -> bool {
    let radius_m = index.properties().settings.distinctive_place_radius_m;
    let Some(from) = index.keyframe(first) else { return false };
    let (mut way_m, mut place) = (0.0, from.map_from_camera.centre());
    let mut between = BTreeSet::new();
    for keyframe in index.keyframes_from(first).take_while(|keyframe| keyframe.seq <= last) {
        if keyframe.session != from.session {
            continue;
        }
        way_m += (keyframe.map_from_camera.centre() - place).norm();
        if way_m > radius_m {
            return false;
        }
        place = keyframe.map_from_camera.centre();
        between.insert(keyframe.seq);
    }
    // Not every keyframe need see what the one before saw.
    let sight = index.covisibility();
    let mut open = vec![first];
    between.remove(&first);
    while let Some(seq) = open.pop() {
        if sight.joins_by_sight(seq, last) {
            return true;
        }
        for next in sight.neighbours(seq).filter(|next| sight.joins_by_sight(seq, *next)) {
            if between.remove(&next) {
                open.push(next);
            }
        }
    }
    false
}
