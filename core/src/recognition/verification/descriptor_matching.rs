//! Matching the binary descriptors of two keyframes: by the vocabulary's nodes where both have them, else all with all.

use super::descriptor_match::Match;
use super::limits::MatchingLimits;
use super::orientation::keep_consistent_rotations;
use crate::domain::keyframe::Keypoint;
use crate::geometry::hamming::{Columns, PackedDescriptors, distance};

/// The node of a feature that has none, such as one whose word has weight 0.
pub const NO_NODE: u32 = u32::MAX;

/// One side of a matching: some features of a keyframe.
#[derive(Clone, Copy, Debug)]
pub struct Side<'a> {
    /// The descriptors of all features.
    pub descriptors: &'a PackedDescriptors,
    /// The keypoints of all features.
    pub keypoints: &'a [Keypoint],
    /// The vocabulary's node of each feature, or [`NO_NODE`].
    pub nodes: Option<&'a [u32]>,
    /// The features that take part, ascending.
    pub features: &'a [u32],
}

/// Returns the matches, ascending by the query's feature. Ties in distance go to the first feature, and fail the ratio
/// test.
pub fn match_descriptors(query: &Side, candidate: &Side, limits: &MatchingLimits) -> Vec<Match> {
    if query.descriptors.words_each() != candidate.descriptors.words_each() {
        return Vec::new();
    }
    let acceptance = Acceptance::new(limits, query.descriptors.bits());
    let mut matches = match (query.nodes, candidate.nodes) {
        (Some(of_query), Some(of_candidate)) => {
            by_nodes(query, of_query, candidate, of_candidate, &acceptance)
        }
        _ => all_with_all(query, candidate, &acceptance),
    };
    matches.sort_unstable_by_key(|found| (found.query, found.candidate));
    if limits.orientation {
        keep_consistent_rotations(&mut matches, query.keypoints, candidate.keypoints);
    }
    matches
}

/// The tests a best match must pass.
struct Acceptance {
    max_distance: f64,
    max_ratio: f64,
    mutual: bool,
}

impl Acceptance {
    fn new(limits: &MatchingLimits, bits: u32) -> Self {
        let max_distance = limits.max_distance * f64::from(bits);
        Self { max_distance, max_ratio: limits.max_ratio, mutual: limits.mutual }
    }

    /// Whether the best is near enough, and clearly nearer than the second best.
    fn accepts(&self, best: u16, second: u16) -> bool {
        let best = f64::from(best);
        best <= self.max_distance && (second == u16::MAX || best < self.max_ratio * f64::from(second))
    }
}

/// The best query feature so far for each candidate feature of a group.
#[derive(Default)]
struct BestOfCandidates {
    distances: Vec<u16>,
    queries: Vec<u16>,
}

/// The rows of a group are numbered in blocks of this many, so that numbers fit in 16 bits.
const ROWS_MAX: usize = u16::MAX as usize;

impl BestOfCandidates {
    fn reset(&mut self, count: usize) {
        self.distances.clear();
        self.distances.resize(count, u16::MAX);
        self.queries.clear();
        self.queries.resize(count, 0);
    }

    fn update(&mut self, row: u16, distances: &[u16]) {
        for ((best, query), &distance) in self.distances.iter_mut().zip(&mut self.queries).zip(distances) {
            *query = if distance < *best { row } else { *query };
            *best = distance.min(*best);
        }
    }
}

/// Returns the place of the least distance, that distance, and the least of the others.
fn best_and_second(distances: &[u16]) -> Option<(usize, u16, u16)> {
    let least = |part: &[u16]| part.iter().fold(u16::MAX, |least, &distance| least.min(distance));
    let best = least(distances);
    let place = distances.iter().position(|&distance| distance == best)?;
    Some((place, best, least(&distances[..place]).min(least(&distances[place + 1..]))))
}

/// Matches a group of features with a group; `fill` gives the distances of one query feature to all candidates.
fn match_group(
    query: &[u32],
    candidate: &[u32],
    acceptance: &Acceptance,
    scratch: &mut (BestOfCandidates, Vec<u16>),
    mut fill: impl FnMut(u32, &mut Vec<u16>),
    found: &mut Vec<Match>,
) {
    let (best_of, distances) = scratch;
    best_of.reset(candidate.len());
    let first = found.len();
    let mut rows = Vec::new();
    for (row, &feature) in query.iter().enumerate().take(ROWS_MAX) {
        fill(feature, distances);
        best_of.update(row as u16, distances);
        let Some((place, best, second)) = best_and_second(distances) else { return };
        if acceptance.accepts(best, second) {
            rows.push((row, place));
            found.push(Match { query: feature, candidate: candidate[place], distance: u32::from(best) });
        }
    }
    if acceptance.mutual {
        let mut rows = rows.into_iter();
        let mut index = 0;
        found.retain(|_| {
            index += 1;
            index <= first
                || rows.next().is_some_and(|(row, place)| usize::from(best_of.queries[place]) == row)
        });
    }
}

fn all_with_all(query: &Side, candidate: &Side, acceptance: &Acceptance) -> Vec<Match> {
    let rows = candidate.features.iter().map(|&feature| candidate.descriptors.get(feature as usize));
    let columns = Columns::new(candidate.descriptors.words_each(), rows);
    let mut found = Vec::new();
    match_group(
        query.features,
        candidate.features,
        acceptance,
        &mut (BestOfCandidates::default(), Vec::new()),
        |feature, distances| columns.distances_to(query.descriptors.get(feature as usize), distances),
        &mut found,
    );
    found
}

/// Only features of one node are compared, as ORB-SLAM's `SearchByBoW` does.
fn by_nodes(
    query: &Side,
    query_nodes: &[u32],
    candidate: &Side,
    candidate_nodes: &[u32],
    acceptance: &Acceptance,
) -> Vec<Match> {
    let sorted = |features: &[u32], nodes: &[u32]| {
        let mut sorted: Vec<(u32, u32)> = features
            .iter()
            .map(|&feature| (nodes[feature as usize], feature))
            .filter(|&(node, _)| node != NO_NODE)
            .collect();
        sorted.sort_unstable();
        sorted
    };
    let of_query = sorted(query.features, query_nodes);
    let of_candidate = sorted(candidate.features, candidate_nodes);
    let mut scratch = (BestOfCandidates::default(), Vec::new());
    let (mut features, mut others) = (Vec::new(), Vec::new());
    let mut found = Vec::new();
    let mut rest = of_candidate.as_slice();
    for group in of_query.chunk_by(|a, b| a.0 == b.0) {
        let node = group[0].0;
        rest = &rest[rest.partition_point(|other| other.0 < node)..];
        let same = rest.iter().take_while(|other| other.0 == node);
        others.clear();
        others.extend(same.map(|other| other.1));
        features.clear();
        features.extend(group.iter().map(|one| one.1));
        match_group(
            &features,
            &others,
            acceptance,
            &mut scratch,
            |feature, distances| {
                let one = query.descriptors.get(feature as usize);
                distances.clear();
                distances.extend(
                    others
                        .iter()
                        .map(|&other| distance(one, candidate.descriptors.get(other as usize)) as u16),
                );
            },
            &mut found,
        );
    }
    found
}

#[cfg(test)]
mod tests;
