//! The maps of a question "where am I?": those in memory are searched, and those that there is room for are loaded. Of the
//! others the words are read, and only those are loaded that have a candidate which might be chosen.

use std::cmp::Reverse;
use std::collections::BTreeSet;
use std::sync::Arc;

use tokio::runtime::Handle;
use tokio::time::Instant;

use super::queries::{Timings, timed};
use super::releases::no_release;
use crate::domain::bow::{BowVector, Score};
use crate::domain::ids::{MapId, ReleaseName};
use crate::domain::invalid::FieldError;
use crate::domain::key::MapPattern;
use crate::domain::keyframe::Detection;
use crate::engine::limits::shared_turns::Tenant;
use crate::engine::maps::live::{LiveMap, State};
use crate::engine::tasks::blocking_part;
use crate::engine::{Result, Service, ServiceError};
use crate::recognition::anchors::ingest::other_vocabulary;
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
    /// Its part of the answer.
    pub asked: AskedMap,
    /// The map in memory, where it was searched. It stays there until the question is answered.
    pub live: Option<Arc<LiveMap>>,
}

/// A map that is not in memory, and the finding of its words.
struct Unloaded {
    asked: AskedMap,
    /// The best score of its keyframes; `None` where it is to be loaded.
    best: Option<Score>,
}

impl Service {
    /// Returns the names of the maps to ask, ascending.
    pub(super) async fn maps_to_ask(
        &self,
        patterns: &[MapPattern],
        reaches: impl Fn(&MapId) -> bool,
    ) -> Result<Vec<MapId>> {
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
            return Err(fault.limit(format!("{LOCATE_MAPS_MAX} maps; name fewer")).into());
        }
        Ok(ids.into_iter().collect())
    }

    /// Returns the releases of this name of the maps to ask. A map that was named without a star must have one.
    pub(super) async fn releases_to_ask(
        &self,
        ids: Vec<MapId>,
        name: &ReleaseName,
        patterns: &[MapPattern],
    ) -> Result<Vec<MapId>> {
        let mut releases = Vec::new();
        for id in ids {
            let release = id.of_release(name);
            if self.store.map_key(&release).await?.is_some() {
                releases.push(release);
            } else if patterns.iter().any(|pattern| pattern.only_map().as_ref() == Some(&id)) {
                return Err(no_release(&id, name));
            }
        }
        Ok(releases)
    }

    /// Searches these maps; those that were deleted meanwhile are left out. In the order of their names, and the same whichever
    /// of them were in memory.
    pub(super) async fn search_maps(
        &self,
        ids: Vec<MapId>,
        question: &Arc<LocateQuestion>,
        hinted_map: Option<&MapId>,
        timings: &mut Timings,
    ) -> Result<(Vec<MapOfQuestion>, Vec<MapSearch>)> {
        let (mut found, mut unloaded, mut promised_bytes) = (Vec::new(), Vec::new(), 0);
        for id in ids {
            if self.registry.in_memory_now(&id).is_some() {
                found.extend(self.search(&id, question, timings).await?);
            } else {
                let is_hinted = question.hint.is_some() || hinted_map == Some(&id);
                let read = self.read_words(id, question, is_hinted, &mut promised_bytes, timings);
                unloaded.extend(read.await?);
            }
        }
        // The most promising first: they show of the most others that these need not be loaded.
        unloaded.sort_by_key(|map| Reverse(map.best.map_or(u32::MAX, Score::units)));
        for Unloaded { asked, best } in unloaded {
            let is_passed_over = best.is_some_and(|best| {
                let to_reach = score_to_reach(found.iter().map(|(_, search)| search));
                best.units() == 0 || to_reach.is_some_and(|to_reach| best.value() < to_reach)
            });
            if is_passed_over {
                let is_without_words = !asked.are_words_compared || question.is_without_words();
                // It has no candidate which would be chosen.
                let search = MapSearch { version: asked.version, is_without_words, ..MapSearch::default() };
                found.push((MapOfQuestion { asked, live: None }, search));
            } else {
                found.extend(self.search(&asked.id, question, timings).await?);
            }
        }
        found.sort_by(|(a, _), (b, _)| a.asked.id.cmp(&b.asked.id));
        Ok(found.into_iter().unzip())
    }

    /// Reads the words of a map that is not in memory, unless there is room for it or they do not decide; none if it was deleted
    /// meanwhile. `promised_bytes` is the room that is already promised to other maps.
    async fn read_words(
        &self,
        id: MapId,
        question: &Arc<LocateQuestion>,
        is_hinted: bool,
        promised_bytes: &mut u64,
        timings: &mut Timings,
    ) -> Result<Option<Unloaded>> {
        let started = Instant::now();
        let permit = self.reads.enter(Tenant::current(None)).await?;
        let (store, registry, handle) = (self.store.clone(), self.registry.clone(), Handle::current());
        let (asked, promised) = (question.clone(), *promised_bytes);
        let reading = move || {
            let is_room = |outline: &MapOutline| {
                registry.memory.excess(promised.saturating_add(outline.memory_bytes)) == 0
            };
            let vectors: Vec<&BowVector> = asked.keyframes.iter().map(|one| &one.keyframe.bow).collect();
            let is_wanted =
                |outline: &MapOutline| !is_hinted && do_words_decide(&asked, outline) && !is_room(outline);
            let does_score = |outline: &MapOutline| {
                is_wanted(outline) && are_words_compared(&asked, outline.vocabulary.as_deref())
            };
            let (read, took_ms) = timed(|| handle.block_on(store.best_score(&id, &vectors, does_score)));
            let read = read?.map(|(outline, best)| {
                let best = is_wanted(&outline).then_some(best);
                let promised = if best.is_none() { outline.memory_bytes } else { 0 };
                let are_words_compared = are_words_compared(&asked, outline.vocabulary.as_deref());
                (
                    Unloaded { asked: AskedMap { id, version: outline.version, are_words_compared }, best },
                    promised,
                )
            });
            Ok::<_, ServiceError>((read, took_ms))
        };
        let (read, took_ms) = blocking_part("prefilter", reading).await??;
        drop(permit);
        timings.note(started, took_ms, |timings| &mut timings.screen_ms);
        Ok(read.map(|(map, promised)| {
            *promised_bytes += promised;
            map
        }))
    }

    /// Searches one map; none if it was deleted meanwhile.
    async fn search(
        &self,
        id: &MapId,
        question: &Arc<LocateQuestion>,
        timings: &mut Timings,
    ) -> Result<Option<(MapOfQuestion, MapSearch)>> {
        let started = Instant::now();
        let live = match self.live_or_copy(id).await {
            Err(ServiceError::NotFound(_)) => return Ok(None),
            live => live?,
        };
        let asked = question.clone();
        let searched = self.read(&live, move |state| {
            let (searched, took_ms) = timed(|| {
                let are_words_compared = are_words_compared(&asked, state.index.vocabulary());
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
        Ok(Some((MapOfQuestion { asked, live: Some(live) }, search)))
    }
}

fn has_text(detection: &Detection) -> bool {
    detection.text.is_some() || detection.description.is_some()
}

/// Whether nothing but words can propose a candidate: signs and global descriptors have rankings of their own.
fn do_words_decide(question: &LocateQuestion, map: &MapOutline) -> bool {
    let keyframes = || question.keyframes.iter().map(|asked| &asked.keyframe);
    let are_signs_asked = map.has_anchors && keyframes().flat_map(|one| &one.detections).any(has_text);
    let is_global_asked = map.has_globals && keyframes().any(|one| one.global_descriptor.is_some());
    !are_signs_asked && !is_global_asked
}

fn are_words_compared(question: &LocateQuestion, of_map: Option<&str>) -> bool {
    question.keyframes.iter().all(|asked| other_vocabulary(of_map, &asked.keyframe).is_none())
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
