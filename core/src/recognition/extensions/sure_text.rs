//! Texts that are sure (M7): described by a model or by hand, or read alike in two passages.

use std::collections::BTreeSet;

use super::changed_signs::is_alike;
use super::passage::share_passage;
use crate::domain::ids::{AnchorSeq, KeyframeSeq};
use crate::recognition::loops::anchor_map::{LocalAnchor, LocalName};
use crate::recognition::map::index::{Certainty, MapIndex, MergedAnchor};

/// The passages in which a text must be read alike to be sure: they see it from where each drove, and do not err alike.
pub const SURE_PASSAGES: usize = 2;

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
    let anchors = object.members.iter().filter_map(|member| index.anchor(*member));
    let observations = anchors.flat_map(|anchor| anchor.observations.values());
    observations.filter(|seen| is_alike(object, seen)).map(|seen| seen.keyframe).collect()
}
