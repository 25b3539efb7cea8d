//! Comparison of two local anchor maps (§V-B): Eq. (1), Eq. (2), and what speaks against.
//!
//! The paper's reading and ours share these lines; the map's settings choose. To the letter, every
//! pair with x(i, j) = 1 is summed, so three EXIT signs against three give S = 3. With
//! `one_to_one` an anchor matches at most one of the other map, by the assignment of maximum
//! weight, and 0 <= S <= 1.

use super::anchor_map::{LocalAnchor, LocalAnchorMap};
use super::assignment::assign;
use super::contradiction::{Contradiction, contradict, unmatched};
use super::index::TextIndex;
use crate::model::anchor::AnchorState;
use crate::model::settings::Settings;
use crate::semantics::{self, Source};

/// A pair of anchors with x(i, j) = 1.
#[derive(Clone, Copy, Debug)]
pub struct Matched<'a> {
    /// The anchor of the query's map.
    pub query: &'a LocalAnchor,
    /// The anchor of the candidate's map.
    pub candidate: &'a LocalAnchor,
    /// SimilarityLevel of the two descriptions.
    pub level: u8,
    /// Who judged.
    pub source: Source,
}

impl Matched<'_> {
    /// What the pair adds to the numerator of Eq. (2).
    pub fn weight(&self) -> f64 {
        self.query.weight + self.candidate.weight
    }
}

/// What the two maps have in common, and what speaks against their being one place.
#[derive(Clone, Debug)]
pub struct Comparison<'a> {
    /// S of Eq. (2); 0 if a map is empty.
    pub similarity: f64,
    /// S if every anchor not described yet turned out to match whatever stands where it stands.
    pub similarity_at_best: f64,
    /// |A_a|: valid anchors of the query's map.
    pub in_query: usize,
    /// |A_b|: valid anchors of the candidate's map.
    pub in_candidate: usize,
    /// Anchors of both maps that nothing has described yet.
    pub pending: usize,
    /// The pairs that match.
    pub matches: Vec<Matched<'a>>,
    /// The pairs that contradict (only with `contradiction_veto`).
    pub contradictions: Vec<Contradiction<'a>>,
    /// The weight of all valid anchors of both maps: the denominator of Eq. (2).
    pub total_weight: f64,
    /// Valid anchors of the query's map that nothing in the candidate's is called like.
    pub unmatched_of_query: Vec<&'a LocalAnchor>,
    /// Valid anchors of the candidate's map that nothing in the query's is called like.
    pub unmatched_of_candidate: Vec<&'a LocalAnchor>,
}

impl Comparison<'_> {
    /// The weight of everything that agrees.
    pub fn agreeing_weight(&self) -> f64 {
        total(self.matches.iter().map(Matched::weight))
    }

    /// The weight of everything that contradicts.
    pub fn contradicting_weight(&self) -> f64 {
        total(self.contradictions.iter().map(Contradiction::weight))
    }
}

/// Compares the local anchor map of the query with that of a candidate.
pub fn compare<'a>(
    query: &'a LocalAnchorMap,
    candidate: &'a LocalAnchorMap,
    texts: &TextIndex,
    settings: &Settings,
) -> Comparison<'a> {
    let of_query: Vec<&LocalAnchor> = query.valid().collect();
    let of_candidate: Vec<&LocalAnchor> = candidate.valid().collect();
    let matches = matching_pairs(&of_query, &of_candidate, texts, settings);
    let total_weight = total(of_query.iter().chain(&of_candidate).map(|anchor| anchor.weight));
    let pending = query.pending() + candidate.pending();
    let similarity = equation_2(total(matches.iter().map(Matched::weight)), total_weight);
    let unmatched_of_query = unmatched(&of_query, &of_candidate, texts, settings);
    let unmatched_of_candidate = unmatched(&of_candidate, &of_query, texts, settings);
    let contradictions = if settings.contradiction_veto {
        contradict(&unmatched_of_query, &unmatched_of_candidate, |a, b| same_relative_place(a, b, settings))
    } else {
        Vec::new()
    };
    Comparison {
        similarity,
        similarity_at_best: if pending == 0 {
            similarity
        } else {
            at_best(query, candidate, texts, settings)
        },
        in_query: of_query.len(),
        in_candidate: of_candidate.len(),
        pending,
        matches,
        contradictions,
        total_weight,
        unmatched_of_query,
        unmatched_of_candidate,
    }
}

/// The sum of some weights. (`Iterator::sum` of no floats is -0, which a reader would be shown.)
fn total(weights: impl Iterator<Item = f64>) -> f64 {
    weights.fold(0.0, |sum, weight| sum + weight)
}

/// Eq. (2): the summed weight of matching pairs over the weight of all anchors of both maps.
pub(super) fn equation_2(matching_weight: f64, total_weight: f64) -> f64 {
    if total_weight > 0.0 { matching_weight / total_weight } else { 0.0 }
}

/// The pairs that Eq. (2) sums, in the order of the two maps.
fn matching_pairs<'a>(
    of_query: &[&'a LocalAnchor],
    of_candidate: &[&'a LocalAnchor],
    texts: &TextIndex,
    settings: &Settings,
) -> Vec<Matched<'a>> {
    let x = |i: usize, j: usize| matched(of_query[i], of_candidate[j], texts, settings);
    if settings.one_to_one {
        let pairs = assign(of_query.len(), of_candidate.len(), |i, j| x(i, j).map(|pair| pair.weight()));
        return pairs.into_iter().filter_map(|(i, j)| x(i, j)).collect();
    }
    (0..of_query.len()).flat_map(|i| (0..of_candidate.len()).filter_map(move |j| x(i, j))).collect()
}

/// Eq. (1): x(i, j) = 1 if A_i and A_j have similar descriptions and the same relative place.
fn matched<'a>(
    query: &'a LocalAnchor,
    candidate: &'a LocalAnchor,
    texts: &TextIndex,
    settings: &Settings,
) -> Option<Matched<'a>> {
    if !same_relative_place(query, candidate, settings) {
        return None;
    }
    let (level, source) = similar(query, candidate, texts, settings)?;
    Some(Matched { query, candidate, level, source })
}

/// |theta_i - theta_j| < pi/3 and |d_i - d_j| < 1, strictly.
pub(super) fn same_relative_place(a: &LocalAnchor, b: &LocalAnchor, settings: &Settings) -> bool {
    a.bearing.distance_difference_m(&b.bearing) < settings.anchor_map_max_distance_difference_m
        && a.bearing.angle_difference_rad(&b.bearing) < settings.anchor_map_max_angle_difference_rad
}

/// SimilarityLevel of two valid anchors of one class, if it is high enough.
pub(super) fn similar(
    a: &LocalAnchor,
    b: &LocalAnchor,
    texts: &TextIndex,
    settings: &Settings,
) -> Option<(u8, Source)> {
    if a.class != b.class {
        return None;
    }
    if let (Some(a), Some(b)) = (a.text_id, b.text_id) {
        return texts.level(a, b);
    }
    let (level, source) = semantics::similarity_level(a.text.as_deref()?, b.text.as_deref()?);
    (u32::from(level) >= settings.matching_min_similarity_level).then_some((level, source))
}

/// S at its best: an anchor not described yet matches any anchor of its class at the same
/// relative place, and counts only where it does.
fn at_best(
    query: &LocalAnchorMap,
    candidate: &LocalAnchorMap,
    texts: &TextIndex,
    settings: &Settings,
) -> f64 {
    let open = |map: &'_ LocalAnchorMap| -> Vec<LocalAnchor> {
        map.anchors.iter().filter(|anchor| anchor.state != AnchorState::Uninformative).cloned().collect()
    };
    let (of_query, of_candidate) = (open(query), open(candidate));
    let weight = |i: usize, j: usize| {
        let (a, b): (&LocalAnchor, &LocalAnchor) = (&of_query[i], &of_candidate[j]);
        let wildcard = a.class == b.class && (is_pending(a) || is_pending(b));
        let fits = same_relative_place(a, b, settings);
        (fits && (wildcard || similar(a, b, texts, settings).is_some())).then_some(a.weight + b.weight)
    };
    let pairs = assign(of_query.len(), of_candidate.len(), weight);
    let matching = total(pairs.iter().filter_map(|(i, j)| weight(*i, *j)));
    let valid = total(query.valid().chain(candidate.valid()).map(|anchor| anchor.weight));
    let paired = pairs.iter().flat_map(|(i, j)| [&of_query[*i], &of_candidate[*j]]);
    let described_later = total(paired.filter(|anchor| is_pending(anchor)).map(|anchor| anchor.weight));
    equation_2(matching, valid + described_later)
}

fn is_pending(anchor: &LocalAnchor) -> bool {
    anchor.state == AnchorState::Pending
}
