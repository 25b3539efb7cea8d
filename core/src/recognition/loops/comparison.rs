//! Comparison of two local anchor maps (§V-B): Eq. (1), Eq. (2), and what speaks against.
//!
//! The paper's reading and ours share these lines; the map's settings choose. To the letter, every
//! pair with x(i, j) = 1 is summed, so three EXIT signs against three give S = 3. With
//! `one_to_one` an anchor matches at most one of the other map, by the assignment of maximum
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
use crate::recognition::extensions::dispute::disputed;
use crate::recognition::extensions::sighting::Sighting;
use crate::recognition::extensions::sure_text::is_sure;
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
    /// Whether either reading is in doubt by what is read around it.
    pub is_disputed: bool,
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
    /// Pairs of one description at different relative places, which hang nowhere else: from another point of view the same
    /// objects, under a transformation perhaps not.
    pub elsewhere: Vec<Matched<'a>>,
    /// The pairs that contradict (only with `contradiction_veto`).
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

    /// Returns the weight of everything that contradicts.
    pub fn contradicting_weight(&self) -> f64 {
        total(self.contradictions.iter().map(Contradiction::weight))
    }

    /// Returns the weight of everything that surely contradicts.
    pub fn surely_contradicting_weight(&self, index: &MapIndex) -> f64 {
        let is_sure =
            |pair: &&Contradiction<'_>| is_sure(index, pair.query) && is_sure(index, pair.candidate);
        total(self.contradictions.iter().filter(is_sure).map(Contradiction::weight))
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
    let disputed = [disputed(query), disputed(candidate)];
    let similar_pairs = SimilarPairs::between(&of_query, &of_candidate, texts, settings);
    let matcher = Matcher { index, session, settings, disputed, similar_pairs };
    let matches = matcher.matching_pairs(&of_query, &of_candidate);
    let elsewhere = matcher.elsewhere(&of_query, &of_candidate);
    let total_weight = total(of_query.iter().chain(&of_candidate).map(|anchor| anchor.weight));
    let pending = query.pending() + candidate.pending();
    let agreeing_weight = total(matches.iter().map(Matched::weight));
    // Eq. (2)
    let similarity = equation_2::similarity(agreeing_weight, total_weight);
    let [unmatched_of_query, unmatched_of_candidate] =
        matcher.similar_pairs.unmatched(&of_query, &of_candidate);
    let contradictions = if settings.contradiction_veto {
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
        elsewhere,
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
    /// The disputed anchors, those of the query's map first.
    disputed: [BTreeSet<LocalName>; 2],
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
            Some(self.pair(of_query[i], of_candidate[j], judged))
        };
        pairs.into_iter().filter_map(matched).collect()
    }

    /// Returns the pairs of similar descriptions at different relative places that hang nowhere else.
    fn elsewhere<'a>(
        &self,
        of_query: &[&'a LocalAnchor],
        of_candidate: &[&'a LocalAnchor],
    ) -> Vec<Matched<'a>> {
        if !self.settings.aligned_anchors {
            return Vec::new();
        }
        let pairs = self
            .similar_pairs
            .iter()
            .map(|(i, similar)| (of_query[i], of_candidate[similar.candidate], &similar.judged));
        pairs
            // Were the two one object, it would hang in one place fewer than counted, and in more than one.
            .filter(|(a, b, _)| a.places.max(b.places) <= 2)
            .filter(|(a, b, _)| a.is_measured_with(b) && !same_relative_place(a, b, self.settings))
            .map(|(a, b, judged)| self.pair(a, b, judged.clone()))
            .filter(|pair| pair.places == 1)
            .collect()
    }

    fn pair<'a>(
        &self,
        query: &'a LocalAnchor,
        candidate: &'a LocalAnchor,
        (level, source): (u8, Source),
    ) -> Matched<'a> {
        let places = self.places_if_one(query, candidate);
        let [of_query, of_candidate] = &self.disputed;
        let is_disputed = of_query.contains(&query.name) || of_candidate.contains(&candidate.name);
        Matched { query, candidate, level, source, places, is_disputed }
    }

    /// In how many places what two anchors show hangs, were the two one object: one place fewer than counted, if the
    /// frame has them in two. A plate seen again after metres of drift hangs in one place; an exit sign seen at a second
    /// door as well, until there is a third.
    fn places_if_one(&self, query: &LocalAnchor, candidate: &LocalAnchor) -> usize {
        let places = query.places.max(candidate.places);
        if places == 1 || !query.is_measured_with(candidate) {
            return places;
        }
        let sighting = |anchor: &LocalAnchor| match (anchor.name, self.session) {
            (LocalName::MergedAnchor(root), Some(session)) => Sighting::of(self.index, root, session),
            (LocalName::Inline(_), Some(_)) => {
                Some(Sighting::inline(anchor.centre_in_session, &NO_KEYFRAMES))
            }
            (_, None) => None,
        };
        match sighting(query).zip(sighting(candidate)) {
            Some((a, b)) if !a.may_be_at(&b, self.index) && !a.shares_map_with(&b, self.index) => places - 1,
            _ => places,
        }
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
