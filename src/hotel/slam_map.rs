//! SLAM map: what a robot keeps of its way itself: keyframes, its estimates of their poses, and map points.

use std::collections::HashMap;

use super::journey::Step;
use super::sensor::Feature;
use crate::geometry::{Point3, Pose};

/// Keyframes that share so many map points are covisible (ORB-SLAM's covisibility graph, and the service's default).
pub const COVISIBLE_POINTS: usize = 15;

/// A robot's keyframes, poses and map points, in a frame of its own.
#[derive(Clone, Debug, Default)]
pub struct SlamMap<'a> {
    steps: Vec<&'a Step>,
    poses: Vec<Pose>,
    points: HashMap<u64, MapPoint>,
}

/// A map point: the keyframes that see it, and its place and look in the first of them.
#[derive(Clone, Debug)]
struct MapPoint {
    first: Sight,
    observers: Vec<usize>,
}

/// A feature of a keyframe.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Sight {
    keyframe: usize,
    feature: usize,
}

impl<'a> SlamMap<'a> {
    /// Adds the next keyframe and returns its number. Its features' depths place the map points that are new.
    pub fn push(&mut self, step: &'a Step, map_from_camera: Pose) -> usize {
        let keyframe = self.steps.len();
        for (feature, (id, _)) in step.map_points.iter().enumerate() {
            let first = Sight { keyframe, feature };
            let point = self.points.entry(*id).or_insert_with(|| MapPoint { first, observers: Vec::new() });
            point.observers.push(keyframe);
        }
        self.steps.push(step);
        self.poses.push(map_from_camera);
        keyframe
    }

    /// Its keyframes' poses, `map_from_camera`.
    pub fn poses(&self) -> &[Pose] {
        &self.poses
    }

    /// Moves its keyframes, and with them the points that they saw first.
    pub fn correct(&mut self, poses: Vec<Pose>) {
        debug_assert_eq!(poses.len(), self.poses.len(), "a pose for each keyframe");
        self.poses = poses;
    }

    /// The features of a keyframe.
    pub fn features(&self, keyframe: usize) -> &'a [Feature] {
        &self.steps[keyframe].features
    }

    /// The map points of a keyframe, one for each feature.
    pub fn point_ids(&self, keyframe: usize) -> impl Iterator<Item = u64> + use<'a> {
        self.steps[keyframe].map_points.iter().map(|(id, _)| *id)
    }

    /// The map points with the keyframe that saw each first and its place, in the order of their numbers.
    pub fn points(&self) -> Vec<(u64, usize, Point3)> {
        let placed = |(id, point): (&u64, &MapPoint)| (*id, point.first.keyframe, self.place(point));
        let mut points: Vec<_> = self.points.iter().map(placed).collect();
        points.sort_unstable_by_key(|(id, ..)| *id);
        points
    }

    /// A map point's place in the map's frame, in metres; the pose of the camera that saw it first, and that sight.
    pub fn point(&self, id: u64) -> Option<(Point3, &Pose, &'a Feature)> {
        let point = self.points.get(&id)?;
        let Sight { keyframe, feature } = point.first;
        Some((self.place(point), &self.poses[keyframe], &self.steps[keyframe].features[feature]))
    }

    /// Up to `limit` covisible keyframes, those that share most points first, of equals the older.
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

    fn place(&self, point: &MapPoint) -> Point3 {
        let Sight { keyframe, feature } = point.first;
        self.poses[keyframe].transform(&self.steps[keyframe].features[feature].in_camera)
    }
}
