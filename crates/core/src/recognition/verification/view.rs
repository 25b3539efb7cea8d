//! The two keyframes and the landmarks that a verification compares.

use super::descriptor_matching::Side;
use crate::domain::keyframe::{Camera, Keypoint};
use crate::geometry::Point3;
use crate::geometry::hamming::PackedDescriptors;
use crate::geometry::pinhole::Pinhole;

/// A keyframe as the verification sees it. The lists run in parallel.
#[derive(Clone, Copy, Debug)]
pub struct View<'a> {
    /// Its camera.
    pub camera: Camera,
    /// Positions of its features, in pixels.
    pub keypoints: &'a [Keypoint],
    /// Their descriptors.
    pub descriptors: &'a PackedDescriptors,
    /// The vocabulary's node of each, [`super::descriptor_matching::NO_NODE`] for none; `None` without a vocabulary.
    pub nodes: Option<&'a [u32]>,
    /// The map point of each in this keyframe's camera frame, in metres, if it has one with a position.
    pub points_in_camera: &'a [Option<Point3>],
}

impl View<'_> {
    /// Returns the camera.
    pub(super) fn pinhole(&self) -> Pinhole {
        let Camera { fx, fy, cx, cy, .. } = self.camera;
        Pinhole { fx, fy, cx, cy }
    }

    /// Returns where the image shows a feature.
    pub(super) fn pixel(&self, feature: u32) -> [f64; 2] {
        let keypoint = &self.keypoints[feature as usize];
        [keypoint.u, keypoint.v]
    }

    /// Returns the features that have a position.
    pub(super) fn located(&self) -> Vec<u32> {
        let points = self.points_in_camera.iter().enumerate();
        points.filter(|(_, point)| point.is_some()).map(|(feature, _)| feature as u32).collect()
    }
}

/// A map point that keyframes covisible with the candidate see. The caller leaves out those that the candidate sees itself,
/// whose features its [`View`] has, and, within one session, those that the query sees: that they match says nothing.
#[derive(Clone, Copy, Debug)]
pub struct Landmark<'a> {
    /// A name of the caller's choice. A landmark seen several times may come with each of its descriptors, under one id.
    pub id: u64,
    /// Its position in the candidate's camera frame, in metres.
    pub point_in_camera: Point3,
    /// Its descriptor.
    pub descriptor: &'a [u64],
}

/// Returns the features of a view that take part in a matching.
pub(super) fn side<'a>(view: &View<'a>, features: &'a [u32]) -> Side<'a> {
    Side { descriptors: view.descriptors, keypoints: view.keypoints, nodes: view.nodes, features }
}
