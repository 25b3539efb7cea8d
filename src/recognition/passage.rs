//! Passages: the sightings of one object in one drive past it (`contract.md` §8.7, §8.10).
//!
//! Three frames of one drive past a plate see one plate, and say nothing about a return. Two sightings in one session are of
//! one passage if a chain of keyframes that share map points, or are declared covisible, joins them, with no more than
//! `distinctive_place_radius_m` driven from one sighting to the next. Keyframes are taken in the order of their arrival. A
//! confirmed loop joins no passages: it says that the robot was here before.

use std::collections::BTreeSet;

use super::anchor_map::LocalName;
use super::comparison::Comparison;
use super::index::MapIndex;
use crate::model::ids::{AnchorSeq, KeyframeSeq};

/// Whether all that agrees are objects which a candidate saw in the very passage that the query is in.
///
/// `around_query` and `around_candidate` are the keyframes whose anchors the two local anchor maps hold.
pub fn is_tracked_only(
    index: &MapIndex,
    comparison: &Comparison<'_>,
    around_query: &BTreeSet<KeyframeSeq>,
    around_candidate: &BTreeSet<KeyframeSeq>,
) -> bool {
    let is_tracked = |root: AnchorSeq| {
        let meets = |passage: &Vec<KeyframeSeq>, around: &BTreeSet<KeyframeSeq>| {
            passage.iter().any(|sighting| around.contains(sighting))
        };
        let passages = passages(index, root);
        passages.iter().any(|passage| meets(passage, around_query) && meets(passage, around_candidate))
    };
    comparison.matches.iter().all(|pair| match (&pair.query.name, &pair.candidate.name) {
        (LocalName::Object(a), LocalName::Object(b)) => a == b && is_tracked(*a),
        _ => false,
    })
}

/// The passages of an object, each with the keyframes that saw it.
fn passages(index: &MapIndex, root: AnchorSeq) -> Vec<Vec<KeyframeSeq>> {
    let Some(object) = index.objects().get(root) else { return Vec::new() };
    let mut sightings: Vec<_> = (index.keyframes_of(object).into_iter())
        .filter_map(|seq| Some((index.keyframe(seq)?.session, seq)))
        .collect();
    sightings.sort_unstable();
    let same = |a: &(_, KeyframeSeq), b: &(_, KeyframeSeq)| a.0 == b.0 && are_joined(index, a.1, b.1);
    sightings.chunk_by(same).map(|passage| passage.iter().map(|(_, seq)| *seq).collect()).collect()
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
