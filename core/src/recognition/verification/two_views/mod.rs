//! Two images of points that nobody has triangulated yet (monocular, before scale): three models, and the choice among them.
//!
//! | the camera | explained by | file |
//! |---|---|---|
//! | moved, in a scene with depth | an essential matrix | [`essential`], [`eight_points`] |
//! | moved before a flat or far scene | a homography | [`homography`], [`decomposition`] |
//! | only turned, as far as can be told | a rotation | [`rotation`] |
//! | how each is looked for | RANSAC, refined | [`mod@consensus`] |
//!
//! **The rule.** All three are looked for, and scored as ORB-SLAM's initialiser does (R. Mur-Artal, J. M. M. Montiel,
//! J. D. Tardos, T-RO 2015, section IV): a match adds, for each image, what its squared error lacks of the limit. The
//! simplest model is preferred that explains nearly as much as each more general one: the rotation if `S_R / (S_R + S_H)`
//! and `S_R / (S_R + S_E)` exceed [`MIN_RATIO`], else the homography if `S_H / (S_H + S_E)` does, else the essential matrix.
//! The others follow; the first that is neither degenerate nor explained by chance verifies the candidate. If none does, the
//! first one's failure is told.

pub mod consensus;
pub mod decomposition;
mod eight_points;
pub mod essential;
pub mod homography;
pub mod pairs;
pub mod rotation;
#[cfg(test)]
mod tests;

use std::cell::OnceCell;

use super::descriptor_matching::match_descriptors;
use super::limits::Limits;
use super::outcome::{Failure, Model, Verification};
use super::significance;
use super::{View, side};
use crate::domain::settings::GeometryAcceptance;
use crate::geometry::Sim3;
use consensus::{Consensus, ImageModel, consensus};
use essential::Essential;
use homography::Homography;
use pairs::TwoViews;
use rotation::Rotation;

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
        |simpler: f64| is_preferred(simpler, views.highest_score()) || is_preferred(simpler, deep().score);
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

/// A model at the end.
pub struct Settled {
    /// Returns the transformation it leaves, its translation's length being 1, or 0 where nothing is known of it.
    pub candidate_from_query: Option<Sim3>,
    /// The inliers that its geometry allows, such as those before both cameras.
    pub inliers: Vec<usize>,
    /// Why it says nothing, if it does.
    pub end: Result<(), Failure>,
}
