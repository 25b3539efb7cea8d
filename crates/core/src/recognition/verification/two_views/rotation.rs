//! A camera that only turned: three unknowns, which two pairs of rays determine.
//!
//! The rotation is that of absolute orientation on unit vectors (W. Kabsch, 1976; B. K. P. Horn, 1987). Its error is taken
//! in both images in pixels, where it sends a ray, so that it compares with a homography's.

use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use super::super::outcome::Model;
use super::consensus::SCORE_CHI_SQUARE;
use super::homography::transfer_chi_squares;
use super::image_model::{Agreement, ImageModel, Settled};
use super::pairs::{RayPair, TwoViews};
use crate::geometry::Sim3;
use crate::geometry::absolute_orientation::best_rotation;

/// The sine of the least angle between the two rays of a sample, about two degrees: nearer ones leave the roll open.
pub(in crate::recognition) const MIN_SINE: f64 = 0.035;

/// A rotation between two cameras.
#[derive(Clone, Copy, Debug)]
pub struct Rotation {
    candidate_from_query: UnitQuaternion<f64>,
    matrix: Matrix3<f64>,
    inverse: Matrix3<f64>,
}

impl Rotation {
    /// Fits a rotation to pairs of rays, each as heavy as it is sharp.
    pub fn fit(pairs: impl Iterator<Item = RayPair>) -> Option<Self> {
        let cross: Matrix3<f64> = pairs
            .map(|pair| {
                let weight = (pair.query.sigma_px * pair.candidate.sigma_px).recip();
                pair.query.ray.normalize() * pair.candidate.ray.normalize().transpose() * weight
            })
            .sum();
        let scale = cross.norm();
        if !scale.is_finite() || scale <= 0.0 {
            return None;
        }
        let candidate_from_query = best_rotation(&(cross / scale)).ok()?;
        let matrix = candidate_from_query.to_rotation_matrix().into_inner();
        Some(Self { candidate_from_query, matrix, inverse: matrix.transpose() })
    }

    /// Returns where it turns a direction of the query's frame.
    pub fn turn(&self, ray_in_query: &Vector3<f64>) -> Vector3<f64> {
        self.matrix * ray_in_query
    }
}

impl ImageModel for Rotation {
    const MODEL: Model = Model::Rotation;
    const SAMPLE: usize = 2;
    /// Half of the matches being false, 17 do; with nine of ten false, 459.
    const MAX_SAMPLES: u32 = 500;
    const MAX_CHI_SQUARE: f64 = SCORE_CHI_SQUARE;
    const AGREEMENT: Agreement = Agreement::AtPoint;

    fn of_sample(views: &TwoViews, places: &[usize]) -> Option<Self> {
        let [first, second] = [&views.pairs[places[0]], &views.pairs[places[1]]];
        let sine = |a: &Vector3<f64>, b: &Vector3<f64>| a.normalize().cross(&b.normalize()).norm();
        let is_wide = sine(&first.query.ray, &second.query.ray) > MIN_SINE
            && sine(&first.candidate.ray, &second.candidate.ray) > MIN_SINE;
        if !is_wide {
            return None;
        }
        Self::fit(places.iter().map(|place| views.pairs[*place]))
    }

    fn refined(&self, views: &TwoViews, inliers: &[usize]) -> Option<Self> {
        if inliers.len() < Self::SAMPLE {
            return None;
        }
        Self::fit(inliers.iter().map(|place| views.pairs[*place]))
    }

    fn chi_squares(&self, views: &TwoViews, pair: &RayPair) -> [f64; 2] {
        transfer_chi_squares(views, pair, &self.matrix, &self.inverse)
    }

    fn settle(&self, _: &TwoViews, inliers: &[usize]) -> Settled {
        let transform = Sim3::from_parts(1.0, self.candidate_from_query, Vector3::zeros());
        Settled { candidate_from_query: Some(transform), inliers: inliers.to_vec(), end: Ok(()) }
    }
}
