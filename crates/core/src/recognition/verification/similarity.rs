//! The similarity between points with positions on both sides, as ORB-SLAM3's loop detection finds it.

use super::correspondence::{Cameras, Correspondence, Hypothesis, Reprojection};
use super::covariance::covariance;
use super::descriptor_match::Match;
use super::descriptor_matching::match_descriptors;
use super::guided_search::{GuidedSearch, sighting};
use super::limits::Limits;
use super::outcome::{Failure, Model, Verification};
use super::planar_ambiguity::better_tilted;
use super::ransac::sample_consensus;
use super::refinement::refine;
use super::significance::{self, Evidence, ImageMatch};
use super::view::{Landmark, View, side};
use crate::domain::settings::GeometryAcceptance;
use crate::geometry::Sim3;

/// Points in a sample.
const SAMPLE: u32 = 3;

/// Verifies one candidate. The same values give the same bits, on any thread.
pub fn verify(
    query: &View,
    candidate: &View,
    window: &[Landmark],
    limits: &Limits,
    seed: u64,
) -> Verification {
    let mut result = Verification::started(Model::similarity(limits));
    let end = find_transformation(query, candidate, window, limits, seed, &mut result);
    result.concluded(end)
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
        return Err(Failure::without_hypothesis(hypotheses, degenerate));
    };
    let mut candidate_from_query = settle(first, &matched, agreeing, &cameras, limits);
    let agreeing = Hypothesis::new(&cameras, &candidate_from_query).inliers(&matched, limits.max_chi_square);
    if let Some(tilted) =
        better_tilted(&candidate_from_query, &matched, &agreeing, &cameras, limits.fixed_scale)
    {
        candidate_from_query = settle(tilted, &matched, agreeing, &cameras, limits);
    }
    let hypothesis = Hypothesis::new(&cameras, &candidate_from_query);
    let agreeing = hypothesis.inliers(&matched, limits.max_chi_square);
    result.matched_inliers = agreeing.len() as u32;
    let evidence = evidence(&matched, &agreeing, query, candidate, limits);
    result.log10_false_alarms = Some(evidence.log10_false_alarms());

    let search = GuidedSearch::new(query, candidate, window, limits);
    let mut pairs = Vec::new();
    for _ in 0..limits.guided.rounds {
        let hypothesis = Hypothesis::new(&cameras, &candidate_from_query);
        let kept = hypothesis.inliers(&matched, limits.max_chi_square);
        pairs = search.search(&hypothesis, &matched, &kept);
        let agreeing = hypothesis.inliers(&pairs, limits.max_chi_square);
        candidate_from_query = settle(candidate_from_query, &pairs, agreeing, &cameras, limits);
    }
    result.projected_matches = pairs.len() as u32;

    let hypothesis = Hypothesis::new(&cameras, &candidate_from_query);
    let explained: Vec<Correspondence> = hypothesis.explained(&pairs, limits.max_chi_square);
    let max_sure_distance = limits.sure.max_distance * f64::from(query.descriptors.bits());
    let is_sure = |pair: &&Correspondence| pair.is_located() && f64::from(pair.distance) <= max_sure_distance;
    result.explained_features = explained.iter().filter_map(|pair| pair.candidate_feature).collect();
    result.explained_features.sort_unstable();
    let own = explained.iter().filter_map(|pair| Some((pair.query_feature, pair.candidate_feature?)));
    let (in_query, in_candidate) = own.map(|(a, b)| (query.pixel(a), candidate.pixel(b))).unzip();
    result.explained_pixels = [in_query, in_candidate];
    result.inliers = result.explained_features.len() as u32;
    result.sure_inliers = explained.iter().filter(is_sure).count() as u32;
    result.mean_reprojection_error_px = mean_error_px(&hypothesis, &explained);
    result.candidate_from_query = Some(candidate_from_query);
    result.covariance = covariance(&candidate_from_query, &explained, &cameras, limits.fixed_scale);
    accept(result, &evidence, limits)
}

/// Accepts by ORB-SLAM's fixed numbers, or because chance does not explain as many inliers among the first matches. Either
/// way an eighth of the matches must be beyond doubt: a mirrored room has agreeing bands that no chance explains.
fn accept(result: &Verification, evidence: &Evidence, limits: &Limits) -> Result<(), Failure> {
    let sure = result.sure_inliers;
    let by_count = || {
        let (limit, sure_limit) = (limits.min_inliers, limits.min_sure_inliers(result.matches));
        match () {
            () if result.inliers < limit => Err(Failure::TooFewInliers { inliers: result.inliers, limit }),
            () if sure < sure_limit => Err(Failure::TooFewSureInliers { sure, limit: sure_limit }),
            () => Ok(()),
        }
    };
    let share_limit = limits.min_sure_share(result.matches);
    match limits.acceptance {
        GeometryAcceptance::Count => by_count(),
        GeometryAcceptance::Significance => by_count().or_else(|_| {
            evidence.accept(limits.max_log10_false_alarms)?;
            if sure < share_limit {
                return Err(Failure::TooFewSureInliers { sure, limit: share_limit });
            }
            Ok(())
        }),
    }
}

/// Returns what the first matches say, before the guided search: what it adds was looked for where the transformation
/// has it.
fn evidence(
    matched: &[Correspondence],
    agreeing: &[u32],
    query: &View,
    candidate: &View,
    limits: &Limits,
) -> Evidence {
    let area_px2 = |variance_px2: f64| std::f64::consts::PI * limits.max_chi_square * variance_px2;
    let variance_px2 =
        |view: &View, feature: u32| limits.variance_px2(view.keypoints[feature as usize].octave);
    let mut matches: Vec<ImageMatch> = (matched.iter())
        .filter_map(|pair| {
            let seen = pair.candidate_feature?;
            Some(ImageMatch {
                pixels: [query.pixel(pair.query_feature), candidate.pixel(seen)],
                agreeing_area_px2: [
                    area_px2(variance_px2(query, pair.query_feature)),
                    area_px2(variance_px2(candidate, seen)),
                ],
                distance: pair.distance,
                is_inlier: false,
            })
        })
        .collect();
    for place in agreeing {
        matches[*place as usize].is_inlier = true;
    }
    significance::weigh(&matches, SAMPLE)
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
        let (pixel, inverse_variance) = sighting(into, seen, limits);
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

/// Rounds of refining and taking the inliers again, at most; two or three are the rule.
pub const ROUNDS: u32 = 5;

/// Refines on the inliers and takes the inliers again, until they stay.
fn settle(
    first: Sim3,
    pairs: &[Correspondence],
    mut inliers: Vec<u32>,
    cameras: &Cameras,
    limits: &Limits,
) -> Sim3 {
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
