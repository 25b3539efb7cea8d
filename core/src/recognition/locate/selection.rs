//! The few candidates of all maps that geometry looks at.
//!
//! The channels' orders are fused by reciprocal rank (G. V. Cormack, C. L. A. Clarke, S. Buettcher, SIGIR 2009), over all
//! maps: scores of words of one vocabulary may be compared from map to map, ranks of words with ranks of signs.

use std::cmp::Ordering;

use super::map_search::MapSearch;

/// Pairs of keyframes that one request verifies.
pub const VERIFICATIONS_MAX: usize = 20;
/// Of these, pairs with the best candidates of different places; the rest are neighbours of the first ones.
pub(in crate::recognition) const PLACES_VERIFIED_MAX: usize = 14;
/// The constant of reciprocal rank fusion.
pub(in crate::recognition) const RANK_OFFSET: f64 = 60.0;

/// A candidate that geometry looks at.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Chosen {
    /// The map, by its number.
    pub map: usize,
    /// The keyframe that asks, by its number.
    pub asked: usize,
    /// The candidate, by its number among those of this keyframe in this map.
    pub candidate: usize,
}

/// Returns the candidates that geometry looks at, the most promising first. Those of the hinted map, or of any map where no
/// map is hinted, that lie where the hint has the camera are a channel of their own.
pub fn select(searches: &[MapSearch], hinted_map: Option<usize>) -> Vec<Chosen> {
    let ranked = ranked(searches, hinted_map);
    let mut chosen: Vec<Chosen> = ranked.iter().take(PLACES_VERIFIED_MAX).copied().collect();
    // Neighbours bear a place out. Where there are none, further places take their turn.
    for first in ranked.iter().take(PLACES_VERIFIED_MAX) {
        let neighbours = &searches[first.map].proposed[first.asked][first.candidate].neighbours;
        chosen.extend(neighbours.iter().map(|candidate| Chosen { candidate: *candidate, ..*first }));
        if chosen.len() >= VERIFICATIONS_MAX {
            break;
        }
    }
    chosen.extend(ranked.iter().skip(PLACES_VERIFIED_MAX));
    chosen.truncate(VERIFICATIONS_MAX);
    chosen
}

/// Returns the candidates of all maps, without the neighbours, by the sum of their reciprocal ranks.
pub fn ranked(searches: &[MapSearch], hinted_map: Option<usize>) -> Vec<Chosen> {
    let all = || {
        searches.iter().enumerate().flat_map(|(map, search)| {
            search.proposed.iter().enumerate().flat_map(move |(asked, candidates)| {
                let is_place = |(_, one): &(usize, &super::map_search::Proposed)| !one.is_neighbour;
                let places = candidates.iter().enumerate().filter(is_place);
                places.map(move |(candidate, _)| Chosen { map, asked, candidate })
            })
        })
    };
    let score =
        |one: &Chosen| searches[one.map].screenings[one.asked].candidates[one.candidate].candidate.bow.score;
    let signs = |one: &Chosen| {
        let signs = &searches[one.map].proposed[one.asked][one.candidate].signs;
        signs.agreeing.len() as f64 - f64::from(signs.contradicting)
    };
    let id = |one: &Chosen| {
        let search = &searches[one.map];
        (one.map, &search.sites[search.proposed[one.asked][one.candidate].site].id, one.asked)
    };
    let global = |one: &Chosen| {
        let candidate = &searches[one.map].screenings[one.asked].candidates[one.candidate].candidate;
        candidate.proposed.as_ref().and_then(|proposed| proposed.similarity).unwrap_or(0.0)
    };
    let hinted = |one: &Chosen| {
        let is_of_map = hinted_map.is_none_or(|map| map == one.map);
        let is_hinted = is_of_map && searches[one.map].proposed[one.asked][one.candidate].is_hinted;
        if is_hinted { score(one) } else { 0.0 }
    };
    let channels: [&dyn Fn(&Chosen) -> f64; 4] = [&score, &signs, &global, &hinted];
    let mut fused: Vec<(Chosen, f64)> = all().map(|one| (one, 0.0)).collect();
    for channel in channels {
        let mut order: Vec<usize> = (0..fused.len()).filter(|at| channel(&fused[*at].0) > 0.0).collect();
        order.sort_by(|a, b| {
            let (a, b) = (&fused[*a].0, &fused[*b].0);
            channel(b).total_cmp(&channel(a)).then_with(|| id(a).cmp(&id(b)))
        });
        for (rank, at) in order.into_iter().enumerate() {
            fused[at].1 += 1.0 / (RANK_OFFSET + rank as f64 + 1.0);
        }
    }
    let best_first = |(a, fused_a): &(Chosen, f64), (b, fused_b): &(Chosen, f64)| -> Ordering {
        fused_b.total_cmp(fused_a).then_with(|| id(a).cmp(&id(b)))
    };
    fused.sort_by(best_first);
    fused.into_iter().map(|(one, _)| one).collect()
}
