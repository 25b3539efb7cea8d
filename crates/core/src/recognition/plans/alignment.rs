//! Alignment: the transformation that explains the signs of a session best, announced only if it stands alone.

use nalgebra::{Vector2, Vector3};

use super::planar_fit::PlanarFit;
use super::proposals::{Proposal, Readings, proposals};
use super::signs::Signs;
use super::support::{Explained, Support, fit_pairs, support};

/// Distinctive signs that must agree.
pub(in crate::recognition) const DISTINCTIVE_MIN: usize = 2;

/// The same where some of them bear words that hang in every building, also where no plan shows them.
pub(in crate::recognition) const GENERAL_MIN: usize = 3;

/// Proposals that are refined, the best by their support.
const REFINED_MAX: usize = 12;

/// Rounds of refinement.
const ROUNDS: usize = 4;

/// A rival must explain the signs worse by this logarithm of a ratio of likelihoods.
pub(in crate::recognition) const RIVAL_MARGIN: f64 = 4.5;

/// What is worse than the best by more is not looked at further: refinement gains less.
const FAR_WORSE: f64 = 12.0;

/// Alternatives in which one sign was misread are looked for up to this number of distinctive signs that agree.
const MISREAD_RIVALS_MAX: usize = 3;

/// Two transformations are rivals if they differ by more than this at the place where the signs were seen, in metres.
const RIVAL_DISTANCE_M: f64 = 2.0;

/// Or by more than this rotation, in rad.
const RIVAL_ANGLE_RAD: f64 = 0.5;

/// A place that is less certain is not announced, in metres.
pub(in crate::recognition) const POSITION_SIGMA_MAX_M: f64 = 1.0;

/// A rotation that is less certain is not announced, in rad: 8 degrees.
pub(in crate::recognition) const YAW_SIGMA_MAX_RAD: f64 = 0.14;

/// The share of the distinctive signs that must agree: readers misread some.
pub(in crate::recognition) const AGREEING_SHARE_MIN: f64 = 0.5;

/// An alignment that stands alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Alignment {
    /// The plan's frame.
    pub frame: usize,
    /// The transformation from the levelled session into the plan.
    pub fit: PlanarFit,
    /// The drawn signs that agree.
    pub inliers: usize,
    /// Of these, the distinctive ones.
    pub distinctive: usize,
    /// Standard deviation of the place where the signs were seen, in metres.
    pub position_sigma_m: f64,
    /// Standard deviation of the rotation, in rad.
    pub yaw_sigma_rad: f64,
}

/// A proposal with its support.
#[derive(Clone, Debug, PartialEq)]
struct Judged {
    proposal: Proposal,
    support: Support,
}

/// Aligns a session to the plans; none if no transformation stands alone.
pub fn align(signs: &Signs) -> Option<Alignment> {
    let mut judged = judge_all(signs, proposals(signs, Readings::Right), Vec::new());
    let first = best_of(&judged)?;
    // More signs than these cannot all be elsewhere by one misreading.
    if distinctive_of(signs, first).0 <= MISREAD_RIVALS_MAX {
        judged = judge_all(signs, proposals(signs, Readings::OneMisread), judged);
    }
    // A stable sort: of equals, the surest signs' first.
    judged.sort_by(|a, b| b.support.score.total_cmp(&a.support.score));
    for candidate in judged.iter_mut().take(REFINED_MAX) {
        refine(signs, candidate);
    }
    let best = best_of(&judged)?;
    let seen_from = seen_from(signs, best)?;
    let rival = judged.iter().find(|other| {
        best.support.score - other.support.score < RIVAL_MARGIN && is_rival(best, other, &seen_from)
    });
    if rival.is_some() {
        return None;
    }
    announced(signs, best, &seen_from)
}

/// Judges proposals beside those that are judged; leaves out what is far worse than the best.
fn judge_all(signs: &Signs, proposals: Vec<Proposal>, mut judged: Vec<Judged>) -> Vec<Judged> {
    let mut best = best_of(&judged).map_or(f64::NEG_INFINITY, |best| best.support.score);
    for proposal in proposals {
        let found = judge(signs, proposal, best - FAR_WORSE);
        best = found.as_ref().map_or(best, |found| found.support.score.max(best));
        judged.extend(found);
    }
    judged.retain(|judged| judged.support.score >= best - FAR_WORSE);
    judged
}

/// Returns the first of the best.
fn best_of(judged: &[Judged]) -> Option<&Judged> {
    judged.iter().reduce(|a, b| if b.support.score > a.support.score { b } else { a })
}

fn judge(signs: &Signs, proposal: Proposal, floor: f64) -> Option<Judged> {
    let support = support(signs, proposal.frame, &proposal.fit, floor)?;
    Some(Judged { proposal, support })
}

/// Fits a transformation to all that it explains, as long as that explains more.
fn refine(signs: &Signs, candidate: &mut Judged) {
    for _ in 0..ROUNDS {
        let pairs = fit_pairs(signs, &candidate.support.explained, Some(&candidate.proposal.fit));
        let Some(fit) = PlanarFit::of(&pairs) else { return };
        let floor = candidate.support.score;
        let refined = judge(signs, Proposal { fit, ..candidate.proposal }, floor);
        let Some(refined) = refined.filter(|refined| refined.support.score > floor) else { return };
        *candidate = refined;
    }
}

/// Returns the mean place of the cameras that saw the signs which a proposal explains.
fn seen_from(signs: &Signs, judged: &Judged) -> Option<Vector2<f64>> {
    let explained = &judged.support.explained;
    let places = explained.iter().map(|explained| signs.seen[explained.seen].seen_from);
    (!explained.is_empty()).then(|| places.sum::<Vector2<f64>>() / explained.len() as f64)
}

fn is_rival(best: &Judged, other: &Judged, seen_from: &Vector2<f64>) -> bool {
    let (a, b) = (&best.proposal, &other.proposal);
    let place = Vector3::new(seen_from.x, seen_from.y, 0.0);
    let apart_m = (a.fit.pose.transform(&place) - b.fit.pose.transform(&place)).xy().norm();
    a.frame != b.frame || apart_m > RIVAL_DISTANCE_M || a.fit.pose.angle_to(&b.fit.pose) > RIVAL_ANGLE_RAD
}

/// Returns the alignment if enough distinctive signs agree, and it is certain enough.
fn announced(signs: &Signs, best: &Judged, seen_from: &Vector2<f64>) -> Option<Alignment> {
    let (distinctive, specific) = distinctive_of(signs, best);
    let all = distinct((0..signs.seen.len()).filter(|seen| signs.seen[*seen].is_distinctive));
    let are_enough = specific >= DISTINCTIVE_MIN || distinctive >= GENERAL_MIN;
    if !are_enough || (distinctive as f64) < AGREEING_SHARE_MIN * all as f64 {
        return None;
    }
    let fit = best.proposal.fit;
    let along_sight = (seen_from - fit.centre).norm_squared() * fit.yaw_variance;
    let position_sigma_m = (2.0 * fit.centre_variance + along_sight).sqrt();
    let yaw_sigma_rad = fit.yaw_variance.sqrt();
    let is_certain = position_sigma_m <= POSITION_SIGMA_MAX_M && yaw_sigma_rad <= YAW_SIGMA_MAX_RAD;
    is_certain.then(|| Alignment {
        frame: best.proposal.frame,
        fit,
        inliers: distinct(same(best).map(|explained| explained.drawn)),
        distinctive,
        position_sigma_m,
        yaw_sigma_rad,
    })
}

/// Returns the signs that are explained by their own text.
fn same(judged: &Judged) -> impl Iterator<Item = &Explained> + Clone {
    judged.support.explained.iter().filter(|explained| explained.is_same)
}

/// Returns how many drawn signs with distinctive texts agree, and how many of these bear more than words of every building.
fn distinctive_of(signs: &Signs, judged: &Judged) -> (usize, usize) {
    let of_distinctive = same(judged).filter(|explained| signs.seen[explained.seen].is_distinctive);
    let of_specific = of_distinctive.clone().filter(|explained| signs.seen[explained.seen].is_specific);
    let drawn = |explained: &Explained| explained.drawn;
    (distinct(of_distinctive.map(drawn)), distinct(of_specific.map(drawn)))
}

fn distinct(numbers: impl Iterator<Item = usize>) -> usize {
    numbers.collect::<std::collections::BTreeSet<_>>().len()
}
