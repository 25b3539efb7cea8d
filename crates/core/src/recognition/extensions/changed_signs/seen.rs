//! The sight of a passage: the sign itself, another one in its place, something that it could not read, or nothing.

use std::collections::BTreeMap;

use super::passages::Passage;
use super::readings::{read_otherwise, reads_alike, sightings};
use crate::domain::ids::{AnchorSeq, KeyframeSeq};
use crate::geometry::Point3;
use crate::recognition::map::index::{MapIndex, MergedAnchor};

/// The thing that hangs in the place of a sign.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InItsPlace {
    /// Another one: a detection that feeds this anchor was read otherwise. It may be the sign's own anchor, where tracking kept
    /// its map points.
    Other(AnchorSeq),
    /// Something of its class that nobody could read.
    Unread,
    /// Nothing of its class.
    Nothing,
}

/// Counts the keyframes of the passage that read the sign as it is called.
pub fn read_alike(index: &MapIndex, passage: &Passage) -> usize {
    let Some(object) = index.objects().get(passage.sign.root) else { return 0 };
    let reads = |keyframe: &&KeyframeSeq| reads_alike(index, object, passage.sign.session, **keyframe);
    passage.drive.iter().filter(reads).count()
}

/// Whether the passage read another sign of the class, no farther from this one than a place is wide.
pub fn reads_another(index: &MapIndex, passage: &Passage) -> bool {
    let Some(object) = index.objects().get(passage.sign.root) else { return false };
    let near_m = index.properties().settings.distinctive_place_radius_m;
    passage.drive.iter().flat_map(|keyframe| sightings(index, object, *keyframe)).any(|sighting| {
        sighting.is_within(passage.sign.session, &passage.sign.centre, near_m)
            && read_otherwise(index, object, sighting.seen).is_some()
    })
}

/// Returns what the passage saw in the place of a sign that it did not read as it is called; `place` is where the sign would
/// hang, in the session's frame.
pub fn in_its_place(index: &MapIndex, passage: &Passage, place: &Point3) -> InItsPlace {
    let Some(object) = index.objects().get(passage.sign.root) else { return InItsPlace::Unread };
    let near_m = index.properties().settings.association_position_radius_m;
    let (mut others, mut is_unread) = (BTreeMap::<AnchorSeq, usize>::new(), false);
    for sighting in passage.drive.iter().flat_map(|keyframe| sightings(index, object, *keyframe)) {
        let is_itself = object.members.contains(&sighting.seq);
        let is_there = is_itself || sighting.is_within(passage.sign.session, place, near_m);
        if !is_there || hangs_beside(index, object, sighting.seq) {
            continue;
        }
        if read_otherwise(index, object, sighting.seen).is_some() {
            *others.entry(sighting.seq).or_default() += 1;
        } else {
            is_unread = true;
        }
    }
    // Of several the one that was read most, and of these the older.
    let other = others.into_iter().max_by_key(|(anchor, count)| (*count, std::cmp::Reverse(*anchor)));
    match other {
        Some((anchor, _)) => InItsPlace::Other(anchor),
        None if is_unread => InItsPlace::Unread,
        None => InItsPlace::Nothing,
    }
}

/// Whether one keyframe has seen both: then the other is a neighbour, and hangs in nobody's place.
fn hangs_beside(index: &MapIndex, object: &MergedAnchor, other: AnchorSeq) -> bool {
    let neighbour = index.object_of(other).filter(|_| !object.members.contains(&other));
    neighbour.is_some_and(|neighbour| !index.keyframes_of(object).is_disjoint(&index.keyframes_of(neighbour)))
}
