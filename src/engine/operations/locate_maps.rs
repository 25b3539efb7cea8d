//! The maps of a question "where am I?": those in memory are searched; of the others, their words are read first, and only
//! those are loaded that have a candidate which might be chosen.

use std::cmp::Reverse;
use std::collections::BTreeSet;
use std::sync::Arc;

use tokio::time::Instant;

use super::queries::{Timings, timed};
use crate::domain::bow::{BowVector, Score};
use crate::domain::ids::MapId;
use crate::domain::invalid::FieldError;
use crate::domain::key::MapPattern;
use crate::domain::keyframe::Detection;
use crate::engine::bow::check_vocabulary;
use crate::engine::maps::live::{LiveMap, State};
use crate::engine::{Service, ServiceError};
use crate::recognition::locate::map_search::{LocateQuestion, MapSearch, search_map};
use crate::recognition::locate::selection::score_to_reach;
use crate::store::MapOutline;

/// Maps that one request asks, at most.
pub const LOCATE_MAPS_MAX: usize = 64;

/// Map names read in one statement.
const LISTED_AT_ONCE: usize = 200;

/// A map that was asked.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AskedMap {
    /// The map.
    pub id: MapId,
    /// The version that was asked.
    pub version: u64,
    /// Whether its words are of the keyframes' vocabulary, so that they were compared.
    pub are_words_compared: bool,
}

/// A map of the question.
#[derive(Debug)]
pub(super) struct MapOfQuestion {
    /// What the answer says of it.
    pub asked: AskedMap,
    /// The map in memory, where it was searched. It stays there until the question is answered.
    pub live: Option<Arc<LiveMap>>,
    /// Its findings.
    pub search: MapSearch,
}

/// A map that is not in memory, and what its words say.
struct Unloaded {
    id: MapId,
    version: u64,
    are_words_compared: bool,
    /// The best score of its keyframes; `None` where only a search can tell.
    best: Option<Score>,
}

impl Service {
    /// Returns the names of the maps to ask, ascending.
    pub(super) async fn maps_to_ask(
        &self,
        patterns: &[MapPattern],
        reaches: impl Fn(&MapId) -> bool,
    ) -> Result<Vec<MapId>, ServiceError> {
        let mut ids: BTreeSet<MapId> = BTreeSet::new();
        // A name without a star must exist; a pattern may name nothing.
        for named in patterns.iter().filter_map(MapPattern::only_map) {
            if !reaches(&named) {
                return Err(ServiceError::no_map(&named));
            }
            self.key_of(&named).await?;
            ids.insert(named);
        }
        let is_wanted = |id: &MapId| {
            reaches(id) && (patterns.is_empty() || patterns.iter().any(|pattern| pattern.matches(id)))
        };
        let needs_listing =
            patterns.is_empty() || patterns.iter().any(|pattern| pattern.only_map().is_none());
        let mut after: Option<MapId> = None;
        while needs_listing && ids.len() <= LOCATE_MAPS_MAX {
            let page = self.store.map_ids(after.as_ref(), LISTED_AT_ONCE).await?;
            let is_last = page.len() < LISTED_AT_ONCE;
            after = page.last().cloned();
            ids.extend(page.into_iter().filter(is_wanted));
            if is_last {
                break;
            }
        }
        if ids.len() > LOCATE_MAPS_MAX {
            let fault = FieldError::new("/maps", "the request asks more maps than one request may");
            let fault = fault.got(format!("at least {} maps", ids.len()));
            return Err(ServiceError::Invalid(vec![
                fault.limit(format!("{LOCATE_MAPS_MAX} maps; name fewer")),
            ]));
        }
        Ok(ids.into_iter().collect())
    }

    /// Searches these maps; those that were deleted meanwhile are left out. In the order of their names, and the same whichever
    /// of them were in memory.
    pub(super) async fn search_maps(
        &self,
        ids: Vec<MapId>,
        question: &Arc<LocateQuestion>,
        hinted_map: Option<&MapId>,
        timings: &mut Timings,
    ) -> Result<Vec<MapOfQuestion>, ServiceError> {
        let (mut found, mut unloaded) = (Vec::new(), Vec::new());
        for id in ids {
            if self.registry.in_memory_now(&id).is_some() {
                found.extend(self.search(&id, question, timings).await?);
            } else {
                unloaded.extend(self.read_words(id, question, hinted_map).await?);
            }
        }
        // The most promising first: they show of the most others that these need not be loaded.
        unloaded.sort_by_key(|map| Reverse(map.best.map_or(u32::MAX, Score::units)));
        for map in unloaded {
            let is_passed_over = map.best.is_some_and(|best| {
                let to_reach = score_to_reach(found.iter().map(|of: &MapOfQuestion| &of.search));
                best.units() == 0 || to_reach.is_some_and(|to_reach| best.value() < to_reach)
            });
            if is_passed_over {
                let Unloaded { id, version, are_words_compared, .. } = map;
                let is_without_words = !are_words_compared || is_without_words(question);
                let search = MapSearch::passed_over(version, is_without_words);
                found.push(MapOfQuestion {
                    asked: AskedMap { id, version, are_words_compared },
                    live: None,
                    search,
                });
            } else {
                found.extend(self.search(&map.id, question, timings).await?);
            }
        }
        found.sort_by(|a, b| a.asked.id.cmp(&b.asked.id));
        Ok(found)
    }

    /// Reads the words of a map that is not in memory; none if it was deleted meanwhile.
    async fn read_words(
        &self,
        id: MapId,
        question: &LocateQuestion,
        hinted_map: Option<&MapId>,
    ) -> Result<Option<Unloaded>, ServiceError> {
        let vectors: Vec<BowVector> =
            question.keyframes.iter().map(|asked| asked.keyframe.bow.clone()).collect();
        let are_words_compared = |outline: &MapOutline| {
            question.keyframes.iter().all(|asked| {
                let theirs = asked.keyframe.vocabulary.as_deref().filter(|_| !asked.keyframe.bow.is_empty());
                theirs.zip(outline.vocabulary.as_deref()).is_none_or(|(theirs, ours)| theirs == ours)
            })
        };
        // Signs, global descriptors and a hint have rankings of their own.
        let do_words_decide = |outline: &MapOutline| {
            let is_hinted = match hinted_map {
                Some(hinted) => *hinted == id,
                None => question.hint.is_some(),
            };
            let keyframes = || question.keyframes.iter().map(|asked| &asked.keyframe);
            let are_signs_asked =
                outline.has_anchors && keyframes().flat_map(|one| &one.detections).any(has_text);
            let is_global_asked =
                outline.has_globals && keyframes().any(|one| one.global_descriptor.is_some());
            !is_hinted && !are_signs_asked && !is_global_asked
        };
        let is_wanted = |outline: &MapOutline| do_words_decide(outline) && are_words_compared(outline);
        let read = self.store.best_score(&id, &vectors, is_wanted).await?;
        Ok(read.map(|(outline, best)| Unloaded {
            version: outline.version,
            are_words_compared: are_words_compared(&outline),
            best: do_words_decide(&outline).then_some(best),
            id: id.clone(),
        }))
    }

    /// Searches one map; none if it was deleted meanwhile.
    async fn search(
        &self,
        id: &MapId,
        question: &Arc<LocateQuestion>,
        timings: &mut Timings,
    ) -> Result<Option<MapOfQuestion>, ServiceError> {
        let started = Instant::now();
        let live = match self.live(id).await {
            Err(ServiceError::NotFound(_)) => return Ok(None),
            live => live?,
        };
        let asked = question.clone();
        let searched = self.read(&live, move |state| {
            let (searched, took_ms) = timed(|| {
                let are_words_compared =
                    asked.keyframes.iter().all(|one| check_vocabulary(&state.index, &one.keyframe).is_ok());
                (search_at(state, &asked, are_words_compared), are_words_compared)
            });
            Ok((searched, took_ms))
        });
        let (version, ((search, are_words_compared), took_ms)) = match searched.await {
            Err(ServiceError::NotFound(_)) => return Ok(None),
            searched => searched?,
        };
        timings.note(started, took_ms, |timings| &mut timings.screen_ms);
        let asked = AskedMap { id: id.clone(), version, are_words_compared };
        Ok(Some(MapOfQuestion { asked, live: Some(live), search }))
    }
}

fn has_text(detection: &Detection) -> bool {
    detection.text.is_some() || detection.description.is_some()
}

fn is_without_words(question: &LocateQuestion) -> bool {
    question.keyframes.iter().all(|asked| asked.keyframe.bow.is_empty())
}

/// Searches a map as it stands.
pub(super) fn search_at(state: &State, question: &LocateQuestion, are_words_compared: bool) -> MapSearch {
    if are_words_compared {
        search_map(&state.index, state.version, question)
    } else {
        search_map(&state.index, state.version, &without_words(question))
    }
}

/// Returns the question without its words, for a map whose words are of another vocabulary.
fn without_words(question: &LocateQuestion) -> LocateQuestion {
    let mut question = question.clone();
    for asked in &mut question.keyframes {
        asked.keyframe.bow = BowVector::default();
    }
    question
}
