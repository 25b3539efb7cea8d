//! Export: a map's operations, read from the store one by one.

use std::sync::Arc;

use tokio::sync::{OwnedSemaphorePermit, Semaphore};

use crate::domain::ids::MapId;
use crate::domain::recorded::Recorded;
use crate::engine::{Service, ServiceError};
use crate::store::Export;

/// Exports at once: each keeps one of the store's readers for as long as its client takes.
const EXPORTS_AT_ONCE: usize = 2;

/// When a refused export may be asked for again, in seconds.
const RETRY_AFTER_S: u32 = 5;

/// The exports that are under way.
#[derive(Clone, Debug)]
pub(in crate::engine) struct Exports(Arc<Semaphore>);

impl Default for Exports {
    fn default() -> Self {
        Self(Arc::new(Semaphore::new(EXPORTS_AT_ONCE)))
    }
}

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
        let permit = self.exports.0.clone().try_acquire_owned().map_err(|_| ServiceError::Unavailable {
            detail: format!("{EXPORTS_AT_ONCE} exports are under way already"),
            retry_after_s: RETRY_AFTER_S,
        })?;
        let export = self.store.export(map).await?.ok_or_else(|| ServiceError::no_map(map))?;
        Ok(MapExport { export, _permit: permit })
    }
}
