//! The bytes of the maps that keys made.

use std::time::Duration;

use moka::sync::Cache;

use crate::domain::key::KeySeq;
use crate::engine::Result;
use crate::store::Store;

/// Keys whose bytes are remembered.
const REMEMBERED: u64 = 10_000;

/// The time for which the bytes of a key's maps are remembered: it may hold more than its limit by what it writes meanwhile.
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
    pub async fn of(&self, store: &Store, key: KeySeq) -> Result<u64> {
        if let Some(known) = self.0.get(&key) {
            return Ok(known);
        }
        let bytes = store.made_by(key).await?.bytes;
        self.0.insert(key, bytes);
        Ok(bytes)
    }
}
