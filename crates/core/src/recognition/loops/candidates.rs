//! Candidates: checks 1 and 2 of §V, the second channel of §III, and ours by global descriptors (M54).
//!
//! Keyframes covisible with the query are excluded. Of the others, bag of words brings the best
//! of each place; and so do the anchors that the query sees and that match one seen before,
//! on another passage: an anchor seen again triggers loop detection even where the words fail.
//! A query with a global descriptor has a third channel, and the channels' rankings are fused.

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet, HashSet};

use super::evidence;
use super::fusion::fuse;
use super::query::Query;
use crate::domain::bow::Score;
use crate::domain::channel::{Channel, ProposedBy};
use crate::domain::ids::{AnchorSeq, KeyframeSeq};
use crate::domain::verdict::Candidate;
use crate::recognition::anchors::matching;
use crate::recognition::extensions::distinctiveness::PlaceCounts;
use crate::recognition::map::covisible_groups::{
    PlaceLimits, PlaceScratch, Ranked, best_places, greedy_places,
};
use crate::recognition::map::index::{Anchor, MapIndex, MergedAnchor};
use crate::recognition::map::inverted_file::{Scores, Scratch};

/// An anchor that stands in more places than this proposes only the oldest of them: it says next
/// to nothing about which, and a thousand EXIT signs must not cost a thousand looks.
pub(in crate::recognition) const MAX_REVISITS_PER_ANCHOR: usize = 64;

/// Maximum keyframes of a place that a near miss verifies, which bounds the cost of a query.
pub(in crate::recognition) const NEAR_MISS_NEIGHBOURS: usize = 5;

/// A candidate of some channel.
#[derive(Clone, Debug, PartialEq)]
pub struct Proposal {
    /// The keyframe.
    pub keyframe: KeyframeSeq,
    /// Its bag-of-words score against the query.
    pub score: Score,
    /// The channels that proposed it; without a global descriptor of the query's, the first that did.
    pub channels: Vec<Channel>,
    /// Other keyframes of the place, covisible with it, by score; where a near miss asks them.
    pub neighbours: Vec<(KeyframeSeq, Score)>,
}

impl Proposal {
    /// Whether a channel proposed it.
    pub fn is_by(&self, channel: Channel) -> bool {
        self.channels.contains(&channel)
    }

    /// Whether bag of words alone vouches for it, so that it must score its share of the reference.
    pub fn is_gated(&self) -> bool {
        self.is_by(Channel::Bow) && !self.is_by(Channel::Global)
    }
}

/// The candidates, and the reference score.
#[derive(Clone, Debug, PartialEq)]
pub struct Proposals {
    /// By bag of words first, then by anchors; of a query with a global descriptor, by the fusion of all channels. No keyframe
    /// twice.
    pub candidates: Vec<Proposal>,
    /// How alike the map's global descriptors are to the query's, ascending by keyframe; `None` where the query has none.
    pub likenesses: Option<Vec<Ranked>>,
    /// The lowest score of the query against its covisible keyframes; 0 without any (M9).
    pub reference_score: f64,
}

impl Proposals {
    /// Whether a keyframe is a candidate.
    pub fn has(&self, keyframe: KeyframeSeq) -> bool {
        self.candidates.iter().any(|candidate| candidate.keyframe == keyframe)
    }

    /// Returns a candidate that these channels proposed, before check 3; none if its keyframe was culled.
    pub fn unchecked(
        &self,
        index: &MapIndex,
        keyframe: KeyframeSeq,
        score: Score,
        channels: &[Channel],
    ) -> Option<Candidate> {
        let mut candidate = evidence::unchecked(index, keyframe, score, self.reference_score)?;
        candidate.proposed = self.likenesses.as_ref().map(|likenesses| {
            let at = likenesses.binary_search_by_key(&keyframe.0, |(keyframe, _)| *keyframe);
            let similarity = at.ok().map(|at| likenesses[at].1.value());
            ProposedBy { channels: channels.to_vec(), similarity }
        });
        Some(candidate)
    }
}

thread_local! {
    /// Searches of one thread share their memory; it carries nothing from one to the next.
    static SCRATCH: RefCell<(Scratch, PlaceScratch)> = RefCell::default();
}

/// Finds the candidates of a query.
pub fn find_candidates(index: &MapIndex, query: &Query<'_>, places: &mut PlaceCounts) -> Proposals {
    SCRATCH.with_borrow_mut(|(scratch, place_scratch)| {
        let scores = index.inverted_file().score_all(query.bow, scratch);
        let reference_score = query
            .covisible()
            .map(|keyframe| scores.get(keyframe.0).value())
            .min_by(f64::total_cmp)
            .unwrap_or(0.0);
        let bow = best_of_places(index, query, || scores.iter(), place_scratch);
        let anchors = by_anchors(index, query, &scores, places, place_scratch);
        let likenesses = likenesses(index, query);
        let found = match &likenesses {
            None => first_come(bow, anchors),
            Some(likenesses) => {
                let likenesses = || likenesses.iter().copied();
                let global = best_of_places(index, query, likenesses, place_scratch);
                let rankings = [(Channel::Bow, bow), (Channel::Anchors, anchors), (Channel::Global, global)];
                fuse(&rankings, |a, b| by_id(index)(a.0, b.0))
            }
        };
        let proposal = |(keyframe, channels): (KeyframeSeq, _)| {
            let score = scores.get(keyframe.0);
            Proposal { keyframe, score, channels, neighbours: Vec::new() }
        };
        let mut candidates: Vec<Proposal> = found.into_iter().map(proposal).collect();
        if index.properties().settings.is_ours() && query.snapshot.is_some() {
            for candidate in &mut candidates {
                candidate.neighbours = best_neighbours(index, query, candidate.keyframe, &scores);
            }
        }
        Proposals { candidates, likenesses, reference_score }
    })
}

/// Returns the candidates of the paper's two channels, those of the first before those of the second.
fn first_come(bow: Vec<KeyframeSeq>, anchors: Vec<KeyframeSeq>) -> Vec<(KeyframeSeq, Vec<Channel>)> {
    let known: HashSet<KeyframeSeq> = bow.iter().copied().collect();
    let anchors = anchors.into_iter().filter(|keyframe| !known.contains(keyframe));
    let of = |channel| move |keyframe| (keyframe, vec![channel]);
    bow.into_iter().map(of(Channel::Bow)).chain(anchors.map(of(Channel::Anchors))).collect()
}

/// Returns how alike the map's global descriptors are to the query's, ascending by keyframe; `None` where the query does not
/// use the channel.
fn likenesses(index: &MapIndex, query: &Query<'_>) -> Option<Vec<Ranked>> {
    let sought = query.global.as_ref().filter(|_| index.properties().settings.is_ours())?;
    let mut likenesses = Vec::new();
    index.globals().score_all(sought, &mut likenesses);
    Some(likenesses)
}

/// Returns the best-scoring keyframe of each place, best first.
fn best_of_places<I: Iterator<Item = Ranked>>(
    index: &MapIndex,
    query: &Query<'_>,
    scores: impl Fn() -> I,
    scratch: &mut PlaceScratch,
) -> Vec<KeyframeSeq> {
    let limits =
        PlaceLimits { places_max: index.properties().settings.candidates_max as usize, min_score: 0.0 };
    let excluded = |keyframe| is_excluded(index, query, KeyframeSeq(keyframe));
    let near = |keyframe| neighbours(index, keyframe);
    let best = best_places(scores, limits, excluded, by_id(index), near, scratch);
    best.into_iter().map(|(keyframe, _)| KeyframeSeq(keyframe)).collect()
}

/// Keyframes that see an anchor seen again, ranked by how distinctive those anchors are together,
/// then by bag of words.
fn by_anchors(
    index: &MapIndex,
    query: &Query<'_>,
    scores: &Scores<'_>,
    places: &mut PlaceCounts,
    scratch: &mut PlaceScratch,
) -> Vec<KeyframeSeq> {
    let mut votes: BTreeMap<KeyframeSeq, f64> = BTreeMap::new();
    let mut vote = |keyframes: BTreeSet<KeyframeSeq>, places: usize| {
        for keyframe in keyframes.into_iter().filter(|keyframe| !is_excluded(index, query, *keyframe)) {
            *votes.entry(keyframe).or_default() += 1.0 / places as f64;
        }
    };
    let keyframes_of =
        |root| index.objects().get(root).map(|object| index.keyframes_of(object)).unwrap_or_default();
    for root in &query.seen {
        let Some(object) = index.objects().get(*root) else { continue };
        let stands = index.texts().of(*root).map_or(1, |text| places.of_text(index, text));
        vote(other_passages(index, query, object), stands);
        for other in matching::revisits(index, *root).take(MAX_REVISITS_PER_ANCHOR) {
            vote(keyframes_of(other), stands);
        }
    }
    for text in query.inline_texts(index) {
        let stands = places.of_text(index, text);
        for other in index.texts().objects(text).take(MAX_REVISITS_PER_ANCHOR) {
            vote(keyframes_of(other), stands);
        }
    }
    let mut ranked: Vec<(KeyframeSeq, f64)> = votes.into_iter().collect();
    ranked.sort_by(|(a, votes_a), (b, votes_b)| {
        (votes_b.total_cmp(votes_a))
            .then_with(|| scores.get(b.0).units().cmp(&scores.get(a.0).units()))
            .then_with(|| by_id(index)(a.0, b.0))
    });
    let ranked = ranked.into_iter().map(|(keyframe, _)| keyframe.0);
    let places_max = index.properties().settings.candidates_max as usize;
    let near = |keyframe| neighbours(index, keyframe);
    greedy_places(ranked, places_max, near, scratch).into_iter().map(KeyframeSeq).collect()
}

/// Returns the keyframes that see an object that the query sees too, on another passage: through an anchor merged by a
/// confirmed loop, or in another session. Not those that merely tracked it through this same passage (M10).
fn other_passages(index: &MapIndex, query: &Query<'_>, object: &MergedAnchor) -> BTreeSet<KeyframeSeq> {
    let mine: BTreeSet<AnchorSeq> = object
        .members
        .iter()
        .filter(|member| {
            let mut keyframes = index.anchor(**member).into_iter().flat_map(Anchor::keyframes);
            keyframes.any(|keyframe| query.passes_with(index, keyframe))
        })
        .flat_map(|member| index.objects().same_passage(*member))
        .collect();
    let session = query.centre.session;
    let elsewhere = |member: AnchorSeq, keyframe: &KeyframeSeq| {
        !mine.contains(&member) || index.session_of(*keyframe) != session
    };
    let members = object.members.iter().filter_map(|member| Some((*member, index.anchor(*member)?)));
    members
        .flat_map(|(member, anchor)| anchor.keyframes().filter(move |keyframe| elsewhere(member, keyframe)))
        .collect()
}

/// Returns the keyframes of a candidate's place that look most like the query, and share a word with it.
fn best_neighbours(
    index: &MapIndex,
    query: &Query<'_>,
    candidate: KeyframeSeq,
    scores: &Scores<'_>,
) -> Vec<(KeyframeSeq, Score)> {
    let near = index.covisibility().neighbours(candidate).filter(|other| !is_excluded(index, query, *other));
    let scored = near.map(|other| (other, scores.get(other.0)));
    let mut scored: Vec<_> = scored.filter(|(_, score)| score.units() > 0).collect();
    let best_first = |a: &(KeyframeSeq, Score), b: &(KeyframeSeq, Score)| {
        b.1.units().cmp(&a.1.units()).then_with(|| by_id(index)(a.0.0, b.0.0))
    };
    // Thousands of keyframes may see one place.
    if scored.len() > NEAR_MISS_NEIGHBOURS {
        scored.select_nth_unstable_by(NEAR_MISS_NEIGHBOURS, best_first);
        scored.truncate(NEAR_MISS_NEIGHBOURS);
    }
    scored.sort_by(best_first);
    scored
}

/// Whether a keyframe is no candidate: covisible with the query (check 1), too recent (M53), or left out by who asks.
fn is_excluded(index: &MapIndex, query: &Query<'_>, keyframe: KeyframeSeq) -> bool {
    query.excludes(keyframe) || query.is_too_recent(index, keyframe) || query.left_out.contains(&keyframe)
}

/// Returns the numbers of the keyframes covisible with one.
fn neighbours(index: &MapIndex, keyframe: u32) -> impl Iterator<Item = u32> + '_ {
    index.covisibility().neighbours(KeyframeSeq(keyframe)).map(|other| other.0)
}

/// Ties go to the smallest id, as the client named it: dense numbers depend on the order of arrival.
fn by_id(index: &MapIndex) -> impl Fn(u32, u32) -> std::cmp::Ordering {
    |a, b| {
        let id = |keyframe| index.keyframe(KeyframeSeq(keyframe)).map(|keyframe| &keyframe.id);
        id(a).cmp(&id(b))
    }
}
