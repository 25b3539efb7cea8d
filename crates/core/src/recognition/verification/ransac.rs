//! The transformation that most matches agree with, found among hypotheses from random triples of them.
//!
//! M. A. Fischler, R. C. Bolles, CACM 24 (1981), scored as MSAC (P. H. S. Torr, A. Zisserman, CVIU 78, 2000): a
//! hypothesis costs the sum of its squared errors, each counted up to the inlier limit.

use nalgebra::Vector3;

use super::correspondence::{Cameras, Correspondence, Hypothesis};
use super::limits::{Limits, SamplingLimits};
use super::refinement::refine;
use crate::geometry::absolute_orientation::{Scale, align};
use crate::geometry::sampling::{SplitMix64, chance_of_only_bad_samples};
use crate::geometry::{Point3, Sim3};

/// What the sampling found.
#[derive(Clone, Debug, PartialEq)]
pub struct Sampled {
    /// How many samples were drawn.
    pub hypotheses: u32,
    /// How many of those were refused: too small, on a line, or not of one shape on both sides.
    pub degenerate: u32,
    /// The best hypothesis and its inliers.
    pub best: Option<(Sim3, Vec<u32>)>,
}

/// Samples the pairs; those without a position on both sides are no part of it.
pub fn sample_consensus(pairs: &[Correspondence], cameras: &Cameras, limits: &Limits, seed: u64) -> Sampled {
    let sampling = &limits.sampling;
    let scale = if limits.fixed_scale { Scale::Fixed } else { Scale::Free };
    let max_chi_square = limits.max_chi_square * sampling.tolerance * sampling.tolerance;
    let points: Vec<PointPair> = pairs.iter().filter_map(PointPair::of).collect();
    let mut result = Sampled { hypotheses: 0, degenerate: 0, best: None };
    if points.len() < 3 {
        return result;
    }
    let mut random = SplitMix64::new(seed);
    let (mut best, mut least_cost, mut inlier_share) = (None, f64::INFINITY, 0.0);
    while result.hypotheses < sampling.max_hypotheses
        && chance_of_only_bad_samples(inlier_share, result.hypotheses) > sampling.max_chance_of_miss
    {
        result.hypotheses += 1;
        let sample = random.three_below(points.len()).map(|place| points[place]);
        let hypothesis = is_sound(&sample, scale, sampling).then(|| {
            align(&sample.map(|pair| (Point3::from(pair.query), Point3::from(pair.candidate))), scale)
        });
        let Some(Ok(candidate_from_query)) = hypothesis else {
            result.degenerate += 1;
            continue;
        };
        let tested = Hypothesis::new(cameras, &candidate_from_query);
        let Some((cost, count)) = cost(&tested, pairs, max_chi_square, least_cost) else { continue };
        let found = Scored { candidate_from_query, cost, inliers: count };
        let found = optimise(found, pairs, cameras, limits, max_chi_square);
        (best, least_cost) = (Some(found.candidate_from_query), found.cost);
        inlier_share = f64::from(found.inliers) / points.len() as f64;
    }
    result.best = best.map(|candidate_from_query| {
        let tested = Hypothesis::new(cameras, &candidate_from_query);
        (candidate_from_query, tested.inliers(pairs, max_chi_square))
    });
    result
}

/// A hypothesis and what it costs.
#[derive(Clone, Copy, Debug)]
struct Scored {
    candidate_from_query: Sim3,
    cost: f64,
    inliers: u32,
}

/// Returns a new best, refined on its inliers for as long as that lowers its cost (O. Chum et al., "Locally optimized
/// RANSAC", 2003): what comes out depends less on which three points it came from.
fn optimise(
    mut best: Scored,
    pairs: &[Correspondence],
    cameras: &Cameras,
    limits: &Limits,
    max: f64,
) -> Scored {
    for _ in 0..limits.sampling.local_rounds {
        let inliers = Hypothesis::new(cameras, &best.candidate_from_query).inliers(pairs, max);
        let refined = refine(&best.candidate_from_query, pairs, &inliers, cameras, limits.fixed_scale);
        let tested = Hypothesis::new(cameras, &refined);
        let Some((cost, inliers)) = cost(&tested, pairs, max, best.cost) else { break };
        best = Scored { candidate_from_query: refined, cost, inliers };
    }
    best
}

/// Returns the cost and the number of inliers, or `None` as soon as the cost is no less than `least_cost`.
fn cost(tested: &Hypothesis, pairs: &[Correspondence], max: f64, least_cost: f64) -> Option<(f64, u32)> {
    let (mut cost, mut inliers) = (0.0, 0);
    for pair in pairs {
        let chi_square = tested.chi_square(pair);
        inliers += u32::from(chi_square < max);
        cost += chi_square.min(max);
        if cost >= least_cost {
            return None;
        }
    }
    (inliers >= 3).then_some((cost, inliers))
}

/// A point as the two sides have it.
#[derive(Clone, Copy, Debug)]
struct PointPair {
    query: Vector3<f64>,
    candidate: Vector3<f64>,
}

impl PointPair {
    fn of(pair: &Correspondence) -> Option<Self> {
        Some(Self { query: pair.into_candidate?.point, candidate: pair.into_query?.point })
    }
}

/// Whether three pairs can give a transformation worth testing. Surfaces are seen from one side only: a triangle that turns
/// clockwise in one image and counter-clockwise in the other would have to be looked at from behind. Without this test a
/// wall and its mirror image match, by a turn of 180 degrees.
fn is_sound(sample: &[PointPair; 3], scale: Scale, limits: &SamplingLimits) -> bool {
    let [of_query, of_candidate] =
        [Triangle::of(sample.map(|pair| pair.query)), Triangle::of(sample.map(|pair| pair.candidate))];
    if !of_query.has_shape(limits)
        || !of_candidate.has_shape(limits)
        || of_query.volume_6 * of_candidate.volume_6 <= 0.0
    {
        return false;
    }
    let ratios: [f64; 3] = std::array::from_fn(|i| of_candidate.squared_sides[i] / of_query.squared_sides[i]);
    let (least, most) =
        ratios.iter().fold((f64::INFINITY, 0.0_f64), |(least, most), &r| (least.min(r), most.max(r)));
    let max_squared = limits.max_side_factor * limits.max_side_factor;
    match scale {
        Scale::Fixed => least * max_squared >= 1.0 && most <= max_squared,
        // The scale cancels; two of the ratios may then err in opposite directions.
        Scale::Free => most <= least * max_squared * max_squared,
    }
}

/// Three points of one side.
struct Triangle {
    squared_sides: [f64; 3],
    squared_area_2: f64,
    squared_distance: f64,
    /// Six times the volume it spans with the camera's centre; the sign says which way it turns in the image.
    volume_6: f64,
}

impl Triangle {
    fn of([a, b, c]: [Vector3<f64>; 3]) -> Self {
        let (ab, ac, bc) = (b - a, c - a, c - b);
        Self {
            squared_sides: [ab.norm_squared(), ac.norm_squared(), bc.norm_squared()],
            squared_area_2: ab.cross(&ac).norm_squared(),
            volume_6: a.dot(&b.cross(&c)),
            squared_distance: a.norm_squared().min(b.norm_squared()).min(c.norm_squared()),
        }
    }

    /// Whether it is large enough for its distance, and wide enough for its length.
    fn has_shape(&self, limits: &SamplingLimits) -> bool {
        let [a, b, c] = self.squared_sides;
        let longest = a.max(b).max(c);
        let least_height = limits.min_height * longest;
        longest > limits.min_extent * limits.min_extent * self.squared_distance
            && self.squared_area_2 > least_height * least_height
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangle(points: [[f64; 3]; 3]) -> Triangle {
        Triangle::of(points.map(Vector3::from))
    }

    #[test]
    fn triples_that_say_little_are_refused() {
        let limits = Limits::DEFAULT.sampling;
        assert!(triangle([[0.0, 0.0, 3.0], [1.0, 0.0, 3.0], [0.0, 1.0, 3.0]]).has_shape(&limits));
        assert!(
            !triangle([[0.0, 0.0, 3.0], [1.0, 0.01, 3.0], [2.0, 0.0, 3.0]]).has_shape(&limits),
            "on a line"
        );
        assert!(
            !triangle([[0.0, 0.0, 3.0], [0.05, 0.0, 3.0], [0.0, 0.05, 3.0]]).has_shape(&limits),
            "too small"
        );
        assert!(!triangle([[0.0, 0.0, 3.0]; 3]).has_shape(&limits), "one point");
    }

    #[test]
    fn triples_of_two_shapes_are_refused() {
        let limits = Limits::DEFAULT.sampling;
        let pair = |query: [f64; 3], scale: f64| PointPair {
            query: query.into(),
            candidate: Vector3::from(query) * scale,
        };
        let sample = |scales: [f64; 3]| {
            [
                pair([1.0, 0.0, 4.0], scales[0]),
                pair([-1.0, 0.0, 4.0], scales[1]),
                pair([0.0, 1.0, 4.0], scales[2]),
            ]
        };
        assert!(is_sound(&sample([1.0; 3]), Scale::Fixed, &limits));
        assert!(!is_sound(&sample([2.0; 3]), Scale::Fixed, &limits));
        assert!(is_sound(&sample([2.0; 3]), Scale::Free, &limits));
        assert!(!is_sound(&sample([1.0, 1.0, 3.0]), Scale::Free, &limits));
    }
}
