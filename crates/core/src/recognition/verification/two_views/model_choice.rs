//! The choice among the three models of two images.

use std::cell::OnceCell;

use super::super::descriptor_matching::match_descriptors;
use super::super::limits::Limits;
use super::super::outcome::{Failure, Model, Verification};
use super::super::significance;
use super::super::view::{View, side};
use super::consensus::{Consensus, consensus, highest_score};
use super::essential::Essential;
use super::homography::Homography;
use super::image_model::{ImageModel, Settled};
use super::pairs::TwoViews;
use super::rotation::Rotation;
use crate::domain::settings::GeometryAcceptance;

/// The simpler model is preferred if it has more than this share of the two scores (ORB-SLAM: 0.45 in the paper).
pub(in crate::recognition) const MIN_RATIO: f64 = 0.45;

/// Verifies one candidate by its image alone. The same values give the same bits.
pub fn verify_two_views(query: &View, candidate: &View, limits: &Limits, seed: u64) -> Verification {
    let mut started = Verification::started(Model::Essential);
    let bits = (query.descriptors.bits(), candidate.descriptors.bits());
    if bits.0 != bits.1 && !query.keypoints.is_empty() && !candidate.keypoints.is_empty() {
        let failure = Failure::DescriptorLengths { query: bits.0, candidate: bits.1 };
        return started.concluded(Err(failure));
    }
    let every = |view: &View| -> Vec<u32> { (0..view.keypoints.len() as u32).collect() };
    let (of_query, of_candidate) = (every(query), every(candidate));
    let matches =
        match_descriptors(&side(query, &of_query), &side(candidate, &of_candidate), &limits.matching);
    started.matches = matches.len() as u32;
    started.projected_matches = started.matches;
    let limit = limits.min_matches.max(Essential::SAMPLE as u32);
    if started.matches < limit {
        let failure = Failure::TooFewMatches { matches: started.matches, limit };
        return started.concluded(Err(failure));
    }
    let views = TwoViews::of(query, candidate, &matches, limits);
    choose(&views, &started, limits, seed)
}

/// Looks for the models, and takes the first of the preferred order that verifies.
fn choose(views: &TwoViews, started: &Verification, limits: &Limits, seed: u64) -> Verification {
    let is_preferred = |simpler: f64, other: f64| simpler > MIN_RATIO * (simpler + other);
    let rotation = consensus::<Rotation>(views, seed);
    let homography = consensus::<Homography>(views, seed);
    let turned = || judge(views, &rotation, started, limits);
    let flat = || judge(views, &homography, started, limits);
    // The essential matrix costs most, and no score is above that of a model without errors: often it need not be known.
    let deep = OnceCell::new();
    let deep = || deep.get_or_init(|| consensus::<Essential>(views, seed));
    let deep_judged = || judge(views, deep(), started, limits);
    let over_deep =
        |simpler: f64| is_preferred(simpler, highest_score(views)) || is_preferred(simpler, deep().score);
    if is_preferred(rotation.score, homography.score) && over_deep(rotation.score) {
        return first_verified([&turned, &flat, &deep_judged]);
    }
    let is_flat = over_deep(homography.score);
    if is_flat {
        first_verified([&flat, &deep_judged, &turned])
    } else {
        first_verified([&deep_judged, &flat, &turned])
    }
}

/// Returns the first that verifies, else the first.
fn first_verified(judged: [&dyn Fn() -> Verification; 3]) -> Verification {
    let [first, others @ ..] = judged;
    let first = first();
    let is_verified = |found: &Verification| found.failure.is_none();
    if is_verified(&first) {
        return first;
    }
    others.into_iter().map(|judge| judge()).find(is_verified).unwrap_or(first)
}

/// Judges the best model of one kind.
fn judge<M: ImageModel>(
    views: &TwoViews,
    found: &Consensus<M>,
    started: &Verification,
    limits: &Limits,
) -> Verification {
    let mut result = Verification { model: M::MODEL, hypotheses: found.hypotheses, ..started.clone() };
    let (hypotheses, degenerate) = (found.hypotheses, found.degenerate);
    let Some((model, inliers)) = &found.best else {
        return result.concluded(Err(Failure::without_hypothesis(hypotheses, degenerate)));
    };
    result.matched_inliers = inliers.len() as u32;
    let Settled { candidate_from_query, inliers, end } = model.settle(views, inliers);
    result.inliers = inliers.len() as u32;
    let explained = inliers.iter().map(|place| &views.pairs[*place]);
    let (in_query, in_candidate) = explained.map(|pair| (pair.query.pixel, pair.candidate.pixel)).unzip();
    result.explained_pixels = [in_query, in_candidate];
    result.candidate_from_query = candidate_from_query;
    result.mean_reprojection_error_px = views.mean_error_px(model, &inliers);
    let evidence = significance::weigh(&views.matches_for(model, &inliers), M::SAMPLE as u32);
    result.log10_false_alarms = Some(evidence.log10_false_alarms());
    let is_accepted = match limits.acceptance {
        GeometryAcceptance::Significance => evidence.accept(limits.max_log10_false_alarms),
        GeometryAcceptance::Count if result.inliers < limits.min_inliers => {
            Err(Failure::TooFewInliers { inliers: result.inliers, limit: limits.min_inliers })
        }
        GeometryAcceptance::Count => Ok(()),
    };
    result.concluded(end.and(is_accepted))
}
