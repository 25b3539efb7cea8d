//! The matches that a model explains, and how well.

use std::f64::consts::PI;

use super::super::significance::ImageMatch;
use super::image_model::{Agreement, ImageModel};
use super::pairs::{RayPair, Sighting, TwoViews};

impl TwoViews {
    /// Returns the places of the pairs that a model explains in both images.
    pub fn inliers<M: ImageModel>(&self, model: &M) -> Vec<usize> {
        self.near(model, 1.0)
    }

    /// Returns the places of the pairs whose squared errors are this many times the limit at most.
    pub fn near<M: ImageModel>(&self, model: &M, tolerance: f64) -> Vec<usize> {
        let limit = M::MAX_CHI_SQUARE * tolerance;
        let is_near =
            |place: &usize| model.chi_squares(self, &self.pairs[*place]).iter().all(|error| *error < limit);
        (0..self.pairs.len()).filter(is_near).collect()
    }

    /// Returns the mean error of some pairs over both images, in pixels.
    pub fn mean_error_px<M: ImageModel>(&self, model: &M, places: &[usize]) -> Option<f64> {
        let errors_px = places.iter().flat_map(|place| {
            let pair = &self.pairs[*place];
            let [in_query, in_candidate] = model.chi_squares(self, pair);
            [in_query.sqrt() * pair.query.sigma_px, in_candidate.sqrt() * pair.candidate.sigma_px]
        });
        (!places.is_empty()).then(|| errors_px.sum::<f64>() / (2.0 * places.len() as f64))
    }

    /// Returns the matches as significance weighs them, those at `inliers` being explained.
    pub fn matches_for<M: ImageModel>(&self, _: &M, inliers: &[usize]) -> Vec<ImageMatch> {
        let diagonals_px = [self.diagonal_px(|pair| pair.query), self.diagonal_px(|pair| pair.candidate)];
        let area_px2 = |sighting: &Sighting, diagonal_px: f64| {
            let radius_px = M::MAX_CHI_SQUARE.sqrt() * sighting.sigma_px;
            match M::AGREEMENT {
                Agreement::AtPoint => PI * radius_px * radius_px,
                // A strip about a line through the image.
                Agreement::AlongLine => 2.0 * radius_px * diagonal_px,
            }
        };
        let mut matches: Vec<ImageMatch> = (self.pairs.iter())
            .map(|pair| ImageMatch {
                pixels: [pair.query.pixel, pair.candidate.pixel],
                agreeing_area_px2: [
                    area_px2(&pair.query, diagonals_px[0]),
                    area_px2(&pair.candidate, diagonals_px[1]),
                ],
                distance: pair.distance,
                is_inlier: false,
            })
            .collect();
        for place in inliers {
            matches[*place].is_inlier = true;
        }
        matches
    }

    /// Returns the diagonal of the upright rectangle that the matches span in an image, in pixels.
    fn diagonal_px(&self, of: impl Fn(&RayPair) -> Sighting) -> f64 {
        let side_px = |axis: usize| {
            let at = || self.pairs.iter().map(|pair| of(pair).pixel[axis]);
            at().fold(f64::NEG_INFINITY, f64::max) - at().fold(f64::INFINITY, f64::min)
        };
        let (width_px, height_px) = (side_px(0), side_px(1));
        (width_px * width_px + height_px * height_px).sqrt()
    }
}
