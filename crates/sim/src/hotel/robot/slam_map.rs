//! SLAM map: a robot's own keyframes, pose estimates and map points.

use std::collections::HashMap;

use crate::geometry::{Point3, Pose, Sim3};
use crate::hotel::sensing::sensor::Feature;
use crate::hotel::sequence::Step;

/// Keyframes that share at least this many map points are covisible (ORB-SLAM's covisibility graph, and the service's default).
pub const COVISIBLE_POINTS: usize = 15;

/// A robot's keyframes, poses and map points, in its own frame.
#[derive(Clone, Debug, Default)]
pub struct SlamMap<'a> {
    steps: Vec<&'a Step>,
    /// `map_from_camera` of each; its scale is the length of the frame's unit in the map, 1 where depth is measured.
    frames: Vec<Sim3>,
    points: HashMap<u64, MapPoint>,
}

/// A map point: the keyframes that see it, its appearance in the first of them, and its position in the last that
/// placed it.
#[derive(Clone, Debug)]
struct MapPoint {
    /// Its feature in the first of its observers.
    feature: usize,
    reference: Option<Reference>,
    observers: Vec<usize>,
}

/// A map point's position in the camera frame of a keyframe, in that frame's unit.
#[derive(Clone, Copy, Debug)]
struct Reference {
    keyframe: usize,
    in_camera: Point3,
}

impl<'a> SlamMap<'a> {
    /// Adds the next keyframe and returns its number.
    pub fn push(&mut self, step: &'a Step, map_from_camera: &Sim3) -> usize {
        let keyframe = self.steps.len();
        for (feature, id) in step.map_points.iter().enumerate() {
            let new = || MapPoint { feature, reference: None, observers: Vec::new() };
            self.points.entry(*id).or_insert_with(new).observers.push(keyframe);
        }
        for placed in &step.placed {
            if let Some(point) = self.points.get_mut(&step.map_points[placed.feature]) {
                point.reference = Some(Reference { keyframe, in_camera: placed.in_camera });
            }
        }
        self.steps.push(step);
        self.frames.push(*map_from_camera);
        keyframe
    }

    /// Returns `map_from_camera` of its keyframes, each with the length of its frame's unit in the map as its scale.
    pub fn frames(&self) -> &[Sim3] {
        &self.frames
    }

    /// Returns the pose of a keyframe.
    pub fn pose(&self, keyframe: usize) -> Pose {
        self.frames[keyframe].without_scale()
    }

    /// Corrects its keyframes, and with them the points that they placed.
    pub fn correct(&mut self, frames: Vec<Sim3>) {
        debug_assert_eq!(frames.len(), self.frames.len(), "one for each keyframe");
        self.frames = frames;
    }

    /// Returns the features of a keyframe.
    pub fn features(&self, keyframe: usize) -> &'a [Feature] {
        &self.steps[keyframe].features
    }

    /// Returns the map points of a keyframe, one for each feature.
    pub fn point_ids(&self, keyframe: usize) -> impl Iterator<Item = u64> + use<'a> {
        self.steps[keyframe].map_points.iter().copied()
    }

    /// Returns the map points that have a position, with the keyframe that placed each, in the order of their numbers.
    pub fn points(&self) -> Vec<(u64, usize, Point3)> {
        let placed = |(id, point): (&u64, &MapPoint)| {
            let reference = point.reference?;
            Some((*id, reference.keyframe, self.place(reference)))
        };
        let mut points: Vec<_> = self.points.iter().filter_map(placed).collect();
        points.sort_unstable_by_key(|(id, ..)| *id);
        points
    }

    /// Returns a map point's position in the map's frame, if it has one, with the pose and the feature of its first
    /// observation.
    pub fn point(&self, id: u64) -> Option<(Point3, Pose, &'a Feature)> {
        let point = self.points.get(&id)?;
        let first = point.observers[0];
        Some((self.place(point.reference?), self.pose(first), &self.steps[first].features[point.feature]))
    }

    /// Returns up to `limit` covisible keyframes, those that share most points first, of equals the older.
    pub fn covisible(&self, keyframe: usize, limit: usize) -> Vec<usize> {
        let mut shared: HashMap<usize, usize> = HashMap::new();
        for observer in self.point_ids(keyframe).flat_map(|id| &self.points[&id].observers) {
            *shared.entry(*observer).or_default() += 1;
        }
        let is_covisible =
            |(other, points): &(usize, usize)| *other != keyframe && *points >= COVISIBLE_POINTS;
        let mut covisible: Vec<(usize, usize)> = shared.into_iter().filter(is_covisible).collect();
        covisible.sort_unstable_by_key(|(other, points)| (std::cmp::Reverse(*points), *other));
        covisible.into_iter().take(limit).map(|(other, _)| other).collect()
    }

    fn place(&self, Reference { keyframe, in_camera }: Reference) -> Point3 {
        self.pose(keyframe).transform(&(in_camera * self.frames[keyframe].scale()))
    }
}
