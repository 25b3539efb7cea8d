//! Releases: published, listed, compared, deleted. Each is a map that holds one version of another one, and that nobody writes to.

use std::sync::Arc;

use sha2::{Digest as _, Sha256};
use tokio::task::spawn_blocking;

use crate::domain::event::{Event, EventKind};
use crate::domain::ids::{MapId, ReleaseName};
use crate::domain::release::{NewRelease, Release, ReleaseChanges};
use crate::domain::report::Page;
use crate::domain::request::{Digest, PageRequest};
use crate::engine::cluster::following::Effort;
use crate::engine::error::parsed;
use crate::engine::keys::keyring::now;
use crate::engine::limits::quota::check_release;
use crate::engine::limits::shared_turns::Tenant;
use crate::engine::maps::live::LiveMap;
use crate::engine::maps::loads::Used;
use crate::engine::tasks::{blocking, to_its_end};
use crate::engine::{Result, Service, ServiceError, Stored};
use crate::recognition::map::changes_between::{ComparedVersion, changes_between};
use crate::store::{CopiedAs, MapKey};

/// Releases of a map, at most: each takes as much disk as the map.
pub const RELEASES_MAX: u64 = 64;

impl Service {
    /// Publishes the map as it stands, or finds that this very request had published it. Returns when all of it is on disk; what is
    /// written to the map meanwhile waits for nothing. It goes to its end when its client has gone.
    pub async fn publish(
        &self,
        map: &MapId,
        name: ReleaseName,
        wanted: NewRelease,
    ) -> Result<Stored<Release>> {
        let live = self.live(map).await?;
        let service = self.clone();
        to_its_end(async move { service.publish_live(&live, name, wanted).await }).await?
    }

    async fn publish_live(
        &self,
        live: &Arc<LiveMap>,
        name: ReleaseName,
        wanted: NewRelease,
    ) -> Result<Stored<Release>> {
        // Who asks for the same release again waits for the one that is under way.
        let _publishing = live.publishing.lock().await;
        let digest = fingerprint(&wanted);
        if let Some(value) = self.published_before(live, &name, &digest).await? {
            return Ok(Stored { created: false, value });
        }
        let (count, bytes) = self.store.release_sizes(live.key).await?;
        if count >= RELEASES_MAX {
            return Err(ServiceError::TooLarge(format!(
                "a map has at most {RELEASES_MAX} releases; delete some"
            )));
        }
        let room = self.room(live.owner).await?;
        self.read(live, move |state| check_release(&room, &state.index, bytes)).await?;
        self.disk_takes(false).await?;
        let _reading = self.exports.enter(Tenant::current(Some(live.key))).await?;
        let _copying = self.copying.read().await;
        // What was answered is published.
        live.on_disk(&self.store, live.newest_version()).await?;
        if let Some(version) = wanted.version.filter(|version| *version != live.newest_version()) {
            return Err(moved(live, version));
        }
        let copy = self.store.copy_map(&live.id).await?.ok_or_else(|| ServiceError::no_map(&live.id))?;
        if let Some(version) = wanted.version.filter(|version| *version != copy.version) {
            return Err(moved(live, version));
        }
        let version = copy.version;
        let copied_as = CopiedAs::Release {
            map: live.key,
            of: live.id.clone(),
            name: name.clone(),
            version,
            description: wanted.description,
            published: now(),
            digest,
        };
        // The map is not deleted meanwhile.
        let birth = self.registry.births.lock().await;
        if live.is_over() && self.key_of(&live.id).await.ok() != Some(live.key) {
            return Err(ServiceError::no_map(&live.id));
        }
        // The map may have been loaded anew meanwhile, with a lock of its own.
        if let Some(value) = self.published_before(live, &name, &digest).await? {
            return Ok(Stored { created: false, value });
        }
        copy.finish(copied_as).await?;
        drop(birth);
        tracing::info!(map = %live.id, release = %name, version, "a release was published");
        let mut event = Event::of(EventKind::ReleasePublished);
        event.detail = Some(format!("release {name} of version {version}"));
        let (telling, store) = (live.clone(), self.store.clone());
        drop(spawn_blocking(move || telling.tell(&store, vec![event])));
        let value = self.release_of(&live.id, live.key, &name).await?;
        Ok(Stored { created: true, value })
    }

    /// Returns the release of this name if this very request had published it; fails if another one had.
    async fn published_before(
        &self,
        live: &LiveMap,
        name: &ReleaseName,
        digest: &Digest,
    ) -> Result<Option<Release>> {
        match self.store.release(live.key, name).await? {
            Some((release, made_by)) if made_by == *digest => Ok(Some(release)),
            Some(_) => {
                let detail =
                    format!("release {name} of map {} exists and was published by another request", live.id);
                Err(ServiceError::Conflict { code: "release_exists", detail })
            }
            None => Ok(None),
        }
    }

    /// Returns the releases of a map by name.
    pub async fn list_releases(&self, map: &MapId, page: PageRequest) -> Result<Page<Release>> {
        let after = parsed(&page)?;
        let key = self.key_of(map).await?;
        let items = self.store.releases(key, after.as_ref(), page.limit + 1).await?;
        Ok(Page::of(items, page.limit, |release| release.name.to_string()))
    }

    /// Returns a release of a map.
    pub async fn get_release(&self, map: &MapId, name: &ReleaseName) -> Result<Release> {
        let key = self.key_of(map).await?;
        self.release_of(map, key, name).await
    }

    async fn release_of(&self, map: &MapId, key: MapKey, name: &ReleaseName) -> Result<Release> {
        let found = self.store.release(key, name).await?;
        found.map(|(release, _)| release).ok_or_else(|| no_release(map, name))
    }

    /// Deletes a release; robots that ask it hear that it is not there.
    pub async fn delete_release(&self, map: &MapId, name: &ReleaseName) -> Result<()> {
        self.get_release(map, name).await?;
        self.delete_map(&map.of_release(name)).await.map_err(|error| match error {
            ServiceError::NotFound(_) => no_release(map, name),
            error => error,
        })
    }

    /// Returns what changed from a release to another one, or to the map as it stands, with both versions. Each list has at most
    /// `limit`.
    pub async fn changes_since(
        &self,
        map: &MapId,
        since: &ReleaseName,
        until: Option<&ReleaseName>,
        limit: usize,
    ) -> Result<(u64, u64, ReleaseChanges)> {
        let (earlier, before) = self.compared(&self.live_release(map, since).await?).await?;
        let (later, after) = self.compared(&self.live_or_release(map, until).await?).await?;
        let compare = move || changes_between(&before, &after, limit);
        let changes = blocking(compare).await?;
        Ok((earlier, later, changes))
    }

    /// Takes what is compared of a map, with its version.
    async fn compared(&self, live: &Arc<LiveMap>) -> Result<(u64, ComparedVersion)> {
        self.read(live, |state| Ok(ComparedVersion::of(&state.index))).await
    }

    /// Returns a map, or the one that holds a release of it, loaded if it was not in memory.
    pub(super) async fn live_or_release(
        &self,
        map: &MapId,
        release: Option<&ReleaseName>,
    ) -> Result<Arc<LiveMap>> {
        match release {
            Some(name) => self.live_release(map, name).await,
            None => self.live(map).await,
        }
    }

    /// Returns the map that holds a release, loaded if it was not in memory.
    pub(in crate::engine) async fn live_release(
        &self,
        map: &MapId,
        name: &ReleaseName,
    ) -> Result<Arc<LiveMap>> {
        let id = map.of_release(name);
        let mut found = self.registry.get(&self.store, &id, Used::ByClient).await;
        if let Ok(copy) = &found
            && self.follows
        {
            self.keep_up(copy, Effort::All).await?;
            if copy.is_over() {
                found = self.registry.get(&self.store, &id, Used::ByClient).await;
            }
        }
        match found {
            Err(ServiceError::NotFound(_)) => {
                self.key_of(map).await?;
                Err(no_release(map, name))
            }
            live => live,
        }
    }
}

/// Says that a release is not there.
pub(in crate::engine) fn no_release(map: &MapId, name: &ReleaseName) -> ServiceError {
    ServiceError::NotFound(format!(
        "there is no release {name} of map {map}; `GET /v1/maps/{map}/releases` lists them"
    ))
}

fn moved(live: &LiveMap, wanted: u64) -> ServiceError {
    let detail = format!("map {} is not at version {wanted} but at {}", live.id, live.newest_version());
    ServiceError::Conflict { code: "map_version_differs", detail }
}

fn fingerprint(wanted: &NewRelease) -> Digest {
    Sha256::digest(format!("{:?}", (&wanted.description, wanted.version))).into()
}
