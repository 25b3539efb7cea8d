//! The bytes of the maps that keys made.

use std::sync::Arc;
use std::time::Duration;

use moka::future::Cache;

use crate::domain::key::KeySeq;
use crate::engine::ServiceError;
use crate::store::{Store, StoreError};

/// Keys whose bytes are remembered.
const REMEMBERED: u64 = 10_000;

/// How long the bytes of a key's maps are remembered: it may hold more than its limit by what it writes meanwhile.
const LASTS: Duration = Duration::from_secs(1);

/// The bytes of the maps that each key made, as they were on disk a moment ago.
#[derive(Clone, Debug)]
pub(in crate::engine) struct KeyBytes(Cache<KeySeq, u64>);

impl Default for KeyBytes {
    fn default() -> Self {
        Self(Cache::builder().max_capacity(REMEMBERED).time_to_live(LASTS).build())
    }
}

impl KeyBytes {
    /// Returns the bytes of the maps that a key made, with their releases.
    pub async fn of(&self, store: &Store, key: KeySeq) -> Result<u64, ServiceError> {
        let count = async { Ok(store.made_by(key).await?.bytes) };
        let found = self.0.try_get_with(key, count).await;
        found.map_err(|error: Arc<StoreError>| error.to_string()).map_err(ServiceError::Internal)
    }
}
