//! From keyframes to places: the best keyframe of each covisible group.
//!
//! Keyframes that see the same thing crowd the top of any ranking. A *place* is a group by direct covisibility,
//! greedy from the best: the best keyframe stands for its place, those covisible with it drop out, and so on.

use std::cmp::Ordering;
use std::collections::HashSet;

use crate::domain::bow::{BowVector, Score};

/// How many of the best keyframes are looked at first for each place asked for; when they belong to too few
/// places, so many times more are looked at.
const RANKED_PER_PLACE: usize = 16;

/// Which keyframes may stand for a place, and how many are wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaceLimits {
    /// The most places.
    pub places_max: usize,
    /// The least score in [0, 1], itself allowed. A score of zero is never enough.
    pub min_score: f64,
}

impl PlaceLimits {
    /// Returns the least score in units; the product is exact. Casting keeps a limit beyond 1 out of reach.
    fn min_units(self) -> u32 {
        ((self.min_score * f64::from(BowVector::ONE)).ceil() as u32).max(1)
    }
}

/// A keyframe and its score.
pub type Ranked = (u32, Score);

/// Memory that searches reuse; it carries nothing from one to the next.
#[derive(Debug, Default)]
pub struct PlaceScratch {
    ranked: Vec<Ranked>,
    dropped: HashSet<u32>,
}

/// Returns the best-scoring keyframe of each place, best first.
///
/// `scores` gives every keyframe with its score, and may be asked for them more than once.
/// `excluded` keyframes neither stand for a place nor drop others. `tie` orders keyframes of equal score, the
/// smaller first. `neighbours` gives the keyframes directly covisible with one; it must be symmetric.
pub fn best_places<I: Iterator<Item = Ranked>, N: IntoIterator<Item = u32>>(
    scores: impl Fn() -> I,
    limits: PlaceLimits,
    excluded: impl Fn(u32) -> bool,
    tie: impl Fn(u32, u32) -> Ordering,
    neighbours: impl Fn(u32) -> N,
    scratch: &mut PlaceScratch,
) -> Vec<Ranked> {
    let PlaceScratch { ranked, dropped } = scratch;
    let best_first = |a: &Ranked, b: &Ranked| b.1.units().cmp(&a.1.units()).then_with(|| tie(a.0, b.0));
    let mut ranked_max = limits.places_max.saturating_mul(RANKED_PER_PLACE);
    loop {
        let complete = keep_best(scores(), limits.min_units(), &excluded, best_first, ranked_max, ranked);
        let places = greedy(ranked.iter().copied(), limits.places_max, &neighbours, dropped);
        if complete || places.len() >= limits.places_max {
            return places;
        }
        ranked_max = ranked_max.saturating_mul(RANKED_PER_PLACE);
    }
}

/// Returns the first keyframe of each place in a ranking made elsewhere, best first.
pub fn greedy_places<N: IntoIterator<Item = u32>>(
    ranked: impl IntoIterator<Item = u32>,
    places_max: usize,
    neighbours: impl Fn(u32) -> N,
    scratch: &mut PlaceScratch,
) -> Vec<u32> {
    let ranked = ranked.into_iter().map(|keyframe| (keyframe, ()));
    let places = greedy(ranked, places_max, &neighbours, &mut scratch.dropped);
    places.into_iter().map(|(keyframe, ())| keyframe).collect()
}

fn greedy<S, N: IntoIterator<Item = u32>>(
    ranked: impl Iterator<Item = (u32, S)>,
    places_max: usize,
    neighbours: &impl Fn(u32) -> N,
    dropped: &mut HashSet<u32>,
) -> Vec<(u32, S)> {
    dropped.clear();
    let mut places = Vec::new();
    for (keyframe, score) in ranked {
        if places.len() == places_max {
            break;
        }
        // A keyframe ranked twice is its own place's second.
        if dropped.insert(keyframe) {
            dropped.extend(neighbours(keyframe));
            places.push((keyframe, score));
        }
    }
    places
}

/// Leaves the best `max` keyframes in `best`, sorted, and tells whether those are all that qualify.
///
/// Nearly every keyframe of a large map is beaten by `max` others already seen, and costs one comparison of scores.
fn keep_best(
    scores: impl Iterator<Item = Ranked>,
    min_units: u32,
    excluded: &impl Fn(u32) -> bool,
    best_first: impl Fn(&Ranked, &Ranked) -> Ordering,
    max: usize,
    best: &mut Vec<Ranked>,
) -> bool {
    best.clear();
    let mut complete = true;
    let mut least_units = min_units;
    for (keyframe, score) in scores {
        if score.units() < least_units || excluded(keyframe) {
            continue;
        }
        best.push((keyframe, score));
        // Room for as many again, so that each selection is paid for by `max` keyframes.
        if best.len() > max.saturating_mul(2) {
            complete = false;
            best.select_nth_unstable_by(max, &best_first);
            best.truncate(max);
            least_units = best.iter().map(|&(_, score)| score.units()).min().unwrap_or(u32::MAX);
        }
    }
    best.sort_unstable_by(&best_first);
    complete &= best.len() <= max;
    best.truncate(max);
    complete
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::cmp::Reverse;
    use std::collections::BTreeMap;

    use proptest::prelude::*;

    use super::*;
    use crate::recognition::map::inverted_file::{InvertedFile, Scratch};

    type Graph = BTreeMap<u32, Vec<u32>>;

    fn graph(edges: &[(u32, u32)]) -> Graph {
        let mut graph = Graph::new();
        for &(a, b) in edges.iter().filter(|(a, b)| a != b) {
            graph.entry(a).or_default().push(b);
            graph.entry(b).or_default().push(a);
        }
        graph
    }

    fn of(graph: &Graph, keyframe: u32) -> Vec<u32> {
        graph.get(&keyframe).cloned().unwrap_or_default()
    }

    /// By the letter: sort everything, take the best, drop its neighbours, again.
    fn naive(
        scores: &[(u32, Score)],
        limits: PlaceLimits,
        excluded: u32,
        graph: &Graph,
    ) -> Vec<(u32, Score)> {
        let mut left: Vec<_> = scores
            .iter()
            .copied()
            .filter(|(keyframe, score)| {
                keyframe % excluded != 0 && score.units() > 0 && score.value() >= limits.min_score
            })
            .collect();
        // Ties to the larger id, to see that the caller's order is the one that counts.
        left.sort_by_key(|&(keyframe, score)| (Reverse(score.units()), Reverse(keyframe)));
        let mut places = Vec::new();
        while !left.is_empty() && places.len() < limits.places_max {
            let best = left.remove(0);
            places.push(best);
            left.retain(|(keyframe, _)| !of(graph, best.0).contains(keyframe));
        }
        places
    }

    /// Returns a keyframe of two words of which the query knows one: it scores about `share` of 64.
    fn file_of(shares: &[u32]) -> InvertedFile {
        let mut file = InvertedFile::default();
        for (keyframe, &share) in shares.iter().enumerate() {
            let entries = vec![(1, f64::from(share)), (2, f64::from(64 - share))];
            file.insert(keyframe as u32, &BowVector::normalised(entries).unwrap());
        }
        file
    }

    fn query() -> BowVector {
        BowVector::normalised(vec![(1, 1.0)]).unwrap()
    }

    proptest! {
        #[test]
        fn best_places_are_those_of_the_naive_search(
            shares in proptest::collection::vec(0_u32..64, 0..400),
            edges in proptest::collection::vec((0_u32..400, 0_u32..400), 0..4000),
            places_max in 0_usize..12,
            excluded in 2_u32..10,
            min_score in 0.0..0.8_f64,
        ) {
            let (file, graph) = (file_of(&shares), graph(&edges));
            let limits = PlaceLimits { places_max, min_score };
            let mut scratch = Scratch::default();
            let scores = file.score_all(&query(), &mut scratch);
            let all: Vec<_> = scores.iter().collect();

            let mut place_scratch = PlaceScratch::default();
            for _ in 0..2 {
                let found = best_places(
                    || scores.iter(), limits, |keyframe| keyframe % excluded == 0, |a, b| b.cmp(&a),
                    |keyframe| of(&graph, keyframe), &mut place_scratch,
                );
                prop_assert_eq!(&found, &naive(&all, limits, excluded, &graph));
            }
        }
    }

    #[test]
    fn one_large_group_does_not_hide_the_places_behind_it() {
        let shares: Vec<u32> = (0..1000).map(|keyframe| if keyframe < 990 { 60 } else { 10 }).collect();
        let crowd: Vec<u32> = (0..990).collect();
        let file = file_of(&shares);
        let mut scratch = Scratch::default();
        let scores = file.score_all(&query(), &mut scratch);
        let limits = PlaceLimits { places_max: 3, min_score: 0.0 };
        let crowd_of = |keyframe| if keyframe < 990 { crowd.clone() } else { vec![] };
        let found = best_places(
            || scores.iter(),
            limits,
            |_| false,
            |a, b| a.cmp(&b),
            crowd_of,
            &mut PlaceScratch::default(),
        );
        assert_eq!(found.iter().map(|&(keyframe, _)| keyframe).collect::<Vec<_>>(), [0, 990, 991]);
    }

    #[test]
    fn a_ranking_made_elsewhere_keeps_the_first_of_each_place() {
        let graph = graph(&[(7, 3), (3, 5), (9, 1)]);
        let found = greedy_places(
            [7, 3, 5, 7, 9, 1, 2],
            3,
            |keyframe| of(&graph, keyframe),
            &mut PlaceScratch::default(),
        );
        assert_eq!(found, [7, 5, 9]);
    }
}
