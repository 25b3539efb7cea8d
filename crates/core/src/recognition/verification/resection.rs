//! Resection: where a camera stands among the points that it sees, by its own image (motion-only bundle adjustment).
//!
//! A keyframe's pose and its points need not be of one hour: poses are corrected after a loop, a point stays with the keyframe
//! that saw it first, odometry drifts between the two. Points that are off together are off in the other image, too: few
//! pairs agree with the right transformation, and a wrong one may win. The keyframe's own image knows better.

use super::correspondence::{Cameras, Correspondence, Hypothesis, Reprojection};
use super::guided_search::sighting;
use super::limits::Limits;
use super::refinement::refine;
use super::view::View;
use crate::geometry::Sim3;

/// Points that fix the six unknowns of a pose many times over.
pub const MIN_POINTS: usize = 20;

/// The median of chi-square with two degrees of freedom: where the points are off by more in their own image than keypoints
/// and points scatter ([`Limits::variance_px2`]), the pose is not theirs. Else it stays as it is.
pub const MAX_MEDIAN_CHI_SQUARE: f64 = 1.386;

/// Points of up to this many times the median squared error are refined on: of normal errors 98 %, and few outliers.
pub const REFINED_ON_MEDIANS: f64 = 6.0;

/// Rounds of choosing points and refining; the first takes all.
pub const ROUNDS: u32 = 3;

/// Returns what maps the view's points into the frame in which its camera sees them; `None` where its pose is theirs, or too
/// few points say so.
pub fn resection(view: &View, limits: &Limits) -> Option<Sim3> {
    let camera = view.pinhole();
    let cameras = Cameras { query: camera, candidate: camera };
    let own = |feature: u32| {
        let point = view.points_in_camera[feature as usize]?.coords;
        camera.project(&point)?;
        let (pixel, inverse_variance) = sighting(view, feature, limits);
        let into_candidate = Some(Reprojection { point, pixel, inverse_variance, depth: None });
        let candidate_feature = Some(feature);
        Some(Correspondence {
            into_candidate,
            query_feature: feature,
            candidate_feature,
            ..Default::default()
        })
    };
    let pairs: Vec<Correspondence> = view.located().into_iter().filter_map(own).collect();
    if pairs.len() < MIN_POINTS {
        return None;
    }
    let mut found = Sim3::identity();
    let mut errors = errors(&found, &pairs, &cameras);
    if median(&errors) <= MAX_MEDIAN_CHI_SQUARE {
        return None;
    }
    let mut places: Vec<u32> = (0..pairs.len() as u32).collect();
    for _ in 0..ROUNDS {
        found = refine(&found, &pairs, &places, &cameras, true);
        errors = self::errors(&found, &pairs, &cameras);
        let most = REFINED_ON_MEDIANS * median(&errors);
        places = (0..).zip(&errors).filter(|(_, error)| **error <= most).map(|(place, _)| place).collect();
    }
    Some(found)
}

/// Returns the squared error of each pair, in units of its variance.
fn errors(camera_from_posed: &Sim3, pairs: &[Correspondence], cameras: &Cameras) -> Vec<f64> {
    let hypothesis = Hypothesis::new(cameras, camera_from_posed);
    pairs.iter().map(|pair| hypothesis.chi_square(pair)).collect()
}

/// Returns the upper median of a list that is not empty.
fn median(errors: &[f64]) -> f64 {
    let mut errors = errors.to_vec();
    let middle = errors.len() / 2;
    *errors.select_nth_unstable_by(middle, f64::total_cmp).1
}
