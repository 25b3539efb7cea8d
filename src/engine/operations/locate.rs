//! "Where am I?": one or several keyframes against the maps that a caller may query.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use tokio::task::spawn_blocking;
use tokio::time::Instant;

use super::queries::{Timings, milliseconds_since, timed};
use crate::config::logging::in_part;
use crate::domain::bow::BowVector;
use crate::domain::ids::{KeyframeSeq, MapId, SessionSeq};
use crate::domain::invalid::FieldError;
use crate::domain::key::MapPattern;
use crate::domain::location::{AskedKeyframe, LocateRequest, Location, LocationVerdict};
use crate::engine::bow::check_vocabulary;
use crate::engine::maps::live::{LiveMap, State};
use crate::engine::{Service, ServiceError};
use crate::recognition::locate::locate;
use crate::recognition::locate::map_search::{LocateQuestion, MapSearch, search_map};
use crate::recognition::locate::selection::{Chosen, LOOKED_AT_FIRST, select};
use crate::recognition::locate::views::{View, look};
use crate::recognition::loops::features::{FeatureSet, MatchableFeatures};
use crate::recognition::loops::geometry_check::PlacedQuery;

/// Maps that one request asks, at most.
pub const LOCATE_MAPS_MAX: usize = 64;

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

/// The place of the camera, and the maps that were asked.
#[derive(Clone, Debug, PartialEq)]
pub struct LocateAnswer {
    /// The maps, in the order of their names.
    pub maps: Vec<AskedMap>,
    /// The answer.
    pub location: Location,
    /// What it took.
    pub timings: Timings,
}

impl Service {
    /// Answers where the keyframes were taken, among the maps that exist for the caller. Changes nothing, and calls no model.
    pub async fn locate(
        &self,
        request: LocateRequest,
        reaches: impl Fn(&MapId) -> bool,
    ) -> Result<LocateAnswer, ServiceError> {
        let ids = self.maps_to_ask(&request.maps, reaches).await?;
        let mut keyframes = Vec::new();
        for AskedKeyframe { keyframe, has_pose } in request.keyframes {
            keyframes.push(AskedKeyframe { keyframe: self.compute_bow(keyframe).await?, has_pose });
        }
        let hint = request.hint.position.map(|position| (position, request.hint.radius_m));
        let question = Arc::new(LocateQuestion {
            keyframes,
            without_keyframes: request.without_keyframes,
            without_sessions: request.without_sessions,
            roles: self.configured().roles,
            hint,
            seed: request.seed,
        });
        let mut timings = Timings::default();
        let mut searched: Vec<(Arc<LiveMap>, AskedMap)> = Vec::new();
        let mut searches: Vec<MapSearch> = Vec::new();
        for id in ids {
            let Some((live, asked, search)) = self.search(&id, &question, &mut timings).await? else {
                continue;
            };
            searched.push((live, asked));
            searches.push(search);
        }
        let hinted_map =
            request.hint.map.and_then(|hinted| searched.iter().position(|(_, asked)| asked.id == hinted));
        let mut chosen = select(&searches, hinted_map);
        if self.take_snapshots(&mut searched, &mut searches, &chosen, &question, &mut timings).await? {
            chosen = select(&searches, hinted_map);
        }

        let started = Instant::now();
        let own = self.own_features(&question).await?;
        let stored = self.features_of(&searched, &searches, &chosen).await?;
        timings.features_ms = milliseconds_since(started);

        let started = Instant::now();
        let permit = self.reads.enter().await?;
        let max = request.max;
        let seed = question.seed;
        let decide = move || {
            timed(|| {
                let (first, rest) = chosen.split_at(chosen.len().min(LOOKED_AT_FIRST));
                let mut views = look_at(&question, &searches, first, &own, &stored);
                let location = locate(&searches, &views, false, max);
                if location.verdict == LocationVerdict::Located {
                    return (location, searches, views);
                }
                views.extend(look_at(&question, &searches, rest, &own, &stored));
                let mut location = locate(&searches, &views, false, max);
                if !rest.is_empty() && rests_on_views(&location, &searches).is_some() {
                    // No pair is left to tell whether the building repeats itself.
                    location = locate(&searches, &views, true, max);
                }
                (location, searches, views)
            })
        };
        let ((mut location, searches, views), took_ms) =
            spawn_blocking(in_part("verify", decide)).await.map_err(ServiceError::panicked)?;
        timings.note(started, took_ms, |timings| &mut timings.geometry_ms);
        drop(permit);
        if let Some(home) = rests_on_views(&location, &searches) {
            let started = Instant::now();
            let maps: Vec<Arc<LiveMap>> = searched.iter().map(|(live, _)| live.clone()).collect();
            if self.shows_views_twice(home, &maps, seed).await? {
                location = locate(&searches, &views, true, max);
            }
            timings.geometry_ms += milliseconds_since(started);
        }
        Ok(LocateAnswer { maps: searched.into_iter().map(|(_, asked)| asked).collect(), location, timings })
    }

    /// Returns the names of the maps to ask, ascending.
    async fn maps_to_ask(
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

    /// Searches one map; none if it was deleted meanwhile.
    async fn search(
        &self,
        id: &MapId,
        question: &Arc<LocateQuestion>,
        timings: &mut Timings,
    ) -> Result<Option<(Arc<LiveMap>, AskedMap, MapSearch)>, ServiceError> {
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
        Ok(Some((live, AskedMap { id: id.clone(), version, are_words_compared }, search)))
    }

    /// Gathers what geometry needs of the chosen candidates. A map that was written meanwhile is searched anew, with what
    /// geometry needs of its own best candidates, and then it returns true: the choice may be another one.
    async fn take_snapshots(
        &self,
        searched: &mut [(Arc<LiveMap>, AskedMap)],
        searches: &mut [MapSearch],
        chosen: &[Chosen],
        question: &Arc<LocateQuestion>,
        timings: &mut Timings,
    ) -> Result<bool, ServiceError> {
        let mut is_any_new = false;
        for map in chosen.iter().map(|one| one.map).collect::<BTreeSet<usize>>() {
            let of_map = chosen.iter().filter(|one| one.map == map).map(|one| (one.asked, one.candidate));
            let (wanted, found): (Vec<_>, _) = (of_map.collect(), searches[map].clone());
            let asked = question.clone();
            let is_compared = searched[map].1.are_words_compared;
            let started = Instant::now();
            let taken = self.read(&searched[map].0, move |state| {
                let (taken, took_ms) = timed(|| {
                    let (mut search, is_new) = (found.clone(), state.version != found.version);
                    let mut wanted = wanted.clone();
                    if is_new {
                        search = search_at(state, &asked, is_compared);
                        let best = select(std::slice::from_ref(&search), None);
                        wanted = best.into_iter().map(|one| (one.asked, one.candidate)).collect();
                    }
                    search.take_snapshots(&state.index, wanted);
                    (search, is_new)
                });
                Ok((taken, took_ms))
            });
            let (version, ((search, is_new), took_ms)) = taken.await?;
            timings.note(started, took_ms, |timings| &mut timings.screen_ms);
            searches[map] = search;
            searched[map].1.version = version;
            is_any_new |= is_new;
        }
        Ok(is_any_new)
    }

    async fn own_features(
        &self,
        question: &LocateQuestion,
    ) -> Result<Vec<Option<Arc<MatchableFeatures>>>, ServiceError> {
        let mut own = Vec::new();
        for asked in &question.keyframes {
            own.push(match asked.keyframe.features.clone() {
                Some(features) => self.features.prepare(features).await?,
                None => None,
            });
        }
        Ok(own)
    }

    /// Reads the features of the chosen candidates, and of those whose points join the guided search.
    async fn features_of(
        &self,
        searched: &[(Arc<LiveMap>, AskedMap)],
        searches: &[MapSearch],
        chosen: &[Chosen],
    ) -> Result<BTreeMap<usize, FeatureSet>, ServiceError> {
        let mut wanted: BTreeMap<usize, BTreeSet<KeyframeSeq>> = BTreeMap::new();
        for one in chosen {
            let pre_verified = &searches[one.map].screenings[one.asked].candidates[one.candidate];
            let Some(snapshot) = &pre_verified.snapshot else { continue };
            let of_map = wanted.entry(one.map).or_default();
            of_map.insert(pre_verified.keyframe);
            of_map.extend(snapshot.window.iter().copied());
        }
        let mut read = BTreeMap::new();
        for (map, keyframes) in wanted {
            read.insert(map, self.features.read(&self.store, searched[map].0.key, keyframes).await?);
        }
        Ok(read)
    }
}

/// Returns the map and the session of the place that is located, if nothing but views speaks for it.
fn rests_on_views(location: &Location, searches: &[MapSearch]) -> Option<(usize, SessionSeq)> {
    let place = location.places.first().filter(|_| location.verdict == LocationVerdict::Located)?;
    if !place.signs.agreeing.is_empty() {
        return None;
    }
    let site = searches[place.map].sites.iter().find(|site| Some(&site.id) == place.keyframe.as_ref())?;
    Some((place.map, site.session))
}

/// Map names read in one statement.
const LISTED_AT_ONCE: usize = 200;

/// Searches a map as it stands.
fn search_at(state: &State, question: &LocateQuestion, are_words_compared: bool) -> MapSearch {
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

/// Runs geometry on the chosen candidates, in their order.
fn look_at(
    question: &LocateQuestion,
    searches: &[MapSearch],
    chosen: &[Chosen],
    own: &[Option<Arc<MatchableFeatures>>],
    stored: &BTreeMap<usize, FeatureSet>,
) -> Vec<View> {
    let none = FeatureSet::default();
    let mut placed: BTreeMap<(usize, usize), Option<PlacedQuery<'_>>> = BTreeMap::new();
    chosen
        .iter()
        .map(|one| {
            let search = &searches[one.map];
            let asked = placed.entry((one.map, one.asked)).or_insert_with(|| {
                let snapshot = search.screenings[one.asked].snapshot.as_ref();
                snapshot.zip(own[one.asked].as_deref()).map(PlacedQuery::new)
            });
            look(question, search, *one, asked.as_ref(), stored.get(&one.map).unwrap_or(&none))
        })
        .collect()
}
