//! The matches of two images as pairs of rays, with what each keypoint scatters by.

use nalgebra::Vector3;

use super::super::descriptor_match::Match;
use super::super::limits::Limits;
use super::super::view::View;

/// A feature as one camera sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sighting {
    /// Its direction, `z = 1`.
    pub ray: Vector3<f64>,
    /// Its place in the image, in pixels.
    pub pixel: [f64; 2],
    /// The standard deviation of its position, in pixels.
    pub sigma_px: f64,
}

/// Two features that match.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayPair {
    /// As the query's camera sees it.
    pub query: Sighting,
    /// As the candidate's camera sees it.
    pub candidate: Sighting,
    /// The number of bits in which the descriptors differ.
    pub distance: u32,
}

/// The matches of two images.
#[derive(Clone, Debug, PartialEq)]
pub struct TwoViews {
    /// The matches.
    pub pairs: Vec<RayPair>,
    /// The query's focal lengths, in pixels.
    pub query_focal_px: [f64; 2],
    /// The candidate's focal lengths, in pixels.
    pub candidate_focal_px: [f64; 2],
}

impl TwoViews {
    /// Makes rays of the matches.
    pub fn of(query: &View, candidate: &View, matches: &[Match], limits: &Limits) -> Self {
        let pair = |found: &Match| RayPair {
            query: sighting(query, found.query, limits),
            candidate: sighting(candidate, found.candidate, limits),
            distance: found.distance,
        };
        let focal_px = |view: &View| [view.camera.fx, view.camera.fy];
        Self {
            pairs: matches.iter().map(pair).collect(),
            query_focal_px: focal_px(query),
            candidate_focal_px: focal_px(candidate),
        }
    }
}

fn sighting(view: &View, feature: u32, limits: &Limits) -> Sighting {
    let (camera, keypoint) = (view.camera, view.keypoints[feature as usize]);
    Sighting {
        ray: Vector3::new((keypoint.u - camera.cx) / camera.fx, (keypoint.v - camera.cy) / camera.fy, 1.0),
        pixel: [keypoint.u, keypoint.v],
        sigma_px: limits.keypoint_sigma_px(keypoint.octave),
    }
}
