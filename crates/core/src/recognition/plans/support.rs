//! Support: how well a transformation explains the signs that a session saw, as a logarithm of a likelihood.
//!
//! A sign is explained by a drawn one of its text near its place, at some cost by one of a similar text, which it was misread
//! for, or by none of the plan, at the highest cost. Alternatives are compared by their sums.

use super::planar_fit::{FitPair, PlanarFit, PlanarPose};
use super::signs::{DrawnSign, SeenSign, Signs};

/// Variance of a drawn sign's place along the floor, in m²: a plan shows the door, and the sign hangs beside it.
pub(in crate::recognition) const DRAWN_VARIANCE_M2: f64 = 0.15 * 0.15;

/// Variance of a sign's height against the plan, in m²: plans give the floor's height, or none.
pub(in crate::recognition) const HEIGHT_VARIANCE_M2: f64 = 0.8 * 0.8;

/// A drawn sign is not the one that was seen beyond this squared distance, in variances: 99.5 % of three axes.
pub(in crate::recognition) const GATE: f64 = 12.84;

/// Drift of the session's frame, as a share of the distance from the signs' centre.
pub(in crate::recognition) const DRIFT_SHARE: f64 = 0.01;

/// The cost of a sign that the plan does not show, beyond that of having been misread.
const UNDRAWN_COST: f64 = 1.0;

/// The gain of a text that the plans do not have, where it differs in one character from what hangs there.
const CORRECTED_GAIN: f64 = 1.0;

/// The cost of a sign that was read from behind its wall.
const BEHIND_COST: f64 = 3.0;

/// Variances of a similar text count this much more: it may be the neighbour.
const SIMILAR_VARIANCE_FACTOR: f64 = 2.0;

/// A sign that is explained by a drawn one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Explained {
    /// The number of the seen sign.
    pub seen: usize,
    /// The number of the drawn sign.
    pub drawn: usize,
    /// Whether the texts are the same, or only similar.
    pub is_same: bool,
}

/// How well a transformation explains the signs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Support {
    /// The logarithm of the likelihood, at most about 0.
    pub score: f64,
    /// The signs that are explained.
    pub explained: Vec<Explained>,
}

/// Judges a transformation into one plan's frame; none once it is certain to explain the signs worse than `floor`. Most
/// proposals are wrong, and a few signs tell.
pub fn support(signs: &Signs, frame: usize, fit: &PlanarFit, floor: f64) -> Option<Support> {
    let mut support = Support::default();
    let gains = |seen: &SeenSign| if seen.same.is_empty() { CORRECTED_GAIN } else { 0.0 };
    let mut gain_left: f64 = signs.seen.iter().map(gains).sum();
    for (number, seen) in signs.seen.iter().enumerate() {
        if support.score + gain_left < floor {
            return None;
        }
        gain_left -= gains(seen);
        let own = seen.variance + DRAWN_VARIANCE_M2;
        let off = (seen.position.xy() - fit.centre).norm() * DRIFT_SHARE;
        let variance = own + off * off + fit.variance_at(&seen.position.xy());
        // An uncertain transformation explains much, so each of its explanations counts less.
        let looseness = libm::log(variance / own);
        let best = |among: &[usize]| {
            let of_frame = among.iter().filter(|drawn| signs.drawn[**drawn].frame == frame);
            of_frame
                .filter_map(|drawn| Some((misfit(seen, &signs.drawn[*drawn], &fit.pose, variance)?, *drawn)))
                .min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))
        };
        let is_drawn = !seen.same.is_empty();
        let undrawn = if is_drawn { -seen.misread_cost - UNDRAWN_COST } else { 0.0 };
        let same = best(&seen.same).map(|(misfit, drawn)| (-misfit - looseness, drawn, true));
        let misread = if is_drawn { -seen.misread_cost } else { CORRECTED_GAIN };
        let similar = best(&seen.similar).map(|(misfit, drawn)| (misread - misfit - looseness, drawn, false));
        let explained = [same, similar].into_iter().flatten().max_by(|a, b| a.0.total_cmp(&b.0));
        match explained.filter(|(score, ..)| *score > undrawn) {
            Some((score, drawn, is_same)) => {
                support.score += score;
                support.explained.push(Explained { seen: number, drawn, is_same });
            }
            None => support.score += undrawn,
        }
    }
    Some(support)
}

/// Returns half the squared distance of a seen sign from a drawn one, in variances; none beyond the gate.
fn misfit(seen: &SeenSign, drawn: &DrawnSign, pose: &PlanarPose, variance: f64) -> Option<f64> {
    let off = pose.transform(&seen.position) - drawn.position;
    let height = off.z * off.z / (seen.variance + HEIGHT_VARIANCE_M2);
    let squared = off.xy().norm_squared() / variance + height;
    if squared > GATE {
        return None;
    }
    let towards_camera = pose.rotate(&(seen.seen_from - seen.position.xy()));
    let is_behind = drawn.normal.is_some_and(|normal| normal.dot(&towards_camera) < 0.0);
    Some(0.5 * squared + if is_behind { BEHIND_COST } else { 0.0 })
}

/// Returns the pairs that a transformation is fitted to: those that it explains, each once.
pub fn fit_pairs(signs: &Signs, explained: &[Explained], fit: Option<&PlanarFit>) -> Vec<FitPair> {
    let pair = |explained: &Explained| {
        let (seen, drawn) = (&signs.seen[explained.seen], &signs.drawn[explained.drawn]);
        let off = fit.map_or(0.0, |fit| (seen.position.xy() - fit.centre).norm() * DRIFT_SHARE);
        let factor = if explained.is_same { 1.0 } else { SIMILAR_VARIANCE_FACTOR };
        let variance = (seen.variance + DRAWN_VARIANCE_M2 + off * off) * factor;
        FitPair { inner: seen.position, outer: drawn.position, variance }
    };
    explained.iter().map(pair).collect()
}
