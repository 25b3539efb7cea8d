//! Following: a server answers questions about a map of another one from a copy, which it keeps up to date.
//!
//! A copy is asked only by those who say which version they have seen: it waits until it has that version, or says that it has not
//! (412). What it answers is what the owner answered at that version, to the byte.

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

use tokio::time::{Instant, sleep, timeout_at};

use super::routing::Route;
use crate::domain::ids::MapId;
use crate::engine::maps::live::LiveMap;
use crate::engine::tasks::blocking;
use crate::engine::{Result, Service, ServiceError};
use crate::store::{GivenAnswer, News};

/// The longest wait for a version that is not there yet.
const WAITS: Duration = Duration::from_secs(2);

/// The time between two looks at what another server wrote, for those who wait for it.
const LOOKS_EVERY: Duration = Duration::from_millis(20);

/// The time between two looks while nobody waits.
const KEPT_UP_EVERY: Duration = Duration::from_millis(500);

/// A copy that the log does not bring up to date is loaded anew after this time at the earliest. Until then the owner answers.
const LOADED_ANEW_EVERY: Duration = Duration::from_secs(5);

/// Whether a copy is loaded anew as often as the log does not tell enough.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::engine) enum Effort {
    /// Nobody else can answer.
    All,
    /// The owner can answer as well.
    Little,
}

/// Answers of followers that are kept at once: fewer than a map takes that are not on disk yet.
const ANSWERS_AT_ONCE: u32 = 64;

/// Of the looks while nobody waits, one in so many tells the owners that their maps are followed.
const TELLS_EVERY: u32 = 6;

impl Service {
    /// Returns the service that answers from copies of maps that other servers own. Nothing is written by it.
    pub fn following(&self) -> Self {
        let mut parts = (*self.0).clone();
        parts.registry = self.followers.registry.clone();
        parts.follows = true;
        Self(Arc::new(parts))
    }

    /// Waits until a map has this version, for two seconds at most; fails if it has not.
    pub async fn reach(&self, map: &MapId, version: u64) -> Result<()> {
        self.reach_with(map, version, Effort::Little).await
    }

    /// [`Self::reach`], with more effort where nobody else can answer.
    pub(in crate::engine) async fn reach_with(
        &self,
        map: &MapId,
        version: u64,
        effort: Effort,
    ) -> Result<()> {
        let deadline = Instant::now() + WAITS;
        let mut has_looked = false;
        loop {
            let live = match effort {
                Effort::All => self.live(map).await?,
                Effort::Little => self.live_by(map, deadline).await?,
            };
            if self.follows {
                match effort {
                    Effort::All => self.keep_up(&live, effort).await?,
                    Effort::Little => match timeout_at(deadline, self.keep_up(&live, effort)).await {
                        Ok(kept_up) => kept_up?,
                        // The owner would wait in vain, too.
                        Err(_) if has_looked => {}
                        Err(_) => return Err(not_up_to_date()),
                    },
                }
            } else {
                let _ = timeout_at(deadline, live.next_version(version.saturating_sub(1))).await;
            }
            has_looked = true;
            let at = live.newest_version();
            if !live.is_over() && at >= version {
                return live.on_disk(&self.store, at).await;
            }
            if Instant::now() >= deadline {
                return Err(ServiceError::PreconditionFailed(format!(
                    "map {map} is at version {at}, and not at {version} yet; try again"
                )));
            }
            sleep(LOOKS_EVERY).await;
        }
    }

    /// Returns the copy of a map, if it is loaded in time. It goes on loading, for the next one who asks.
    async fn live_by(&self, map: &MapId, deadline: Instant) -> Result<Arc<LiveMap>> {
        if !self.follows || self.registry.in_memory_now(map).is_some() {
            return self.live(map).await;
        }
        // One whose copy was promoted a moment ago.
        if self.owned.has(map) {
            return Err(not_up_to_date());
        }
        let (service, map) = (self.clone(), map.clone());
        let loading = tokio::spawn(async move { service.live(&map).await });
        timeout_at(deadline, loading).await.map_err(|_| not_up_to_date())?.map_err(ServiceError::panicked)?
    }

    /// Returns a map for reading, wherever it is: of another server's, a copy that is as new as what was on disk at the call.
    pub(in crate::engine) async fn live_or_copy(&self, map: &MapId) -> Result<Arc<LiveMap>> {
        if self.follows || self.route(map).await? == Route::Here {
            return self.live(map).await;
        }
        let copies = self.following();
        let version = self.store.version(map).await?.ok_or_else(|| ServiceError::no_map(map))?;
        copies.reach_with(map, version, Effort::All).await?;
        copies.live(map).await
    }

    /// Brings a copy up to date; if the log does not tell enough, the next request loads it anew.
    pub(in crate::engine) async fn keep_up(&self, live: &Arc<LiveMap>, effort: Effort) -> Result<()> {
        let Some((rewrites, since)) = live.standing.followed_since() else { return Ok(()) };
        // One at a time takes over what is new.
        let _lane = live.lane.lock().await;
        loop {
            match self.store.news(live.key, live.newest_version(), rewrites).await? {
                News::Changes(versions) if versions.is_empty() => return Ok(()),
                News::Changes(versions) => {
                    self.followers.versions.fetch_add(versions.len() as u64, Ordering::Relaxed);
                    let copy = live.clone();
                    blocking(move || copy.take_over(&versions)).await??;
                }
                News::Unknown if effort == Effort::Little && since.elapsed() < LOADED_ANEW_EVERY => {
                    return Err(not_up_to_date());
                }
                news => {
                    if news == News::Unknown {
                        self.followers.loaded_anew.fetch_add(1, Ordering::Relaxed);
                    }
                    live.throw_away();
                    self.registry.forget_over(&live.id);
                    return Ok(());
                }
            }
        }
    }

    /// Keeps the copies up to date in the background, and says whose maps are followed.
    pub(super) fn keep_up_in_background(&self) {
        let (service, closing) = (self.following(), self.closing.clone());
        tokio::spawn(closing.run_until_cancelled_owned(async move {
            let mut looks = 0_u32;
            loop {
                sleep(KEPT_UP_EVERY).await;
                // By name: no task may hold one for long, or it could not be promoted.
                let copies = service.followers.in_use();
                if looks.is_multiple_of(TELLS_EVERY) && !copies.is_empty() {
                    let keys: Vec<_> = copies.iter().map(|(_, key)| *key).collect();
                    if let Err(error) = service.store.follow(&keys).await {
                        tracing::warn!(%error, "the owners of maps were not told that this server follows them");
                    }
                }
                looks = looks.wrapping_add(1);
                let mut are_up_to_date = true;
                for (id, _) in &copies {
                    let Some(copy) = service.registry.in_memory_now(id) else { continue };
                    if let Err(error) = service.keep_up(&copy, Effort::Little).await {
                        are_up_to_date = false;
                        tracing::debug!(map = %id, %error, "a copy was not brought up to date");
                    }
                }
                if are_up_to_date {
                    service.followers.note_up_to_date();
                }
            }
        }));
    }

    /// Hands the answer of a loop query to the owner of its map, in the background.
    pub(in crate::engine) fn hand_answer_on(&self, live: &LiveMap, given: GivenAnswer) {
        // One that cannot be handed on is not kept, as when the disk is full.
        let Ok(permit) = self.handing_on.clone().try_acquire_owned() else { return };
        let Some((rewrites, _)) = live.standing.followed_since() else { return };
        let (store, map) = (self.store.clone(), live.key);
        tokio::spawn(async move {
            let _permit = permit;
            if let Err(error) = store.hand_answer_on(map, rewrites, &given).await {
                tracing::debug!(%error, "an answer was not handed on");
            }
        });
    }

    /// Keeps the answers that followers gave of the maps that are this server's, or should be.
    pub(super) async fn keep_answers_of_followers(&self) -> Result<()> {
        for map in self.store.maps_with_answers().await? {
            if let Err(error) = self.keep_answers_of(&map).await {
                tracing::debug!(%map, %error, "answers of followers were not kept");
            }
        }
        Ok(())
    }

    async fn keep_answers_of(&self, map: &MapId) -> Result<()> {
        if !self.is_here(map).await {
            return Ok(());
        }
        // One that only copies were asked about is in nobody's memory.
        let live = self.live_in_background(map).await?;
        loop {
            let answers = self.store.take_answers(live.key, ANSWERS_AT_ONCE).await?;
            if answers.is_empty() {
                return Ok(());
            }
            for given in answers {
                live.keep_query(&self.store, given);
            }
            self.store.committer().settled().await;
        }
    }
}

fn not_up_to_date() -> ServiceError {
    ServiceError::unavailable("the copy of this map is not up to date; its owner answers")
}
