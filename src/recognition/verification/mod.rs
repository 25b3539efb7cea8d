//! §V, the last step: the similarity transformation between two keyframes, and how many features match under it.
//!
//! | step | file |
//! |---|---|
//! | match descriptors | [`descriptor_matching`], [`orientation`] |
//! | find a transformation most of them agree with | [`ransac`], [`correspondence`] |
//! | refine it on the reprojection errors | [`refinement`] |
//! | a flat patch may be tilted the other way | [`planar_ambiguity`] |
//! | project, match again, count | [`guided_search`], [`keypoint_grid`] |
//! | where nothing is triangulated: directions alone | [`essential`] |
//! | the thresholds | [`limits`] |
//!
//! The steps are those of ORB-SLAM3's loop detection (C. Campos et al., T-RO 2021). Unlike there, a point must lie in
//! front of both cameras, thresholds are not truncated to integers, degenerate samples are refused, random numbers come
//! from a seed, and points that only the neighbours of the candidate saw count.

pub mod correspondence;
pub mod descriptor_matching;
pub mod essential;
pub mod guided_search;
pub mod keypoint_grid;
pub mod limits;
pub mod orientation;
pub mod planar_ambiguity;
pub mod ransac;
pub mod refinement;

use thiserror::Error;

use crate::geometry::hamming::PackedDescriptors;
use crate::geometry::pinhole::Pinhole;
use crate::geometry::{Point3, Sim3};
use crate::model::keyframe::{Camera, Keypoint};
use correspondence::{Cameras, Correspondence, Hypothesis, Reprojection};
use descriptor_matching::{Match, Side, match_descriptors};
use guided_search::{GuidedSearch, sighting};
pub use limits::{GuidedLimits, Limits, MatchingLimits, SamplingLimits, SureLimits};
use planar_ambiguity::better_tilted;
use ransac::sample_consensus;
use refinement::refine;

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

    /// The features that have a position.
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

/// What the transformation was looked for with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Model {
    /// A similarity from points with positions on both sides.
    Sim3,
    /// An essential matrix from directions alone: the translation's length is unknown, and reported as 1.
    Essential,
}

impl Model {
    /// The model's name in the contract.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Sim3 => "sim3",
            Self::Essential => "essential",
        }
    }
}

/// Is the candidate the query's place?
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// A transformation explains enough features.
    Verified,
    /// None does.
    Failed,
}

/// Why a candidate failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum Failure {
    /// The descriptors of the two keyframes have different lengths.
    #[error("descriptors of {query} and {candidate} bits cannot be compared")]
    DescriptorLengths {
        /// The query's, in bits.
        query: u32,
        /// The candidate's.
        candidate: u32,
    },
    /// Too few descriptors match between points with positions.
    #[error("{matches} matches between points with positions, of {limit} needed")]
    TooFewMatches {
        /// How many match.
        matches: u32,
        /// `Limits::min_matches`.
        limit: u32,
    },
    /// No sample gave a transformation.
    #[error("none of {hypotheses} samples gave a transformation, {degenerate} of them being degenerate")]
    NoHypothesis {
        /// Samples drawn.
        hypotheses: u32,
        /// Those too small, on a line, or of two shapes.
        degenerate: u32,
    },
    /// The best transformation explains too few features.
    #[error("{inliers} inliers, of {limit} needed")]
    TooFewInliers {
        /// How many it explains.
        inliers: u32,
        /// `Limits::min_inliers`.
        limit: u32,
    },
    /// The camera has only turned, as far as can be told.
    #[error("{millidegrees} thousandths of a degree of parallax, of {limit} needed")]
    TooLittleParallax {
        /// The median angle left after the best rotation, in thousandths of a degree.
        millidegrees: u32,
        /// The least that tells.
        limit: u32,
    },
    /// Too few of the features it explains are beyond doubt.
    #[error("{sure} inliers have a position on both sides and near descriptors, of {limit} needed")]
    TooFewSureInliers {
        /// How many are.
        sure: u32,
        /// [`Limits::min_sure_inliers`].
        limit: u32,
    },
}

/// The answer, with the evidence.
#[derive(Clone, Debug, PartialEq)]
pub struct Verification {
    /// The answer.
    pub status: Status,
    /// What was looked for.
    pub model: Model,
    /// Descriptor matches between points with positions on both sides.
    pub matches: u32,
    /// Samples that RANSAC drew.
    pub hypotheses: u32,
    /// The matches that the best hypothesis explains, once refined.
    pub matched_inliers: u32,
    /// Features of the query matched after the guided search, with the candidate's features and the window's landmarks.
    pub projected_matches: u32,
    /// Those matched with features of the candidate itself that the final transformation explains.
    pub inliers: u32,
    /// The inliers beyond doubt ([`SureLimits`]).
    pub sure_inliers: u32,
    /// The mean reprojection error of all that the transformation explains, over both images, in pixels.
    pub mean_reprojection_error_px: Option<f64>,
    /// The best transformation, also when the candidate failed for its few inliers: maps points of the query's camera
    /// frame into the candidate's.
    pub candidate_from_query: Option<Sim3>,
    /// Why the candidate failed.
    pub failure: Option<Failure>,
}

impl Verification {
    /// Before anything was looked at.
    fn started(model: Model) -> Self {
        Self {
            status: Status::Failed,
            model,
            matches: 0,
            hypotheses: 0,
            matched_inliers: 0,
            projected_matches: 0,
            inliers: 0,
            sure_inliers: 0,
            mean_reprojection_error_px: None,
            candidate_from_query: None,
            failure: None,
        }
    }
}

/// Verifies one candidate. The same values give the same bits, on any thread.
pub fn verify(
    query: &View,
    candidate: &View,
    window: &[Landmark],
    limits: &Limits,
    seed: u64,
) -> Verification {
    let mut result = Verification::started(Model::Sim3);

    match find_transformation(query, candidate, window, limits, seed, &mut result) {
        Ok(()) => result.status = Status::Verified,
        Err(failure) => result.failure = Some(failure),
    }
    result
}

fn find_transformation(
    query: &View,
    candidate: &View,
    window: &[Landmark],
    limits: &Limits,
    seed: u64,
    result: &mut Verification,
) -> Result<(), Failure> {
    let cameras = Cameras { query: query.pinhole(), candidate: candidate.pinhole() };
    let matched = match_located(query, candidate, limits)?;
    result.matches = matched.len() as u32;
    if result.matches < limits.min_matches {
        return Err(Failure::TooFewMatches { matches: result.matches, limit: limits.min_matches });
    }

    let sampled = sample_consensus(&matched, &cameras, limits, seed);
    result.hypotheses = sampled.hypotheses;
    let Some((first, agreeing)) = sampled.best else {
        let (hypotheses, degenerate) = (sampled.hypotheses, sampled.degenerate);
        return Err(Failure::NoHypothesis { hypotheses, degenerate });
    };
    let mut candidate_from_query = settle(first, &matched, agreeing, &cameras, limits);
    let agreeing = Hypothesis::new(&cameras, &candidate_from_query).inliers(&matched, limits.max_chi_square);
    if let Some(tilted) =
        better_tilted(&candidate_from_query, &matched, &agreeing, &cameras, limits.fixed_scale)
    {
        candidate_from_query = settle(tilted, &matched, agreeing, &cameras, limits);
    }
    let hypothesis = Hypothesis::new(&cameras, &candidate_from_query);
    result.matched_inliers = hypothesis.inliers(&matched, limits.max_chi_square).len() as u32;

    let search = GuidedSearch::new(query, candidate, window, limits);
    let mut pairs = Vec::new();
    for _ in 0..limits.guided.rounds {
        let hypothesis = Hypothesis::new(&cameras, &candidate_from_query);
        pairs = search.search(&hypothesis, hypothesis.explained(&matched, limits.max_chi_square));
        let agreeing = hypothesis.inliers(&pairs, limits.max_chi_square);
        candidate_from_query = settle(candidate_from_query, &pairs, agreeing, &cameras, limits);
    }
    result.projected_matches = pairs.len() as u32;

    let hypothesis = Hypothesis::new(&cameras, &candidate_from_query);
    let explained: Vec<Correspondence> = hypothesis.explained(&pairs, limits.max_chi_square);
    let max_sure_distance = limits.sure.max_distance * f64::from(query.descriptors.bits());
    let is_sure = |pair: &&Correspondence| pair.is_located() && f64::from(pair.distance) <= max_sure_distance;
    result.inliers = explained.iter().filter(|pair| pair.candidate_feature.is_some()).count() as u32;
    result.sure_inliers = explained.iter().filter(is_sure).count() as u32;
    result.mean_reprojection_error_px = mean_error_px(&hypothesis, &explained);
    result.candidate_from_query = Some(candidate_from_query);
    let (limit, sure_limit) = (limits.min_inliers, limits.min_sure_inliers(result.matches));
    if result.inliers < limit {
        return Err(Failure::TooFewInliers { inliers: result.inliers, limit });
    }
    if result.sure_inliers < sure_limit {
        return Err(Failure::TooFewSureInliers { sure: result.sure_inliers, limit: sure_limit });
    }
    Ok(())
}

/// Matches the features that have a position.
fn match_located(query: &View, candidate: &View, limits: &Limits) -> Result<Vec<Correspondence>, Failure> {
    let (of_query, of_candidate) = (query.located(), candidate.located());
    let bits = (query.descriptors.bits(), candidate.descriptors.bits());
    if bits.0 != bits.1 && !of_query.is_empty() && !of_candidate.is_empty() {
        return Err(Failure::DescriptorLengths { query: bits.0, candidate: bits.1 });
    }
    let matches =
        match_descriptors(&side(query, &of_query), &side(candidate, &of_candidate), &limits.matching);
    let reprojection = |from: &View, feature: u32, into: &View, seen: u32| {
        let point = from.points_in_camera[feature as usize]?.coords;
        let (pixel, inverse_variance) = sighting(into, seen as usize, limits);
        let depth = into.points_in_camera[seen as usize].and_then(|point| limits.depth(point.z));
        Some(Reprojection { point, pixel, inverse_variance, depth })
    };
    let pair = |found: &Match| Correspondence {
        into_query: reprojection(candidate, found.candidate, query, found.query),
        into_candidate: reprojection(query, found.query, candidate, found.candidate),
        distance: found.distance,
        query_feature: found.query,
        candidate_feature: Some(found.candidate),
    };
    Ok(matches.iter().map(pair).collect())
}

fn side<'a>(view: &View<'a>, features: &'a [u32]) -> Side<'a> {
    Side { descriptors: view.descriptors, keypoints: view.keypoints, nodes: view.nodes, features }
}

/// Refines on the inliers and takes the inliers again, until they stay.
fn settle(
    first: Sim3,
    pairs: &[Correspondence],
    mut inliers: Vec<u32>,
    cameras: &Cameras,
    limits: &Limits,
) -> Sim3 {
    /// Rounds at most; two or three are the rule.
    const ROUNDS: u32 = 5;
    let mut best = first;
    for _ in 0..ROUNDS {
        if inliers.len() < 3 {
            break;
        }
        best = refine(&best, pairs, &inliers, cameras, limits.fixed_scale);
        let next = Hypothesis::new(cameras, &best).inliers(pairs, limits.max_chi_square);
        if next == inliers {
            break;
        }
        inliers = next;
    }
    best
}

fn mean_error_px(hypothesis: &Hypothesis, pairs: &[Correspondence]) -> Option<f64> {
    let errors = pairs.iter().map(|pair| hypothesis.error_px(pair));
    let (sum, images) = errors.fold((0.0, 0), |(sum, count), (error, images)| (sum + error, count + images));
    (images > 0).then(|| sum / f64::from(images))
}

#[cfg(test)]
mod tests;
