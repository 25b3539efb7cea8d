//! The model of one kind that explains most of the matches, found among hypotheses from random samples of them.
//!
//! M. A. Fischler, R. C. Bolles, CACM 24 (1981), scored as ORB-SLAM's initialiser scores (T-RO 2015, section IV): each
//! image of a match adds what its squared error lacks of a limit, nothing beyond the model's own limit. A new best one is
//! refined on its inliers, and the best of that kept (O. Chum et al., "Locally optimized RANSAC", 2003).

use super::image_model::ImageModel;
use super::pairs::{RayPair, TwoViews};
use crate::geometry::sampling::SplitMix64;

/// What a match's squared error is held against in a score, whatever the model: the 99 % quantile of chi-square with two
/// degrees of freedom (M13; ORB-SLAM takes the 95 % quantile, 5.99).
pub const SCORE_CHI_SQUARE: f64 = 9.21;

/// Sampling stops once the chance of having missed every good sample is below this (ORB-SLAM: 1 %).
const MAX_CHANCE_OF_MISS: f64 = 0.01;

/// How many times farther off than the limit the inliers may be in each round of refining a new best hypothesis: it comes
/// from few noisy points. The factors are of squared errors.
const LOCAL_TOLERANCES: [f64; 5] = [9.0, 4.0, 1.0, 1.0, 1.0];

/// The result of the sampling.
#[derive(Clone, Debug)]
pub struct Consensus<M> {
    /// The best model and its inliers.
    pub best: Option<(M, Vec<usize>)>,
    /// Its score; 0 without one.
    pub score: f64,
    /// The number of samples drawn.
    pub hypotheses: u32,
    /// The degenerate ones of those.
    pub degenerate: u32,
}

/// Samples the matches.
pub fn consensus<M: ImageModel>(views: &TwoViews, seed: u64) -> Consensus<M> {
    let mut found = Consensus { best: None, score: 0.0, hypotheses: 0, degenerate: 0 };
    let count = views.pairs.len();
    if count < M::SAMPLE {
        return found;
    }
    let mut random = SplitMix64::new(seed);
    let (mut best, mut needed) = (None, M::MAX_SAMPLES);
    while found.hypotheses < needed {
        found.hypotheses += 1;
        let Some(drawn) = M::of_sample(views, &sample(&mut random, M::SAMPLE, count)) else {
            found.degenerate += 1;
            continue;
        };
        let drawn_score = score(views, &drawn);
        if drawn_score <= found.score {
            continue;
        }
        let (refined, refined_score) = optimised(views, drawn, drawn_score);
        (best, found.score) = (Some(refined), refined_score);
        let inlier_share = views.inliers(&refined).len() as f64 / count as f64;
        needed = needed.min(samples_needed(inlier_share, M::SAMPLE, M::MAX_SAMPLES));
    }
    found.best = best.map(|model| (model, views.inliers(&model)));
    found
}

/// Draws different places.
fn sample(random: &mut SplitMix64, size: usize, count: usize) -> Vec<usize> {
    let mut chosen = Vec::with_capacity(size);
    while chosen.len() < size {
        let next = random.below(count);
        if !chosen.contains(&next) {
            chosen.push(next);
        }
    }
    chosen
}

/// Refines a new best model in rounds of narrowing tolerance, and takes the best of them.
fn optimised<M: ImageModel>(views: &TwoViews, first: M, first_score: f64) -> (M, f64) {
    let (mut best, mut best_score, mut last) = (first, first_score, first);
    for tolerance in LOCAL_TOLERANCES {
        let Some(refined) = last.refined(views, &views.near(&last, tolerance)) else { break };
        let refined_score = score(views, &refined);
        if refined_score > best_score {
            (best, best_score) = (refined, refined_score);
        }
        last = refined;
    }
    (best, best_score)
}

/// Returns the score of a model: the sum of what the squared errors lack of the limit.
fn score<M: ImageModel>(views: &TwoViews, model: &M) -> f64 {
    let of_error = |error: f64| if error < M::MAX_CHI_SQUARE { SCORE_CHI_SQUARE - error } else { 0.0 };
    let of_pair = |pair: &RayPair| model.chi_squares(views, pair).into_iter().map(of_error).sum::<f64>();
    views.pairs.iter().map(of_pair).sum()
}

/// Returns the score of a model that explains every pair without error.
pub fn highest_score(views: &TwoViews) -> f64 {
    2.0 * SCORE_CHI_SQUARE * views.pairs.len() as f64
}

/// Returns how many samples are needed for one without an outlier.
fn samples_needed(inlier_share: f64, size: usize, most: u32) -> u32 {
    let good = (0..size).fold(1.0, |product, _| product * inlier_share);
    if good >= 1.0 {
        return 1;
    }
    // A share so small that the logarithm is 0 needs more than there are.
    let needed = libm::log(MAX_CHANCE_OF_MISS) / libm::log1p(-good);
    if needed.is_finite() { needed.ceil().min(f64::from(most)) as u32 } else { most }
}
