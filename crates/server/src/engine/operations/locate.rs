//! "Where am I?": one or several keyframes against the maps that a caller may query.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use tokio::time::Instant;

use super::locate_maps::{AskedMap, MapOfQuestion, search_at};
use super::queries::{Timings, milliseconds_since, timed};
use crate::domain::ids::{MapId, SessionSeq};
use crate::domain::location::{AskedKeyframe, LocateRequest, Location, LocationVerdict};
use crate::engine::maps::live::LiveMap;
use crate::engine::{Result, Service, ServiceError};
use crate::recognition::locate::likeness::first_others;
use crate::recognition::locate::locate;
use crate::recognition::locate::map_search::{LocateQuestion, MapSearch, snapshots};
use crate::recognition::locate::selection::{Chosen, LOOKED_AT, VERIFICATIONS_MAX, select};
use crate::recognition::locate::views::{View, look};
use crate::recognition::loops::features::{FeatureSet, MatchableFeatures};
use crate::recognition::loops::geometry_check::{Comparisons, PlacedQuery};
use crate::recognition::loops::wanted_features::WantedFeatures;

/// Times that the maps of a pattern are asked again because one of them was deleted meanwhile.
const ASKED_AGAIN_MAX: usize = 3;

/// The place of the camera, and the maps that were asked.
#[derive(Clone, Debug, PartialEq)]
pub struct LocateAnswer {
    /// The maps, in the order of their names.
    pub maps: Vec<AskedMap>,
    /// The number of keyframes that asked.
    pub keyframes: usize,
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
    ) -> Result<LocateAnswer> {
        let are_named = !request.maps.is_empty() && request.maps.iter().all(|map| map.only_map().is_some());
        for _ in 0..if are_named { 0 } else { ASKED_AGAIN_MAX } {
            match self.locate_now(request.clone(), &reaches).await {
                // A map that nobody named was deleted meanwhile: the others are asked.
                Err(ServiceError::NotFound(_)) => {}
                answer => return answer,
            }
        }
        self.locate_now(request, &reaches).await
    }

    async fn locate_now(
        &self,
        request: LocateRequest,
        reaches: &impl Fn(&MapId) -> bool,
    ) -> Result<LocateAnswer> {
        let ids = self.maps_to_ask(&request.maps, reaches).await?;
        let ids = match &request.release {
            Some(name) => self.releases_to_ask(ids, name, &request.maps).await?,
            None => ids,
        };
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
        let hinted = match (request.hint.map, &request.release) {
            (Some(map), Some(name)) => Some(map.of_release(name)),
            (map, _) => map,
        };
        let hinted = hinted.as_ref();
        let (mut maps, mut searches) = self.search_maps(ids, &question, hinted, &mut timings).await?;
        let hinted_map = hinted.and_then(|hinted| maps.iter().position(|map| map.asked.id == *hinted));
        let mut chosen = select(&searches, hinted_map);
        if self.take_snapshots(&mut maps, &mut searches, &chosen, &question, &mut timings).await? {
            chosen = select(&searches, hinted_map);
        }

        let started = Instant::now();
        let own = self.own_features(&question).await?;
        let stored = self.features_of(&maps, &searches, &chosen).await?;
        timings.features_ms = milliseconds_since(started);

        let started = Instant::now();
        let max = request.max;
        let (seed, asking) = (question.seed, question.keyframes.len());
        let decide = move || {
            timed(|| {
                let (mut views, comparisons) = (Vec::<View>::new(), Comparisons::default());
                let found = LOOKED_AT.into_iter().find_map(|upto| {
                    let next = &chosen[views.len()..chosen.len().min(upto)];
                    views.extend(look_at(&question, &searches, next, (&own, &stored), &comparisons));
                    let location = locate(&searches, &views, 0, max);
                    let is_over = location.verdict == LocationVerdict::Located || views.len() == chosen.len();
                    is_over.then_some(location)
                });
                let location = found.unwrap_or_else(|| locate(&searches, &views, 0, max));
                (location, searches, views)
            })
        };
        let ((mut location, searches, views), took_ms) = self.verify(None, decide).await?;
        timings.note(started, took_ms, |timings| &mut timings.geometry_ms);
        if let Some((map, session)) = rests_on_views(&location, &searches)
            && let Some(home) = &maps[map].live
        {
            let started = Instant::now();
            let pairs = VERIFICATIONS_MAX.saturating_sub(views.len());
            let looked_at = views.iter().map(|view| view.chosen.map);
            let rivals: Vec<&Arc<LiveMap>> =
                first_others(looked_at, map).filter_map(|rival| maps[rival].live.as_ref()).collect();
            let alike_cells = self.alike_cells((home, session), &rivals, pairs, seed).await?;
            location = locate(&searches, &views, alike_cells, max);
            timings.geometry_ms += milliseconds_since(started);
        }
        let maps = maps.into_iter().map(|map| map.asked).collect();
        Ok(LocateAnswer { maps, keyframes: asking, location, timings })
    }

    /// Gathers what geometry needs of the chosen candidates. A map that was written meanwhile is searched anew, with what
    /// geometry needs of its own best candidates, and then it returns true: the choice may be another one.
    async fn take_snapshots(
        &self,
        maps: &mut [MapOfQuestion],
        searches: &mut [MapSearch],
        chosen: &[Chosen],
        question: &Arc<LocateQuestion>,
        timings: &mut Timings,
    ) -> Result<bool> {
        let mut is_any_new = false;
        for map in chosen.iter().map(|one| one.map).collect::<BTreeSet<usize>>() {
            let MapOfQuestion { asked: of_map, live: Some(live) } = &maps[map] else { continue };
            let is_compared = of_map.are_words_compared;
            let wanted = chosen.iter().filter(|one| one.map == map).map(|one| (one.asked, one.candidate));
            let mut wanted: Vec<(usize, usize)> = wanted.collect();
            let keyframes = searches[map].keyframes_of(&wanted);
            let (asked, version) = (question.clone(), searches[map].version);
            let started = Instant::now();
            let taken = self.read(live, move |state| {
                Ok(timed(|| {
                    if state.version == version {
                        return (None, snapshots(&state.index, &keyframes));
                    }
                    let search = search_at(state, &asked, is_compared);
                    let best = of_one_map(&search);
                    let taken = snapshots(&state.index, &search.keyframes_of(&best));
                    (Some((search, best)), taken)
                }))
            });
            let (version, ((anew, taken), took_ms)) = taken.await?;
            timings.note(started, took_ms, |timings| &mut timings.screen_ms);
            if let Some((search, best)) = anew {
                (searches[map], wanted) = (search, best);
                maps[map].asked.version = version;
                is_any_new = true;
            }
            searches[map].set_snapshots(&wanted, taken);
        }
        Ok(is_any_new)
    }

    async fn own_features(&self, question: &LocateQuestion) -> Result<Vec<Option<Arc<MatchableFeatures>>>> {
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
        maps: &[MapOfQuestion],
        searches: &[MapSearch],
        chosen: &[Chosen],
    ) -> Result<BTreeMap<usize, FeatureSet>> {
        let mut wanted: BTreeMap<usize, WantedFeatures> = BTreeMap::new();
        for one in chosen {
            let pre_verified = &searches[one.map].screenings[one.asked].candidates[one.candidate];
            let Some(snapshot) = &pre_verified.snapshot else { continue };
            let of_one = WantedFeatures::of(pre_verified.keyframe, snapshot);
            wanted.entry(one.map).or_default().extend(of_one);
        }
        let mut read = BTreeMap::new();
        for (map, keyframes) in wanted {
            let Some(live) = &maps[map].live else { continue };
            read.insert(map, self.features.read(&self.store, live.key, keyframes).await?);
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

/// Returns the candidates that would be chosen were this the only map.
fn of_one_map(search: &MapSearch) -> Vec<(usize, usize)> {
    let best = select(std::slice::from_ref(search), None);
    best.into_iter().map(|one| (one.asked, one.candidate)).collect()
}

/// Runs geometry on the chosen candidates, in their order.
fn look_at(
    question: &LocateQuestion,
    searches: &[MapSearch],
    chosen: &[Chosen],
    (own, stored): (&[Option<Arc<MatchableFeatures>>], &BTreeMap<usize, FeatureSet>),
    comparisons: &Comparisons,
) -> Vec<View> {
    let none = FeatureSet::default();
    let mut placed: BTreeMap<(usize, usize), Option<PlacedQuery<'_>>> = BTreeMap::new();
    chosen
        .iter()
        .map(|one| {
            let search = &searches[one.map];
            let asked = placed.entry((one.map, one.asked)).or_insert_with(|| {
                let snapshot = search.screenings[one.asked].snapshot.as_ref();
                let seeing = snapshot.zip(own[one.asked].as_deref());
                seeing.map(|seeing| PlacedQuery::new(seeing, comparisons))
            });
            look(question, search, *one, asked.as_ref(), stored.get(&one.map).unwrap_or(&none))
        })
        .collect()
}
