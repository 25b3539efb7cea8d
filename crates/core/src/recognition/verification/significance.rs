//! Significance: how often chance would explain as many matches as a model does (*a contrario*).
//!
//! A. Desolneux, L. Moisan, J.-M. Morel, "Meaningful alignments", IJCV 40 (2000); L. Moisan, B. Stival, "A probabilistic
//! criterion to detect rigid point matches between two images", IJCV 57 (2004). Under the background model each match lies
//! anywhere, uniformly and independently, in the part of the image that the matches span. The *number of false alarms* is
//! how many of all models that samples of the matches give would then be expected to explain as many of the others:
//!
//! `NFA = C(n, s) * P(Bin(n - s, p) >= k - s)`
//!
//! for k inliers among n matches, samples of s, and the chance p that a match agrees with a model by accident. It grows with
//! neither the camera's resolution nor the number of features, and never with the inliers. Logarithms are `libm`'s: they
//! are the same on every platform.
//!
//! Features are not independent: one corner is found in several octaves, and patches overlap. So of matches whose features
//! fall into one cell of [`CELL_PX`] in either image, only the one of the nearest descriptors counts.

use std::collections::HashSet;
use std::f64::consts::LN_10;

use foldhash::fast::RandomState;

use super::outcome::Failure;

/// Features this near show one thing, in pixels: half the width of ORB's patch (31 pixels at octave 0).
pub(in crate::recognition) const CELL_PX: f64 = 16.0;

/// Cells are counted from this far outside the image, in cells: keypoints may lie outside.
const CELLS_MAX: f64 = 1e6;

/// A match of two features, and whether the model explains it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImageMatch {
    /// Its places in the query's and the candidate's image, in pixels.
    pub pixels: [[f64; 2]; 2],
    /// The area of each image in which the feature would agree with a model, in square pixels.
    pub agreeing_area_px2: [f64; 2],
    /// The number of bits in which the descriptors differ.
    pub distance: u32,
    /// Whether the model explains it.
    pub is_inlier: bool,
}

/// The evidence for a model of the distinct ones among some matches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Evidence {
    /// Distinct matches.
    pub matches: u32,
    /// Those that the model explains.
    pub inliers: u32,
    /// The number of matches that define a model.
    pub sample: u32,
    /// The chance that a match agrees with a model by accident.
    pub chance: f64,
}

impl Evidence {
    /// Returns the decimal logarithm of the number of false alarms, at most 0.
    pub fn log10_false_alarms(&self) -> f64 {
        log10_false_alarms(self.matches, self.inliers, self.sample, self.chance)
    }

    /// Returns the fewest inliers among as many matches that reach the level; none if all do not.
    pub fn least_inliers(&self, max_log10: f64) -> Option<u32> {
        let reaches =
            |inliers: u32| log10_false_alarms(self.matches, inliers, self.sample, self.chance) <= max_log10;
        if !reaches(self.matches) {
            return None;
        }
        // Significance only grows with the inliers.
        let (mut below, mut reached) = (0, self.matches);
        while reached - below > 1 {
            let middle = below.midpoint(reached);
            if reaches(middle) { reached = middle } else { below = middle }
        }
        Some(reached)
    }

    /// Accepts what chance explains no more often than the level says.
    pub fn accept(&self, max_log10: f64) -> Result<(), Failure> {
        if self.log10_false_alarms() <= max_log10 {
            return Ok(());
        }
        // Where even all of them are too few, one more than there are.
        let limit = self.least_inliers(max_log10).unwrap_or(self.matches + 1);
        Err(Failure::TooFewInliers { inliers: self.inliers, limit })
    }
}

/// Weighs the matches against chance, for a model that `sample` of them define.
pub fn weigh(matches: &[ImageMatch], sample: u32) -> Evidence {
    let distinct = distinct(matches);
    let inliers = distinct.iter().filter(|found| found.is_inlier).count() as u32;
    // The sum of unequal chances has no heavier tail than as many equal ones of the same mean (W. Hoeffding, 1956).
    let chance_of = |image: usize| {
        let area_px2 = spanned_area_px2(&distinct, image);
        let chance = |found: &&ImageMatch| (found.agreeing_area_px2[image] / area_px2).clamp(0.0, 1.0);
        distinct.iter().map(chance).sum::<f64>() / distinct.len().max(1) as f64
    };
    let chance = chance_of(0).max(chance_of(1));
    // Nothing is spanned by one point: a chance that is no number is 1.
    let chance = if chance.is_finite() { chance } else { 1.0 };
    Evidence { matches: distinct.len() as u32, inliers, sample, chance }
}

/// Keeps one match of each cell of either image: the one of the nearest descriptors, then the first.
fn distinct(matches: &[ImageMatch]) -> Vec<&ImageMatch> {
    let mut order: Vec<usize> = (0..matches.len()).collect();
    order.sort_by_key(|place| (matches[*place].distance, *place));
    let cell = |pixel: [f64; 2]| pixel.map(|at| (at / CELL_PX).floor().clamp(-CELLS_MAX, CELLS_MAX) as i64);
    let taken = || HashSet::<_, RandomState>::with_capacity_and_hasher(matches.len(), RandomState::default());
    let (mut of_query, mut of_candidate) = (taken(), taken());
    let mut kept = Vec::new();
    for place in order {
        let found = &matches[place];
        let cells = found.pixels.map(cell);
        if !of_query.contains(&cells[0]) && !of_candidate.contains(&cells[1]) {
            of_query.insert(cells[0]);
            of_candidate.insert(cells[1]);
            kept.push(found);
        }
    }
    kept
}

/// Returns the area of the upright rectangle that the matches span in an image, in square pixels.
fn spanned_area_px2(matches: &[&ImageMatch], image: usize) -> f64 {
    let side_px = |axis: usize| {
        let at = || matches.iter().map(|found| found.pixels[image][axis]);
        at().fold(f64::NEG_INFINITY, f64::max) - at().fold(f64::INFINITY, f64::min)
    };
    side_px(0) * side_px(1)
}

/// Returns the decimal logarithm of the number of false alarms, at most 0 (more than one of them proves nothing, either).
pub fn log10_false_alarms(matches: u32, inliers: u32, sample: u32, chance: f64) -> f64 {
    if inliers <= sample || inliers > matches {
        return 0.0;
    }
    let tail = ln_binomial_tail(matches - sample, inliers - sample, chance);
    ((ln_choose(matches, sample) + tail) / LN_10).min(0.0)
}

/// Returns the natural logarithm of the chance that at least `least` of `count` events happen, each with a chance `p`.
fn ln_binomial_tail(count: u32, least: u32, p: f64) -> f64 {
    if least == 0 || p >= 1.0 {
        return 0.0;
    }
    if p <= 0.0 {
        return f64::NEG_INFINITY;
    }
    let odds = p / (1.0 - p);
    let first = ln_choose(count, least)
        + f64::from(least) * libm::log(p)
        + f64::from(count - least) * libm::log1p(-p);
    // The terms in units of the first.
    let (mut term, mut sum) = (1.0, 1.0);
    for i in least..count {
        term *= f64::from(count - i) / f64::from(i + 1) * odds;
        sum += term;
    }
    (first + libm::log(sum)).min(0.0)
}

/// Returns the natural logarithm of the number of ways to choose `chosen` of `count`.
fn ln_choose(count: u32, chosen: u32) -> f64 {
    let ln_factorial = |n: u32| libm::lgamma(f64::from(n) + 1.0);
    ln_factorial(count) - ln_factorial(chosen) - ln_factorial(count - chosen)
}

#[cfg(test)]
mod tests;
