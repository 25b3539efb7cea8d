//! The interface of a relation between two images.

use super::super::outcome::{Failure, Model};
use super::pairs::{RayPair, TwoViews};
use crate::geometry::Sim3;

/// The place in the other image at which a match agrees with a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Agreement {
    /// About a point.
    AtPoint,
    /// Along a line.
    AlongLine,
}

/// A relation between two images.
pub trait ImageModel: Copy {
    /// Its name.
    const MODEL: Model;
    /// The number of matches that define it.
    const SAMPLE: usize;
    /// The most samples drawn.
    const MAX_SAMPLES: u32;
    /// The squared error, in units of the keypoint's variance, below which a match agrees in one image.
    const MAX_CHI_SQUARE: f64;
    /// The meaning of agreement.
    const AGREEMENT: Agreement;

    /// Fits the pairs at these places, [`Self::SAMPLE`] of them; none if they are degenerate.
    fn of_sample(views: &TwoViews, places: &[usize]) -> Option<Self>;

    /// Refines the model on its inliers.
    fn refined(&self, views: &TwoViews, inliers: &[usize]) -> Option<Self>;

    /// Returns the squared errors in the query's and in the candidate's image, in units of the keypoint's variance.
    fn chi_squares(&self, views: &TwoViews, pair: &RayPair) -> [f64; 2];

    /// Returns the transformation that the model leaves, and whether it says anything.
    fn settle(&self, views: &TwoViews, inliers: &[usize]) -> Settled;
}

/// A model at the end.
pub struct Settled {
    /// Returns the transformation it leaves, its translation's length being 1, or 0 where nothing is known of it.
    pub candidate_from_query: Option<Sim3>,
    /// The inliers that its geometry allows, such as those before both cameras.
    pub inliers: Vec<usize>,
    /// Why it says nothing, if it does.
    pub end: Result<(), Failure>,
}
