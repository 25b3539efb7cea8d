//! Refinement: the transformation that fits the found points best, and the number of points that fit it.

use super::projection::{Found, Image};
use super::window::WindowPoint;
use crate::geometry::{Point3, Pose, Sim3};
use crate::hotel::sensing::camera::PINHOLE;
use crate::hotel::sensing::sensor::OCTAVE_FACTOR;
use crate::recognition::verification::correspondence::{Cameras, Correspondence, Hypothesis, Reprojection};
use crate::recognition::verification::refinement::refine;

/// Maximum squared error of a fitting point in either image, in units of a keypoint's variance.
const MAX_CHI_SQUARE: f64 = 10.0;

/// A refined transformation and the number of fitting points.
#[derive(Clone, Copy, Debug)]
pub struct Refined {
    /// The pose of the query in the candidate's camera frame.
    pub candidate_from_query: Pose,
    /// The number of points that fit it in both images.
    pub inliers: usize,
}

/// Refines `candidate_from_query` on the found points; the scale stays 1, as with a depth camera. `query_points` are
/// the query's own map points in its camera frame, one for each feature.
pub fn refined(
    candidate_from_query: &Pose,
    image: &Image<'_>,
    query_points: &[Point3],
    window: &[WindowPoint],
    found: &[Found],
) -> Option<Refined> {
    let cameras = Cameras { query: PINHOLE, candidate: PINHOLE };
    let pairs: Vec<Correspondence> = found
        .iter()
        .filter_map(|found| {
            let (keypoint, point) = (image.features()[found.feature].keypoint, &window[found.point]);
            // Points behind the candidate are seen only by its neighbours, and give no residual in its image.
            let in_candidate = PINHOLE.project(&point.in_candidate.coords)?;
            let into = |point: &Point3, pixel, octave| Reprojection {
                point: point.coords,
                pixel,
                inverse_variance: OCTAVE_FACTOR.powi(-2 * i32::from(octave)),
                depth: None,
            };
            Some(Correspondence {
                into_query: Some(into(&point.in_candidate, [keypoint.u, keypoint.v], keypoint.octave)),
                into_candidate: Some(into(&query_points[found.feature], in_candidate, point.octave)),
                distance: found.distance,
                query_feature: found.feature as u32,
                candidate_feature: None,
            })
        })
        .collect();
    let (translation_m, rotation) =
        (candidate_from_query.translation_m(), candidate_from_query.rotation_xyzw());
    let first = Sim3::new(1.0, translation_m, rotation)?;
    let everything: Vec<u32> = (0..pairs.len() as u32).collect();
    let fitting = |sim3: &Sim3| Hypothesis::new(&cameras, sim3).inliers(&pairs, MAX_CHI_SQUARE);
    let on_all = refine(&first, &pairs, &everything, &cameras, true);
    let on_those_that_fit = refine(&on_all, &pairs, &fitting(&on_all), &cameras, true);
    Some(Refined {
        candidate_from_query: Pose::new(
            on_those_that_fit.translation_m(),
            on_those_that_fit.rotation_xyzw(),
        )?,
        inliers: fitting(&on_those_that_fit).len(),
    })
}
