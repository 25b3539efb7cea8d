//! An anchor as founded, with its own observations; and what follows from them.

use std::collections::{BTreeMap, BTreeSet};

use super::parsed_readings::ParsedReadings;
use super::points::Points;
use super::votes::Votes;
use crate::domain::anchor::Observation;
use crate::domain::change::Keyframe;
use crate::domain::ids::{KeyframeSeq, PointId, SessionSeq};
use crate::domain::prior::Prior;
use crate::geometry::{Aabb, Point3};

/// A semantic anchor (§IV-B) with the facts that are its own. Which anchors are one object
/// is told by [`super::objects`]; an anchor keeps its observations when it is merged, so that
/// revoking a loop splits exactly what the loop joined.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Anchor {
    /// Class of the detected object.
    pub class: Box<str>,
    /// The observations, by keyframe and detection.
    pub observations: BTreeMap<(KeyframeSeq, u16), Observation>,
    /// What a plan says of it, if it is a prior one. Nothing observes a prior anchor.
    pub prior: Option<Box<Prior>>,
    /// The description set by an operator.
    pub description_by_hand: Option<Box<str>>,
    /// Grows with each fact about this anchor.
    pub version: u64,
    /// Derived: the vote of its readings.
    pub votes: Votes,
    /// Derived: its shape in each session's frame.
    pub shapes: BTreeMap<SessionSeq, Shape>,
}

/// An anchor's map points and its box, in one session's frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shape {
    /// The distinct map points, with and without a position.
    pub map_points: BTreeSet<PointId>,
    /// The box around everything that has a position (§IV-B).
    pub aabb: Option<Aabb>,
    /// Whether a position is in it of which nothing measured the distance.
    pub range_assumed: bool,
}

impl Shape {
    /// The other anchor is the same object: both shapes together.
    pub fn join(&mut self, other: &Self) {
        self.map_points.extend(&other.map_points);
        self.aabb = grown(self.aabb, corners(other.aabb));
        self.range_assumed |= other.range_assumed;
    }

    pub(super) fn add(&mut self, observation: &Observation, seen_by: &Keyframe, points: &Points) {
        self.map_points.extend(observation.map_points.iter().copied());
        let mut placed =
            observation.map_points.iter().filter_map(|id| points.position(seen_by.session, *id)).peekable();
        if placed.peek().is_some() {
            self.aabb = grown(self.aabb, placed);
        } else {
            // A detection's place is its map points; `position` serves where it has none.
            let position = observation.position_as_sent.map(|sent| seen_by.position_now(sent));
            self.aabb = grown(self.aabb, position);
            self.range_assumed |= observation.range_assumed && position.is_some();
        }
    }
}

fn corners(aabb: Option<Aabb>) -> impl Iterator<Item = Point3> {
    aabb.into_iter().flat_map(|aabb| [aabb.min(), aabb.max()])
}

fn grown(aabb: Option<Aabb>, points: impl IntoIterator<Item = Point3>) -> Option<Aabb> {
    Aabb::around(corners(aabb).chain(points))
}

impl Anchor {
    /// Returns an anchor without any observation yet.
    pub fn new(class: Box<str>) -> Self {
        Self { class, version: 1, ..Self::default() }
    }

    /// Takes what a plan says of it.
    pub fn set_prior(&mut self, prior: Prior) {
        self.prior = Some(Box::new(prior));
        self.place_prior();
    }

    /// Gives a prior anchor its place in the plan's frame.
    fn place_prior(&mut self) {
        if let Some(prior) = &self.prior {
            let aabb = grown(None, [prior.position_in_frame]);
            self.shapes.insert(prior.frame, Shape { aabb, ..Shape::default() });
        }
    }

    /// One more observation, by this keyframe; `is_code` says whether texts of the class are codes.
    pub fn observe(
        &mut self,
        observation: Observation,
        seen_by: &Keyframe,
        is_code: bool,
        points: &Points,
        parsed: &mut ParsedReadings,
    ) {
        self.votes.add(&observation, is_code, parsed);
        self.shapes.entry(seen_by.session).or_default().add(&observation, seen_by, points);
        self.observations.insert((observation.keyframe, observation.detection), observation);
    }

    /// Takes shape and votes anew from the observations: after a point or a keyframe moved, or one is gone.
    pub fn refresh<'k>(
        &mut self,
        keyframe: impl Fn(KeyframeSeq) -> Option<&'k Keyframe>,
        is_code: bool,
        points: &Points,
        parsed: &mut ParsedReadings,
    ) {
        self.votes = Votes::default();
        self.shapes.clear();
        self.place_prior();
        for observation in self.observations.values() {
            self.votes.add(observation, is_code, parsed);
            if let Some(seen_by) = keyframe(observation.keyframe) {
                self.shapes.entry(seen_by.session).or_default().add(observation, seen_by, points);
            }
        }
    }

    /// Returns the keyframes that saw it, ascending.
    pub fn keyframes(&self) -> impl Iterator<Item = KeyframeSeq> + '_ {
        let mut last = None;
        self.observations
            .keys()
            .filter_map(move |&(keyframe, _)| (last.replace(keyframe) != Some(keyframe)).then_some(keyframe))
    }
}
