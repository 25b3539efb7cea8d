//! Export: a map's operations, read from the store one by one.

use tokio::sync::OwnedSemaphorePermit;

use super::releases::no_release;
use crate::domain::ids::{MapId, ReleaseName};
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
    /// Begins to export a map, or a release of it.
    pub async fn export(
        &self,
        map: &MapId,
        release: Option<&ReleaseName>,
    ) -> Result<MapExport, ServiceError> {
        let permit = self.exports.enter()?;
        let export = match release {
            Some(name) => {
                let found = self.store.export(&map.of_release(name)).await?;
                found.ok_or_else(|| no_release(map, name))?
            }
            None => self.store.export(map).await?.ok_or_else(|| ServiceError::no_map(map))?,
        };
        Ok(MapExport { export, _permit: permit })
    }
}
