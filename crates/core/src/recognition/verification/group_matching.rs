//! Groups of features matched with groups: each feature's nearest descriptor among those of its group.

use super::descriptor_match::Match;
use super::limits::MatchingLimits;
use crate::geometry::hamming::{Columns, PackedDescriptors, distance_by};
use crate::geometry::instruction_set::Kernel;

/// The tests a best match must pass.
#[derive(Clone, Copy)]
pub(super) struct Acceptance {
    max_distance: f64,
    max_ratio: f64,
    mutual: bool,
}

impl Acceptance {
    pub(super) fn new(limits: &MatchingLimits, bits: u32) -> Self {
        let max_distance = limits.max_distance * f64::from(bits);
        Self { max_distance, max_ratio: limits.max_ratio, mutual: limits.mutual }
    }

    /// Whether the best is near enough, and clearly nearer than the second best.
    #[inline(always)]
    fn accepts(&self, best: u16, second: u16) -> bool {
        let best = f64::from(best);
        best <= self.max_distance && (second == u16::MAX || best < self.max_ratio * f64::from(second))
    }
}

/// The rows of a group are numbered in 16 bits; a group has no more of them.
const ROWS_MAX: usize = u16::MAX as usize;

/// Groups of at least this many candidates are laid out by columns first.
const COLUMNS_MIN: usize = 32;

/// Numbers that are compared at a time, when one of them is looked for.
const STRETCH: usize = 32;

/// Groups of features, query's and candidate's, to be matched within each.
pub(super) struct GroupMatching<'a> {
    pub query: &'a PackedDescriptors,
    pub candidate: &'a PackedDescriptors,
    pub groups: &'a [(&'a [u32], &'a [u32])],
    pub acceptance: Acceptance,
}

impl Kernel for GroupMatching<'_> {
    type Output = Vec<Match>;

    #[inline(always)]
    fn run<const POPCNT: bool>(self) -> Vec<Match> {
        let mut found = Vec::new();
        let mut best_of = BestOfCandidates::default();
        let mut distances = Vec::new();
        let mut accepted: Vec<Accepted> = Vec::new();
        for &(features, others) in self.groups {
            best_of.reset(others.len());
            distances.clear();
            distances.resize(others.len(), 0_u16);
            accepted.clear();
            let columns = (others.len() >= COLUMNS_MIN).then(|| {
                let rows = others.iter().map(|&other| self.candidate.get(other as usize));
                Columns::new(self.candidate.words_each(), rows)
            });
            for (&feature, row) in features.iter().take(ROWS_MAX).zip(0_u16..) {
                let one = self.query.get(feature as usize);
                if let Some(columns) = &columns {
                    columns.fill_distances::<POPCNT>(one, &mut distances);
                } else {
                    for (distance, &other) in distances.iter_mut().zip(others) {
                        *distance = distance_by::<POPCNT>(one, self.candidate.get(other as usize)) as u16;
                    }
                }
                best_of.update(row, &distances);
                let Some((place, best, second)) = best_and_second(&distances) else { break };
                if self.acceptance.accepts(best, second) {
                    accepted.push(Accepted { row, place, distance: best });
                }
            }
            for it in &accepted {
                if !self.acceptance.mutual || best_of.queries[it.place] == it.row {
                    let (query, candidate) = (features[usize::from(it.row)], others[it.place]);
                    found.push(Match { query, candidate, distance: u32::from(it.distance) });
                }
            }
        }
        found
    }
}

/// A row of a group whose best match is good enough, and the place of that match.
struct Accepted {
    row: u16,
    place: usize,
    distance: u16,
}

/// The best query feature so far for each candidate feature of a group.
#[derive(Default)]
struct BestOfCandidates {
    distances: Vec<u16>,
    queries: Vec<u16>,
}

impl BestOfCandidates {
    #[inline(always)]
    fn reset(&mut self, count: usize) {
        self.distances.clear();
        self.distances.resize(count, u16::MAX);
        self.queries.clear();
        self.queries.resize(count, 0);
    }

    #[inline(always)]
    fn update(&mut self, row: u16, distances: &[u16]) {
        for ((best, query), &distance) in self.distances.iter_mut().zip(&mut self.queries).zip(distances) {
            *query = if distance < *best { row } else { *query };
            *best = distance.min(*best);
        }
    }
}

/// Returns the place of the least distance, that distance, and the least of the others.
#[inline(always)]
fn best_and_second(distances: &[u16]) -> Option<(usize, u16, u16)> {
    let best = least(distances);
    let place = place_of(best, distances)?;
    Some((place, best, least(&distances[..place]).min(least(&distances[place + 1..]))))
}

#[inline(always)]
fn least(distances: &[u16]) -> u16 {
    distances.iter().fold(u16::MAX, |least, &distance| least.min(distance))
}

/// Returns the first place of a number. A stretch is compared as a whole, in wide registers.
#[inline(always)]
fn place_of(wanted: u16, numbers: &[u16]) -> Option<usize> {
    let mut skipped = 0;
    for stretch in numbers.as_chunks::<STRETCH>().0 {
        let mut is_here = false;
        for number in stretch {
            is_here |= *number == wanted;
        }
        if is_here {
            break;
        }
        skipped += STRETCH;
    }
    numbers[skipped..].iter().position(|&number| number == wanted).map(|place| skipped + place)
}
