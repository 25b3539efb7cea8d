//! The sight of a passage: the sign itself, another one in its place, something that it could not read, or nothing.

use std::collections::BTreeMap;

use super::passages::Passage;
use crate::domain::anchor::Observation;
use crate::domain::ids::{AnchorSeq, KeyframeSeq, SessionSeq};
use crate::geometry::Point3;
use crate::recognition::map::index::{Anchor, MapIndex, MergedAnchor};
use crate::semantics::{self, Text};

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

/// A detection that feeds an anchor.
struct Sighting<'a> {
    seq: AnchorSeq,
    anchor: &'a Anchor,
    seen: &'a Observation,
}

/// Whether a keyframe reads a sign as it is called, in a detection of the sign itself or of one as near to it as drift allows:
/// the same number may hang at the next door by now.
pub(super) fn reads_alike(
    index: &MapIndex,
    object: &MergedAnchor,
    session: SessionSeq,
    keyframe: KeyframeSeq,
) -> bool {
    let settings = &index.properties().settings;
    let near_m = settings.association_position_radius_m + settings.odometry_slack_m;
    let centre = object.aabb(session).map(|aabb| aabb.centre());
    sightings(index, object, keyframe).any(|sighting| {
        let is_itself = object.members.contains(&sighting.seq);
        let is_near = || centre.is_some_and(|centre| sighting.is_within(session, &centre, near_m));
        is_alike(object, sighting.seen) && (is_itself || is_near())
    })
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

/// Returns the detections of a keyframe that feed anchors of an object's class.
fn sightings<'a>(
    index: &'a MapIndex,
    object: &'a MergedAnchor,
    keyframe: KeyframeSeq,
) -> impl Iterator<Item = Sighting<'a>> {
    let class = index.class_of(object);
    let anchors = index.anchors_seen_by(keyframe).filter_map(|seq| Some((seq, index.anchor(seq)?)));
    anchors.filter(move |(_, anchor)| *anchor.class == *class).flat_map(move |(seq, anchor)| {
        let seen = anchor.observations.range((keyframe, 0)..=(keyframe, u16::MAX));
        seen.map(move |(_, seen)| Sighting { seq, anchor, seen })
    })
}

impl Sighting<'_> {
    /// Whether its anchor stands near a place of a session's frame.
    fn is_within(&self, session: SessionSeq, place: &Point3, near_m: f64) -> bool {
        let stands = self.anchor.shapes.get(&session).and_then(|shape| Some(shape.aabb?.centre()));
        stands.is_some_and(|stands| (stands - place).norm() <= near_m)
    }
}

/// Whether one keyframe has seen both: then the other is a neighbour, and hangs in nobody's place.
fn hangs_beside(index: &MapIndex, object: &MergedAnchor, other: AnchorSeq) -> bool {
    let root = index.objects().root(other).filter(|_| !object.members.contains(&other));
    let neighbour = root.and_then(|root| index.objects().get(root));
    neighbour.is_some_and(|neighbour| !index.keyframes_of(object).is_disjoint(&index.keyframes_of(neighbour)))
}

/// Whether a detection was read as the object is called.
pub(super) fn is_alike(object: &MergedAnchor, seen: &Observation) -> bool {
    let Some(description) = &object.description else { return false };
    let is_alike = |reading: &str| {
        *reading == *description.raw || Text::parse(reading).gist() == description.text.gist()
    };
    readings(seen).any(is_alike)
}

/// Returns what was read in a detection, if it excludes what the object is called.
pub(super) fn read_otherwise(index: &MapIndex, object: &MergedAnchor, seen: &Observation) -> Option<Text> {
    let description = object.description.as_ref()?;
    let numbering = index.readings().numbering(index.class_of(object));
    let mut texts = readings(seen).map(|reading| Text::under(reading, numbering));
    texts.find(|text| semantics::conflict(&description.text, text).is_some())
}

/// Returns the text that the client read, and the one that a model read.
fn readings(seen: &Observation) -> impl Iterator<Item = &str> {
    let by_model = seen.crop_reading.as_ref().map(|read| &*read.text);
    seen.reading.as_deref().into_iter().chain(by_model)
}
