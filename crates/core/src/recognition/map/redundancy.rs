//! Redundant keyframes (M58): others see nearly all that they see. A client deletes them when a quota nears; nothing else does.

use std::collections::BTreeSet;

use super::index::{Anchor, MapIndex};
use crate::domain::change::Keyframe;
use crate::domain::ids::{AnchorSeq, KeyframeSeq};

/// The share of a keyframe's map points that others must see, as in ORB-SLAM's culling; as a fraction, so that nothing is
/// rounded.
const SEEN_BY_OTHERS: (usize, usize) = (9, 10);

/// Keyframes that one search looks at. A keyframe costs as much as its map points.
pub const LOOKED_AT_MAX: usize = if cfg!(test) { 7 } else { 1_000 };

/// Some redundant keyframes, in order of arrival, and where the next search starts.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Redundant {
    /// They may all go.
    pub keyframes: Vec<KeyframeSeq>,
    /// The first keyframe that was not looked at.
    pub next: Option<KeyframeSeq>,
}

/// Looks for at most `most` redundant keyframes, from one on. Each is so in its turn, without those named before it. Without all
/// of them, every anchor is still seen.
pub fn find_redundant(index: &MapIndex, from: KeyframeSeq, most: usize) -> Redundant {
    let mut going = BTreeSet::new();
    let mut rest = index.keyframes_from(from);
    for keyframe in rest.by_ref().take(LOOKED_AT_MAX) {
        if going.len() == most {
            return Redundant { keyframes: going.into_iter().collect(), next: Some(keyframe.seq) };
        }
        if is_redundant(index, keyframe, &going) {
            going.insert(keyframe.seq);
        }
    }
    let next = rest.next().map(|keyframe| keyframe.seq);
    Redundant { keyframes: going.into_iter().collect(), next }
}

/// Whether others than those that go see nine in ten of a keyframe's map points, and every anchor. One without map points shows
/// nothing that others could see.
fn is_redundant(index: &MapIndex, keyframe: &Keyframe, going: &BTreeSet<KeyframeSeq>) -> bool {
    let stays = |other: KeyframeSeq| other != keyframe.seq && !going.contains(&other);
    let is_seen = |root: &AnchorSeq| {
        let anchors = index.objects().get(*root).into_iter().flat_map(|object| index.anchors_of(object));
        anchors.flat_map(Anchor::keyframes).any(stays)
    };
    if keyframe.observes.is_empty() || !index.objects_seen_by(keyframe.seq).iter().all(is_seen) {
        return false;
    }
    let seen = index.points().count_observed(keyframe.session, keyframe.observes.iter(), stays);
    let (share, of) = SEEN_BY_OTHERS;
    of * seen >= share * keyframe.observes.len()
}

#[cfg(test)]
mod tests;
