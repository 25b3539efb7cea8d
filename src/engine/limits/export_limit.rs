//! The limit on exports under way.

use std::sync::Arc;

use tokio::sync::{OwnedSemaphorePermit, Semaphore};

use crate::engine::error::ServiceError;

/// Exports at once: each keeps one of the store's readers for as long as its client takes.
const EXPORTS_AT_ONCE: usize = 2;

/// When a refused export may be asked for again, in seconds.
const RETRY_AFTER_S: u32 = 5;

/// A limit on how many exports are under way at once. None waits.
#[derive(Clone, Debug)]
pub(in crate::engine) struct ExportLimit(Arc<Semaphore>);

impl Default for ExportLimit {
    fn default() -> Self {
        Self(Arc::new(Semaphore::new(EXPORTS_AT_ONCE)))
    }
}

impl ExportLimit {
    /// Admits an export, which is under way until its permit is dropped.
    pub fn enter(&self) -> Result<OwnedSemaphorePermit, ServiceError> {
        self.0.clone().try_acquire_owned().map_err(|_| ServiceError::Unavailable {
            detail: format!("{EXPORTS_AT_ONCE} exports are under way already"),
            retry_after_s: RETRY_AFTER_S,
        })
    }
}
