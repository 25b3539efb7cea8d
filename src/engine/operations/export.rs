//! Export: a map's operations, read from the store one by one.

use tokio::sync::OwnedSemaphorePermit;

use crate::domain::ids::MapId;
use crate::domain::recorded::Recorded;
use crate::engine::{Service, ServiceError};
use crate::store::Export;

/// A map's operations, in the order of writing, as they were committed when the export began.
pub struct MapExport {
    export: Export,
    _permit: OwnedSemaphorePermit,
}

impl MapExport {
    /// Reads the next operation; `None` after the last.
    pub async fn next(&mut self) -> Result<Option<Recorded>, ServiceError> {
        Ok(self.export.next().await?)
    }
}

impl Service {
    /// Begins to export a map.
    pub async fn export(&self, map: &MapId) -> Result<MapExport, ServiceError> {
        let permit = self.exports.enter()?;
        let export = self.store.export(map).await?.ok_or_else(|| ServiceError::no_map(map))?;
        Ok(MapExport { export, _permit: permit })
    }
}
