//! Passages: the sightings of one object in one drive past it (M7, M10).
//!
//! Three frames of one drive past a plate see one plate, and say nothing about a return. Two sightings in one session are of
//! one passage if a chain of keyframes that share map points, are declared covisible or are near along the drive, joins them, with no more than
//! `distinctive_place_radius_m` driven from one sighting to the next. Keyframes are taken in the order of their arrival. A
//! confirmed loop joins no passages: it says that the robot was here before.

use std::collections::BTreeSet;

use crate::domain::ids::{AnchorSeq, KeyframeSeq};
use crate::recognition::anchors::matching::matches;
use crate::recognition::map::index::MapIndex;

/// Whether two keyframes are in one passage of an object; either may see it, or be next to one that does.
pub fn share_passage(index: &MapIndex, root: AnchorSeq, a: KeyframeSeq, b: KeyframeSeq) -> bool {
    let Some(object) = index.objects().get(root) else { return false };
    let mut sightings = index.keyframes_of(object);
    sightings.extend([a, b]);
    let own = index.session_of(a);
    if own.is_none() || index.session_of(b) != own {
        return false;
    }
    let between = sightings.range(a.min(b)..=a.max(b)).copied();
    let between: Vec<KeyframeSeq> = between.filter(|seq| index.session_of(*seq) == own).collect();
    between.windows(2).all(|pair| are_joined(index, pair[0], pair[1]))
}

/// Whether an object was seen in one passage alone, and nothing else in the map is called like it: who knows it from two
/// places knows it by odometry, and has not seen it again.
pub fn is_seen_once(index: &MapIndex, root: AnchorSeq) -> bool {
    if matches(index, root).next().is_some() {
        return false;
    }
    let Some(object) = index.objects().get(root) else { return false };
    let is_one = |pair: &[KeyframeSeq]| {
        index.session_of(pair[0]) == index.session_of(pair[1]) && are_joined(index, pair[0], pair[1])
    };
    let sightings: Vec<KeyframeSeq> = index.keyframes_of(object).into_iter().collect();
    sightings.windows(2).all(is_one)
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
    let sight = index.covisibility();
    if sight.joins_by_sight(first, last) {
        return true;
    }
    // Not every keyframe need see what the one before saw.
    let mut open = vec![first];
    between.remove(&first);
    while let Some(seq) = open.pop() {
        if sight.joins_by_sight(seq, last) {
            return true;
        }
        for next in sight.neighbours_by_sight(seq) {
            if between.remove(&next) {
                open.push(next);
            }
        }
    }
    false
}
