//! The few candidates of all maps that geometry looks at.
//!
//! The channels' rankings are fused over all maps: scores of words of one vocabulary may be compared from map to map, ranks
//! of words with ranks of signs.

use super::map_search::MapSearch;
use crate::recognition::loops::fusion::fuse;

/// Pairs of keyframes that one request verifies.
pub const VERIFICATIONS_MAX: usize = 20;
/// Pairs that have been looked at when it is asked whether a place is located. The pairs left over are for
/// [`super::likeness`]: to locate a place by views alone takes fewer than all.
pub const LOOKED_AT: [usize; 3] = [16, 18, VERIFICATIONS_MAX];
/// Candidates of each channel's ranking that count, over all maps. Those after them cannot be chosen by this channel, so a map
/// that has no better ones need not be loaded.
pub(in crate::recognition) const RANKED_MAX: usize = 60;

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
    let mut chosen = ranked(searches, hinted_map);
    chosen.truncate(VERIFICATIONS_MAX);
    chosen
}

/// Returns the candidates of all maps by the fusion of their ranks.
pub fn ranked(searches: &[MapSearch], hinted_map: Option<usize>) -> Vec<Chosen> {
    let candidate =
        |one: &Chosen| &searches[one.map].screenings[one.asked].candidates[one.candidate].candidate;
    let proposed = |one: &Chosen| &searches[one.map].proposed[one.asked][one.candidate];
    let words = |one: &Chosen| candidate(one).bow.score;
    let signs = |one: &Chosen| {
        let signs = &proposed(one).signs;
        signs.agreeing.len() as f64 - f64::from(signs.contradicting)
    };
    let global = |one: &Chosen| candidate(one).proposed.as_ref().and_then(|by| by.similarity).unwrap_or(0.0);
    let hinted = |one: &Chosen| {
        let is_hinted = hinted_map.is_none_or(|map| map == one.map) && proposed(one).is_hinted;
        if is_hinted { words(one) } else { 0.0 }
    };
    let id = |one: &Chosen| (one.map, &searches[one.map].sites[proposed(one).site].id, one.asked);
    let by_id = |a: &Chosen, b: &Chosen| id(a).cmp(&id(b));
    let all = candidates_of(searches);
    let ranking = |figure: &dyn Fn(&Chosen) -> f64| {
        let mut ranking: Vec<Chosen> = all.iter().copied().filter(|one| figure(one) > 0.0).collect();
        ranking.sort_by(|a, b| figure(b).total_cmp(&figure(a)).then_with(|| by_id(a, b)));
        ranking.truncate(RANKED_MAX);
        ((), ranking)
    };
    let rankings = [ranking(&words), ranking(&signs), ranking(&global), ranking(&hinted)];
    fuse(&rankings, |a, b| by_id(&a, &b)).into_iter().map(|(one, _)| one).collect()
}

/// Returns the score of words that a candidate of a further map must reach to be ranked; `None` while any would be.
pub fn score_to_reach<'s>(searches: impl Iterator<Item = &'s MapSearch>) -> Option<f64> {
    let candidates = searches.flat_map(|search| &search.screenings).flat_map(|one| &one.candidates);
    let mut scores: Vec<f64> = candidates.map(|one| one.candidate.bow.score).collect();
    scores.sort_by(|a, b| b.total_cmp(a));
    scores.get(RANKED_MAX - 1).copied().filter(|score| *score > 0.0)
}

/// Returns the candidates of all maps in the order of maps and keyframes.
fn candidates_of(searches: &[MapSearch]) -> Vec<Chosen> {
    let mut all = Vec::new();
    for (map, search) in searches.iter().enumerate() {
        for (asked, candidates) in search.proposed.iter().enumerate() {
            all.extend((0..candidates.len()).map(|candidate| Chosen { map, asked, candidate }));
        }
    }
    all
}
