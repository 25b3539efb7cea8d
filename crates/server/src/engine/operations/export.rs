//! Export: a map's operations, read from the store one by one.

use super::releases::no_release;
use crate::domain::ids::{MapId, ReleaseName};
use crate::domain::recorded::Recorded;
use crate::engine::limits::shared_turns::{Tenant, Turn};
use crate::engine::{Result, Service, ServiceError};
use crate::store::Export;

/// A map's operations, in the order of writing, as they were committed when the export began.
pub struct MapExport {
    export: Export,
    _turn: Turn,
}

impl MapExport {
    /// Reads the next operation; `None` after the last.
    pub async fn next(&mut self) -> Result<Option<Recorded>> {
        Ok(self.export.next().await?)
    }
}

impl Service {
    /// Begins to export a map, or a release of it.
    pub async fn export(&self, map: &MapId, release: Option<&ReleaseName>) -> Result<MapExport> {
        let id = release.map_or_else(|| map.clone(), |name| map.of_release(name));
        let none = || release.map_or_else(|| ServiceError::no_map(map), |name| no_release(map, name));
        let key = self.store.map_key(&id).await?.ok_or_else(none)?;
        let turn = self.exports.enter(Tenant::current(Some(key))).await?;
        let export = self.store.export(&id).await?.ok_or_else(none)?;
        Ok(MapExport { export, _turn: turn })
    }
}
