//! Proposals: transformations that two signs propose.
//!
//! Two signs determine a rotation about the vertical and a translation. Pairs of the same texts propose the places that may be
//! announced; pairs of which one text may be misread propose the rivals that an announcement must rule out.

use super::planar_fit::PlanarFit;
use super::signs::Signs;
use super::support::{Explained, fit_pairs};

/// Maximum seen signs of which pairs are formed, the surest.
const SEEN_MAX: usize = 48;

/// Maximum drawn signs of one text that are tried.
const DRAWN_MAX: usize = 32;

/// Maximum proposals of a session.
const PROPOSALS_MAX: usize = 20_000;

/// Two signs closer than this determine no rotation, in metres.
pub(in crate::recognition) const SEPARATION_MIN_M: f64 = 1.0;

/// The distance between two signs may differ between plan and session by this many standard deviations.
const DISTANCE_SIGMAS: f64 = 3.0;

/// A transformation that two signs propose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Proposal {
    /// The plan's frame.
    pub frame: usize,
    /// The transformation.
    pub fit: PlanarFit,
}

/// The readings that two signs of a proposal may have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Readings {
    /// Both texts stand as they were read.
    Right,
    /// One of the two was misread by a character.
    OneMisread,
}

/// Returns the proposals, those of the surest signs first.
pub fn proposals(signs: &Signs, readings: Readings) -> Vec<Proposal> {
    let mut order: Vec<usize> = (0..signs.seen.len()).collect();
    // Distinctive ones first, then those read alike most often; the sort keeps the order of the rest.
    order.sort_by(|a, b| {
        let (a, b) = (&signs.seen[*a], &signs.seen[*b]);
        let by_cost = || b.misread_cost.total_cmp(&a.misread_cost);
        b.is_distinctive.cmp(&a.is_distinctive).then_with(by_cost)
    });
    order.truncate(SEEN_MAX);
    let mut found = Vec::new();
    for (place, first) in order.iter().enumerate() {
        for second in &order[place + 1..] {
            propose(signs, (*first, *second), readings, &mut found);
            if found.len() >= PROPOSALS_MAX {
                return found;
            }
        }
    }
    found
}

fn propose(signs: &Signs, (a, b): (usize, usize), wanted: Readings, found: &mut Vec<Proposal>) {
    let readings = |seen: usize| {
        let same = signs.seen[seen].same.iter().take(DRAWN_MAX).map(|drawn| (*drawn, true));
        same.chain(signs.seen[seen].similar.iter().take(DRAWN_MAX).map(|drawn| (*drawn, false)))
    };
    for (drawn_a, is_same_a) in readings(a) {
        for (drawn_b, is_same_b) in readings(b) {
            let is_wanted = match wanted {
                Readings::Right => is_same_a && is_same_b,
                // Of two signs, one at most is taken for misread.
                Readings::OneMisread => is_same_a != is_same_b,
            };
            if !is_wanted || !is_consistent(signs, (a, b), (drawn_a, drawn_b)) {
                continue;
            }
            // A rival is proposed as certain as what it rivals.
            let pair =
                [(a, drawn_a), (b, drawn_b)].map(|(seen, drawn)| Explained { seen, drawn, is_same: true });
            let frame = signs.drawn[drawn_a].frame;
            found.extend(PlanarFit::of(&fit_pairs(signs, &pair, None)).map(|fit| Proposal { frame, fit }));
        }
    }
}

/// Whether two signs are in one frame, apart from each other, and equally far apart in the plan and in the session.
fn is_consistent(signs: &Signs, (a, b): (usize, usize), (drawn_a, drawn_b): (usize, usize)) -> bool {
    let (drawn_a, drawn_b) = (&signs.drawn[drawn_a], &signs.drawn[drawn_b]);
    let (a, b) = (&signs.seen[a], &signs.seen[b]);
    let in_plan_m = (drawn_a.position - drawn_b.position).xy().norm();
    let in_session_m = (a.position - b.position).xy().norm();
    let limit_m = DISTANCE_SIGMAS * (a.variance + b.variance).sqrt() + 0.5;
    drawn_a.frame == drawn_b.frame
        && in_plan_m >= SEPARATION_MIN_M
        && in_session_m > f64::EPSILON
        && (in_plan_m - in_session_m).abs() <= limit_m
}
