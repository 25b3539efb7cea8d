//! The readings of one keyframe, held against what a sign is called.

use crate::domain::anchor::Observation;
use crate::domain::ids::{AnchorSeq, KeyframeSeq, SessionSeq};
use crate::geometry::Point3;
use crate::recognition::extensions::tracked_path::SLACK_M;
use crate::recognition::map::index::{Anchor, MapIndex, MergedAnchor};
use crate::semantics::{self, Text};

/// A detection that feeds an anchor.
pub(super) struct Sighting<'a> {
    /// The anchor.
    pub seq: AnchorSeq,
    /// The same with its facts.
    pub anchor: &'a Anchor,
    /// The detection.
    pub seen: &'a Observation,
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
    let near_m = settings.association_position_radius_m + SLACK_M;
    let centre = object.aabb(session).map(|aabb| aabb.centre());
    sightings(index, object, keyframe).any(|sighting| {
        let is_itself = object.members.contains(&sighting.seq);
        let is_near = || centre.is_some_and(|centre| sighting.is_within(session, &centre, near_m));
        is_alike(object, sighting.seen) && (is_itself || is_near())
    })
}

/// Returns the detections of a keyframe that feed anchors of an object's class.
pub(super) fn sightings<'a>(
    index: &'a MapIndex,
    object: &'a MergedAnchor,
    keyframe: KeyframeSeq,
) -> impl Iterator<Item = Sighting<'a>> {
    let class = index.class_of(object);
    index.detections_of(keyframe).filter_map(move |(seq, seen)| {
        let anchor = index.anchor(seq).filter(|anchor| *anchor.class == *class)?;
        Some(Sighting { seq, anchor, seen })
    })
}

impl Sighting<'_> {
    /// Whether its anchor stands near a place of a session's frame.
    pub(super) fn is_within(&self, session: SessionSeq, place: &Point3, near_m: f64) -> bool {
        let stands = self.anchor.shapes.get(&session).and_then(|shape| Some(shape.aabb?.centre()));
        stands.is_some_and(|stands| (stands - place).norm() <= near_m)
    }
}

/// Whether a detection was read as the object is called.
pub(in crate::recognition::extensions) fn is_alike(object: &MergedAnchor, seen: &Observation) -> bool {
    let Some(description) = &object.description else { return false };
    // Most are written alike.
    let is_alike = |reading: &str| *reading == *description.raw || description.text.reads_as(reading);
    seen.readings().any(is_alike)
}

/// Returns what was read in a detection, if it excludes what the object is called.
pub(super) fn read_otherwise(index: &MapIndex, object: &MergedAnchor, seen: &Observation) -> Option<Text> {
    let description = object.description.as_ref()?;
    let numbering = index.readings().numbering(index.class_of(object));
    let mut texts = seen.readings().map(|reading| Text::under(reading, numbering));
    texts.find(|text| semantics::is_conflict(&description.text, text))
}
