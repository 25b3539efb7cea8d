//! Maps: make, read, change, delete.

use sha2::{Digest as _, Sha256};
use tracing::Instrument as _;

use crate::config::traces;
use crate::domain::change::Change;
use crate::domain::ids::MapId;
use crate::domain::invalid::FieldError;
use crate::domain::key::KeySeq;
use crate::domain::map::MapProperties;
use crate::domain::report::{MapReport, Page};
use crate::domain::request::{Digest, MapPatch, NewMap, PageRequest};
use crate::domain::settings::Settings;
use crate::engine::erasures::recorded;
use crate::engine::error::{parsed, refuse};
use crate::engine::maps::live::Decision;
use crate::engine::tasks::{blocking, to_its_end};
use crate::engine::{Result, Service, ServiceError, Stored};
use crate::store::{Job, MapRow, StoreError};

impl Service {
    /// Returns the maps by name, as far as they are visible to who asks.
    pub async fn list_maps(
        &self,
        page: PageRequest,
        visible: impl Fn(&MapId) -> bool,
    ) -> Result<Page<MapReport>> {
        let mut after = parsed(&page)?;
        let mut ids: Vec<MapId> = Vec::new();
        while ids.len() <= page.limit {
            let found = self.store.map_ids(after.as_ref(), page.limit + 1).await?;
            let last = found.len() <= page.limit;
            after = found.last().cloned();
            ids.extend(found.into_iter().filter(&visible));
            if last {
                break;
            }
        }
        let part = Page::of(ids, page.limit, ToString::to_string);
        // As committed. What was deleted since the names were read is left out.
        let items = self.store.map_rows(&part.items).await?.into_iter().map(|row| row.report).collect();
        Ok(Page { items, next_cursor: part.next_cursor })
    }

    /// Makes a map, by itself or as a copy, or finds that this very request had made it.
    pub async fn put_new_map(
        &self,
        id: MapId,
        new: NewMap,
        owner: Option<KeySeq>,
    ) -> Result<Stored<MapReport>> {
        let NewMap { patch, base } = new;
        if let Some(base) = base {
            let service = self.clone();
            return to_its_end(async move { service.put_copy(id, base, patch, owner).await }).await?;
        }
        let defaults = MapProperties { metric: true, ..MapProperties::default() };
        self.put_map(id, patched(&defaults, patch)?, owner).await
    }

    /// Makes a map, or finds that this very request had made it.
    pub async fn put_map(
        &self,
        id: MapId,
        properties: MapProperties,
        owner: Option<KeySeq>,
    ) -> Result<Stored<MapReport>> {
        let digest = fingerprint(&properties);
        let _birth = self.registry.births.lock().await;
        if let Some(value) = self.made_before(&id, &digest).await? {
            return Ok(Stored { created: false, value });
        }
        self.check_new_map(owner).await?;
        self.disk_takes(false).await?;
        let job = Job::CreateMap { id: id.clone(), properties: Box::new(properties), digest, owner };
        self.store.committer().commit(job).instrument(traces::part("commit")).await?;
        Ok(Stored { created: true, value: self.get_map(&id).await? })
    }

    /// Returns the map of this name if this very request had made it; fails if another one had.
    pub(super) async fn made_before(&self, id: &MapId, digest: &Digest) -> Result<Option<MapReport>> {
        let mut row = self.map_row(id).await?;
        if row.is_none() {
            // It may be on its way to the disk for a client that went away.
            self.store.committer().settled().await;
            row = self.map_row(id).await?;
        }
        match row {
            Some(MapRow { report, digest: made_by }) if made_by == *digest => Ok(Some(report)),
            Some(_) => {
                let detail = format!("map {id} exists and was made by another body; change it with PATCH");
                Err(ServiceError::Conflict { code: "map_exists", detail })
            }
            None => Ok(None),
        }
    }

    /// Returns a map as committed: from its row, so that it need not be in memory.
    pub async fn get_map(&self, id: &MapId) -> Result<MapReport> {
        // Where others may own it, only its owner knows that the database told the newest version.
        let is_shared = self.store.is_shared();
        let live = if is_shared { Some(self.live(id).await?) } else { self.registry.in_memory_now(id) };
        let on_disk = live.as_ref().map_or(0, |live| live.version_on_disk());
        let row = self.map_row(id).await?;
        let report = row.map(|row| row.report).ok_or_else(|| ServiceError::no_map(id))?;
        if let Some(live) = live {
            live.expect_up_to_date(on_disk, report.version)?;
        }
        Ok(report)
    }

    async fn map_row(&self, id: &MapId) -> Result<Option<MapRow>> {
        Ok(self.store.map_rows(std::slice::from_ref(id)).await?.pop())
    }

    /// Changes a map's description, classes or settings. What the settings decided before (which detection
    /// joined which anchor) stays; what is derived (states, matches, covisibility) follows at once.
    pub async fn patch_map(&self, id: &MapId, patch: MapPatch) -> Result<MapReport> {
        let live = self.live(id).await?;
        self.change(&live, move |index| {
            let properties = patched(index.properties(), patch)?;
            Ok(Decision::of((), recorded(index, vec![Change::MapSet(Box::new(properties))])))
        })
        .await?;
        self.get_map(id).await
    }

    /// Deletes a map with everything in it; whoever asks for it meanwhile waits for what the disk says.
    pub async fn delete_map(&self, id: &MapId) -> Result<()> {
        let birth = self.registry.births.clone().lock_owned().await;
        let live = match self.live(id).await {
            Err(ServiceError::Damaged(_)) => return self.delete_damaged(id).await,
            live => live?,
        };
        self.disk_takes(true).await?;
        let service = self.clone();
        // To its end, also when the client has gone.
        let deletion = async move {
            let deleting = live.clone();
            let store = service.store.clone();
            let queued = blocking(move || deleting.delete(&store)).await??;
            let deleted = queued.await.map_err(|_| StoreError::Closed)?;
            service.features.forget_map(live.key).await;
            service.registry.forget_over(&live.id);
            for release in service.registry.forget_releases(&live.id) {
                service.features.forget_map(release.key).await;
            }
            drop(birth);
            deleted?;
            tracing::info!(map = %live.id, "a map was deleted");
            Ok(())
        };
        to_its_end(deletion).await?
    }

    /// Deletes a map that cannot be loaded; its name is free again then.
    async fn delete_damaged(&self, id: &MapId) -> Result<()> {
        self.disk_takes(true).await?;
        let key = self.key_of(id).await?;
        self.store.committer().commit(Job::DeleteMap(key)).await?;
        self.registry.forget_releases(id);
        tracing::info!(map = %id, "a damaged map was deleted");
        Ok(())
    }
}

/// Returns what makes two requests for a map the same. A setting counts only where it differs from its default, so that
/// a setting added by a later version does not make a retry look like another map.
fn fingerprint(properties: &MapProperties) -> Digest {
    let defaults = Settings::default();
    let chosen: Vec<_> = Settings::TABLE
        .iter()
        .map(|row| (row.name, properties.settings.get(row.name)))
        .filter(|(name, value)| *value != defaults.get(name))
        .collect();
    let classes = (&properties.anchor_classes, &properties.code_classes);
    let said = (&properties.description, properties.metric, classes, chosen);
    // Maps made before there was such a field keep their fingerprint.
    let gravity = properties.gravity.map(|gravity| format!("{:?}", gravity.as_given())).unwrap_or_default();
    Sha256::digest(format!("{said:?}{gravity}")).into()
}

pub(super) fn patched(before: &MapProperties, patch: MapPatch) -> Result<MapProperties> {
    let mut properties = before.clone();
    if let Some(description) = patch.description {
        properties.description = description;
    }
    let lists = [
        (patch.anchor_classes, &mut properties.anchor_classes),
        (patch.code_classes, &mut properties.code_classes),
    ];
    for (classes, list) in lists {
        if let Some(mut classes) = classes {
            classes.sort();
            classes.dedup();
            *list = classes;
        }
    }
    if let Some(metric) = patch.metric {
        properties.metric = metric;
    }
    properties.gravity = patch.gravity.or(properties.gravity);
    let mut errors = Vec::new();
    for (name, value) in patch.settings {
        if let Err(error) = properties.settings.set(&name, value) {
            errors.push(FieldError::new(format!("/settings/{name}"), error.to_string()));
        }
    }
    refuse(errors)?;
    Ok(properties)
}
