//! Comparison of two local anchor maps (§V-B): Eq. (1), Eq. (2), and what speaks against.
//!
//! The paper's reading and ours share these lines; the map's method chooses. To the letter, every
//! pair with x(i, j) = 1 is summed, so three EXIT signs against three give S = 3. With
//! ours an anchor matches at most one of the other map, by the assignment of maximum
//! weight, and 0 <= S <= 1.

use std::collections::BTreeSet;

use super::anchor_map::{LocalAnchor, LocalAnchorMap, LocalName};
use super::assignment::edges;
use super::equation_1::{same_relative_place, similar, x};
use super::equation_2::{self, summed_pairs, total};
use super::similar_pairs::SimilarPairs;
use crate::domain::anchor::AnchorState;
use crate::domain::ids::{KeyframeSeq, SessionSeq};
use crate::domain::settings::Settings;
use crate::recognition::extensions::contradiction::{Contradiction, contradict};
use crate::recognition::extensions::sighting::Sighting;
use crate::recognition::map::index::{MapIndex, TextIndex};
use crate::semantics::Source;

/// What an inline keyframe sees is held against stored anchors by its place alone.
static NO_KEYFRAMES: BTreeSet<KeyframeSeq> = BTreeSet::new();

/// A pair of anchors with x(i, j) = 1.
#[derive(Clone, Debug)]
pub struct Matched<'a> {
    /// The anchor of the query's map.
    pub query: &'a LocalAnchor,
    /// The anchor of the candidate's map.
    pub candidate: &'a LocalAnchor,
    /// SimilarityLevel of the two descriptions.
    pub level: u8,
    /// Who judged.
    pub source: Source,
    /// In how many places it hangs, were the two one object.
    pub places: usize,
}

impl Matched<'_> {
    /// Returns what the pair adds to the numerator of Eq. (2).
    pub fn weight(&self) -> f64 {
        self.query.weight + self.candidate.weight
    }

    /// Returns what it says for this place: what hangs in p places agrees with all of them, and only one p-th of it is
    /// for this one.
    pub fn agreement(&self) -> f64 {
        self.weight() / self.query.places.max(self.candidate.places) as f64
    }
}

/// What the two maps have in common, and what speaks against their being one place.
#[derive(Clone, Debug)]
pub struct Comparison<'a> {
    /// S of Eq. (2); 0 if a map is empty.
    pub similarity: f64,
    /// The same if every anchor not described yet turned out to match whatever stands where it stands.
    pub best_case: BestCase,
    /// |A_a|: valid anchors of the query's map.
    pub in_query: usize,
    /// |A_b|: valid anchors of the candidate's map.
    pub in_candidate: usize,
    /// Anchors of both maps that nothing has described yet.
    pub pending: usize,
    /// The pairs that match.
    pub matches: Vec<Matched<'a>>,
    /// The pairs that contradict (only by our method).
    pub contradictions: Vec<Contradiction<'a>>,
    /// The weight of all valid anchors of both maps: the denominator of Eq. (2).
    pub total_weight: f64,
    /// Valid anchors of the query's map that nothing in the candidate's is called like.
    pub unmatched_of_query: Vec<&'a LocalAnchor>,
    /// Valid anchors of the candidate's map that nothing in the query's is called like.
    pub unmatched_of_candidate: Vec<&'a LocalAnchor>,
}

/// What a comparison may come to once everything is described.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BestCase {
    /// S of Eq. (2).
    pub similarity: f64,
    /// The weight of everything that agrees.
    pub agreeing_weight: f64,
}

impl Comparison<'_> {
    /// Returns the weight of everything that agrees: the numerator of Eq. (2).
    pub fn agreeing_weight(&self) -> f64 {
        total(self.matches.iter().map(Matched::weight))
    }

    /// Returns the weight of everything that agrees with this place rather than with others.
    pub fn agreement(&self) -> f64 {
        total(self.matches.iter().map(Matched::agreement))
    }

    /// Returns the least number of places that something that agrees hangs at; none if nothing agrees.
    pub fn least_places(&self) -> Option<usize> {
        self.matches.iter().map(|pair| pair.places).min()
    }
}

/// Compares the local anchor map of the query with that of a candidate.
pub fn compare<'a>(
    query: &'a LocalAnchorMap,
    candidate: &'a LocalAnchorMap,
    index: &MapIndex,
    settings: &Settings,
) -> Comparison<'a> {
    let texts = index.texts();
    let of_query: Vec<&LocalAnchor> = query.valid().collect();
    let of_candidate: Vec<&LocalAnchor> = candidate.valid().collect();
    let session = query.session.filter(|session| candidate.session == Some(*session));
    let similar_pairs = SimilarPairs::between(&of_query, &of_candidate, texts, settings);
    let matcher = Matcher { index, session, settings, similar_pairs };
    let matches = matcher.matching_pairs(&of_query, &of_candidate);
    let total_weight = total(of_query.iter().chain(&of_candidate).map(|anchor| anchor.weight));
    let pending = query.pending() + candidate.pending();
    let agreeing_weight = total(matches.iter().map(Matched::weight));
    // Eq. (2)
    let similarity = equation_2::similarity(agreeing_weight, total_weight);
    let [unmatched_of_query, unmatched_of_candidate] =
        matcher.similar_pairs.unmatched(&of_query, &of_candidate);
    let contradictions = if settings.is_ours() {
        let same_place = |a: &LocalAnchor, b: &LocalAnchor| same_relative_place(a, b, settings);
        contradict(&unmatched_of_query, &unmatched_of_candidate, same_place)
    } else {
        Vec::new()
    };
    Comparison {
        similarity,
        best_case: if pending == 0 {
            BestCase { similarity, agreeing_weight }
        } else {
            best_case(query, candidate, texts, settings)
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

/// What deciding on a pair needs.
struct Matcher<'m> {
    index: &'m MapIndex,
    /// The session whose frame both maps are in, if it is one.
    session: Option<SessionSeq>,
    settings: &'m Settings,
    similar_pairs: SimilarPairs,
}

impl Matcher<'_> {
    /// Returns the pairs that Eq. (2) sums, in the order of the two maps.
    fn matching_pairs<'a>(
        &self,
        of_query: &[&'a LocalAnchor],
        of_candidate: &[&'a LocalAnchor],
    ) -> Vec<Matched<'a>> {
        let edges = self.similar_pairs.iter().filter_map(|(i, similar)| {
            let (query, candidate) = (of_query[i], of_candidate[similar.candidate]);
            // Eq. (1)
            let edge = (i, similar.candidate, query.weight + candidate.weight);
            x(query, candidate, self.settings).then_some(edge)
        });
        let pairs = summed_pairs(edges.collect(), self.settings);
        let matched = |(i, j): (usize, usize)| {
            let judged = self.similar_pairs.get(i, j)?.judged.clone();
            Some(matched(self.index, self.session, of_query[i], of_candidate[j], judged))
        };
        pairs.into_iter().filter_map(matched).collect()
    }
}

/// Returns the pair of two anchors that are called alike, wherever they stand. `session` is the one whose frame both are in, if it
/// is one.
pub(in crate::recognition) fn matched<'a>(
    index: &MapIndex,
    session: Option<SessionSeq>,
    query: &'a LocalAnchor,
    candidate: &'a LocalAnchor,
    (level, source): (u8, Source),
) -> Matched<'a> {
    let places = places_if_one(index, session, query, candidate);
    Matched { query, candidate, level, source, places }
}

/// In how many places what two anchors show hangs, were the two one object: one place fewer than counted, if the
/// frame has them in two. A plate seen again after metres of drift hangs in one place; an exit sign seen at a second
/// door as well, until there is a third.
fn places_if_one(
    index: &MapIndex,
    session: Option<SessionSeq>,
    query: &LocalAnchor,
    candidate: &LocalAnchor,
) -> usize {
    let places = query.places.max(candidate.places);
    if places == 1 || !query.is_measured_with(candidate) {
        return places;
    }
    let sighting = |anchor: &LocalAnchor| match (anchor.name, session) {
        (LocalName::MergedAnchor(root), Some(session)) => Sighting::of(index, root, session),
        (LocalName::Inline(_), Some(_)) => Some(Sighting::inline(anchor.centre_in_session, &NO_KEYFRAMES)),
        (_, None) => None,
    };
    match sighting(query).zip(sighting(candidate)) {
        Some((a, b)) if !a.may_be_at(&b, index) && !a.shares_map_with(&b, index) => places - 1,
        _ => places,
    }
}

/// S at its best: an anchor not described yet matches any anchor of its class at the same
/// relative place, and counts only where it does.
fn best_case(
    query: &LocalAnchorMap,
    candidate: &LocalAnchorMap,
    texts: &TextIndex,
    settings: &Settings,
) -> BestCase {
    let open = |map: &'_ LocalAnchorMap| -> Vec<LocalAnchor> {
        map.anchors.iter().filter(|anchor| takes_part(anchor)).cloned().collect()
    };
    let (of_query, of_candidate) = (open(query), open(candidate));
    let weight = |i: usize, j: usize| {
        let (a, b): (&LocalAnchor, &LocalAnchor) = (&of_query[i], &of_candidate[j]);
        let wildcard = a.class == b.class && (is_pending(a) || is_pending(b));
        let fits = same_relative_place(a, b, settings);
        (fits && (wildcard || similar(a, b, texts, settings).is_some())).then_some(a.weight + b.weight)
    };
    let pairs = summed_pairs(edges(of_query.len(), of_candidate.len(), weight), settings);
    let agreeing_weight = total(pairs.iter().filter_map(|(i, j)| weight(*i, *j)));
    let valid = total(query.valid().chain(candidate.valid()).map(|anchor| anchor.weight));
    let described = |anchors: &[LocalAnchor], used: BTreeSet<usize>| {
        total(
            used.into_iter()
                .map(|i| &anchors[i])
                .filter(|anchor| is_pending(anchor))
                .map(|anchor| anchor.weight),
        )
    };
    let described_later = described(&of_query, pairs.iter().map(|(i, _)| *i).collect())
        + described(&of_candidate, pairs.iter().map(|(_, j)| *j).collect());
    BestCase { similarity: equation_2::similarity(agreeing_weight, valid + described_later), agreeing_weight }
}

/// Whether an anchor takes part in Eq. (2), or may once it is described.
fn takes_part(anchor: &LocalAnchor) -> bool {
    matches!(anchor.state, AnchorState::Valid | AnchorState::Pending)
}

fn is_pending(anchor: &LocalAnchor) -> bool {
    anchor.state == AnchorState::Pending
}
