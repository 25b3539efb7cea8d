//! Sightings: where an object stands in one session's frame, and whether two of them may be one place (M6).
//!
//! Two sightings are two places only if odometry can tell: apart by more than the radius and by more than it may have
//! drifted on the way between them. What one local anchor map holds, a room with two doors that bear its number, is one.

use std::collections::BTreeSet;

use super::tracked_path::drift_m;
use crate::domain::ids::{AnchorSeq, KeyframeSeq, SessionSeq};
use crate::geometry::Point3;
use crate::recognition::map::index::{MapIndex, MergedAnchor, Milestone};

/// An object, or what an inline keyframe sees, in the frame of one session.
#[derive(Clone, Copy, Debug)]
pub struct Sighting<'a> {
    /// The centre of its box.
    pub centre: Point3,
    by: By<'a>,
    /// The place of its first keyframe on the session's way.
    milestone: Option<Milestone>,
}

#[derive(Clone, Copy, Debug)]
enum By<'a> {
    MergedAnchor(&'a MergedAnchor),
    /// An inline keyframe, with those it is covisible with.
    Inline(&'a BTreeSet<KeyframeSeq>),
}

impl<'a> Sighting<'a> {
    /// Returns the sighting of an object; none where it has no box, or where nothing measured how far it is.
    pub fn of(index: &'a MapIndex, root: AnchorSeq, session: SessionSeq) -> Option<Self> {
        let object = index.objects().get(root)?;
        let shape = object.shapes.get(&session).filter(|shape| !shape.range_assumed)?;
        let in_session = |seq: &KeyframeSeq| index.session_of(*seq) == Some(session);
        let first = index.anchors_of(object).filter_map(|anchor| anchor.keyframes().find(in_session)).min();
        let milestone = first.and_then(|first| index.milestone(first));
        Some(Self { centre: shape.aabb?.centre(), by: By::MergedAnchor(object), milestone })
    }

    /// Returns the sighting by an inline keyframe: no way leads to it.
    pub fn inline(centre: Point3, covisible: &'a BTreeSet<KeyframeSeq>) -> Self {
        Self { centre, by: By::Inline(covisible), milestone: None }
    }

    /// Whether an inline keyframe sees it.
    pub fn is_inline(&self) -> bool {
        matches!(self.by, By::Inline(_))
    }

    /// Whether odometry cannot tell two sightings of one session apart.
    pub fn may_be_at(&self, other: &Self, index: &MapIndex) -> bool {
        let settings = &index.properties().settings;
        let way_m = self.milestone.zip(other.milestone).and_then(|(a, b)| a.way_to_m(&b)).unwrap_or(0.0);
        let limit_m = drift_m(way_m, settings.distinctive_place_radius_m, settings);
        (self.centre - other.centre).norm() <= limit_m
    }

    /// Returns the keyframes that see it.
    pub fn keyframes(&self, index: &MapIndex) -> BTreeSet<KeyframeSeq> {
        match self.by {
            By::MergedAnchor(object) => index.keyframes_of(object),
            By::Inline(_) => BTreeSet::new(),
        }
    }

    /// Whether the local anchor map around any of these keyframes holds it.
    pub fn is_around_any(&self, index: &MapIndex, keyframes: &BTreeSet<KeyframeSeq>) -> bool {
        match self.by {
            By::MergedAnchor(object) => index.covisibility().touches(&index.keyframes_of(object), keyframes),
            By::Inline(covisible) => !covisible.is_disjoint(keyframes),
        }
    }

    /// Whether one local anchor map holds both.
    pub fn shares_map_with(&self, other: &Self, index: &MapIndex) -> bool {
        (self.is_inline() && other.is_inline())
            || self.is_around_any(index, &other.keyframes(index))
            || other.is_around_any(index, &self.keyframes(index))
    }
}
