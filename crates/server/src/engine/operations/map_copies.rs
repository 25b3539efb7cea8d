//! A map that begins as a copy of a release, or of another map as it stands.

use sha2::{Digest as _, Sha256};

use super::maps::patched;
use super::releases::no_release;
use crate::domain::ids::{MapId, ReleaseName};
use crate::domain::invalid::FieldError;
use crate::domain::key::KeySeq;
use crate::domain::release::MapBase;
use crate::domain::report::MapReport;
use crate::domain::request::{Digest, MapPatch};
use crate::engine::limits::shared_turns::Tenant;
use crate::engine::{Result, Service, ServiceError, Stored};
use crate::store::CopiedAs;

impl Service {
    /// Makes a map as a copy, or finds that this very request had made it. Returns when all of it is on disk.
    pub(super) async fn put_copy(
        &self,
        id: MapId,
        base: MapBase,
        patch: MapPatch,
        owner: Option<KeySeq>,
    ) -> Result<Stored<MapReport>> {
        let digest = fingerprint(&base, &patch);
        if let Some(value) = self.made_before(&id, &digest).await? {
            return Ok(Stored { created: false, value });
        }
        let from = base.id();
        let no_map = || ServiceError::no_map(&base.map);
        let no_base = || base.release.as_ref().map_or_else(no_map, |name| no_release(&base.map, name));
        if from == id {
            return Err(FieldError::new("/base/map", "a map cannot begin as itself").got(&id).into());
        }
        self.check_new_map(owner).await?;
        if let Some(of_key) = self.key_room(owner).await? {
            let base = self.store.map_rows(std::slice::from_ref(&from)).await?.pop().ok_or_else(no_base)?;
            of_key.check(base.report.bytes)?;
        }
        self.disk_takes(false).await?;
        let _reading = self.exports.enter(owner.map_or(Tenant::Anyone, Tenant::Key)).await?;
        let _copying = self.copying.read().await;
        if let Some(live) = self.registry.in_memory_now(&from) {
            // What was answered is copied.
            live.on_disk(&self.store, live.newest_version()).await?;
        }
        let copy = self.store.copy_map(&from).await?.ok_or_else(no_base)?;
        let properties = Box::new(patched(&copy.properties().await?, patch)?);
        // The same name was free before; another request may have taken it meanwhile.
        let _birth = self.registry.births.lock().await;
        if let Some(value) = self.made_before(&id, &digest).await? {
            return Ok(Stored { created: false, value });
        }
        self.check_new_map(owner).await?;
        let version = copy.version + 1;
        copy.finish(CopiedAs::Map { id: id.clone(), properties, version, digest, owner }).await?;
        tracing::info!(map = %id, base = %from, "a map was copied");
        Ok(Stored { created: true, value: self.get_map(&id).await? })
    }
}

fn fingerprint(base: &MapBase, patch: &MapPatch) -> Digest {
    let MapPatch { description, anchor_classes, code_classes, metric, gravity, settings } = patch;
    let gravity = gravity.map(|gravity| gravity.as_given());
    let mut settings: Vec<_> = settings.iter().collect();
    settings.sort_by_key(|(name, _)| name);
    let said = (base.map.as_str(), base.release.as_ref().map(ReleaseName::as_str));
    let classes = (anchor_classes, code_classes);
    Sha256::digest(format!("{said:?}{description:?}{classes:?}{metric:?}{gravity:?}{settings:?}")).into()
}
