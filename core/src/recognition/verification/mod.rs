//! §V, the last step: the transformation between two keyframes, and how many features match under it.
//!
//! | step | file |
//! |---|---|
//! | points that their own image has elsewhere | [`resection`] |
//! | match descriptors | [`descriptor_matching`], [`orientation`] |
//! | points with positions on both sides: find a similarity most of them agree with | [`similarity`], [`ransac`], [`correspondence`] |
//! | refine it on the reprojection errors; how well it is known | [`refinement`], [`covariance`] |
//! | a flat patch may be tilted the other way | [`planar_ambiguity`] |
//! | project, match again, count | [`guided_search`], [`keypoint_grid`] |
//! | too few points with positions: images alone | [`two_views`] |
//! | how often chance explains as much | [`significance`] |
//! | what comes out | [`outcome`] |
//! | the thresholds | [`limits`] |
//!
//! The steps are those of ORB-SLAM3's loop detection (C. Campos et al., T-RO 2021). Unlike there, a point must lie in
//! front of both cameras, thresholds are not truncated to integers, degenerate samples are refused, random numbers come
//! from a seed, and points that only the neighbours of the candidate saw count.

pub mod correspondence;
pub mod covariance;
pub mod descriptor_matching;
pub mod guided_search;
pub mod keypoint_grid;
pub mod limits;
pub mod orientation;
pub mod outcome;
pub mod planar_ambiguity;
pub mod ransac;
pub mod refinement;
pub mod resection;
pub mod significance;
pub mod similarity;
pub mod two_views;

use crate::domain::keyframe::{Camera, Keypoint};
use crate::domain::settings::GeometryModels;
use crate::geometry::Point3;
use crate::geometry::hamming::PackedDescriptors;
use crate::geometry::pinhole::Pinhole;
use descriptor_matching::Side;
pub use limits::{GuidedLimits, Limits, MatchingLimits, SamplingLimits, SureLimits};
pub use outcome::{Failure, Model, Status, Verification};
pub use similarity::verify;
use two_views::verify_two_views;

/// A keyframe as the verification sees it. The lists run in parallel.
#[derive(Clone, Copy, Debug)]
pub struct View<'a> {
    /// Its camera.
    pub camera: Camera,
    /// Where its features are.
    pub keypoints: &'a [Keypoint],
    /// Their descriptors.
    pub descriptors: &'a PackedDescriptors,
    /// The vocabulary's node of each, [`descriptor_matching::NO_NODE`] for none; `None` without a vocabulary.
    pub nodes: Option<&'a [u32]>,
    /// The map point of each in this keyframe's camera frame, in metres, if it has one with a position.
    pub points_in_camera: &'a [Option<Point3>],
}

impl View<'_> {
    fn pinhole(&self) -> Pinhole {
        let Camera { fx, fy, cx, cy, .. } = self.camera;
        Pinhole { fx, fy, cx, cy }
    }

    /// Returns the features that have a position.
    fn located(&self) -> Vec<u32> {
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
    /// Where it is in the candidate's camera frame, in metres.
    pub point_in_camera: Point3,
    /// Its descriptor.
    pub descriptor: &'a [u64],
}

/// Verifies one candidate by the first model that can run: a similarity where enough map points are known on both sides,
/// else, if [`Limits::models`] has it so, the images alone. The same values give the same bits, on any thread.
pub fn verify_by_any_model(
    query: &View,
    candidate: &View,
    window: &[Landmark],
    limits: &Limits,
    seed: u64,
) -> Verification {
    let is_triangulated = |view: &View| view.located().len() >= limits.min_matches as usize;
    let by_points = if is_triangulated(query) && is_triangulated(candidate) {
        verify(query, candidate, window, limits, seed)
    } else {
        Verification::skipped(Model::similarity(limits), Failure::TooFewPoints { limit: limits.min_matches })
    };
    if by_points.status != Status::Skipped || limits.models == GeometryModels::Sim3 {
        return by_points;
    }
    verify_two_views(query, candidate, limits, seed)
}

fn side<'a>(view: &View<'a>, features: &'a [u32]) -> Side<'a> {
    Side { descriptors: view.descriptors, keypoints: view.keypoints, nodes: view.nodes, features }
}

#[cfg(test)]
mod tests;
