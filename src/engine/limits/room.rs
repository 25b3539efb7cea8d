//! Room: what limits how a map may grow, and whether there may be one more.

use std::time::Duration;

use moka::sync::Cache;

use super::quota::{KeyRoom, Room};
use crate::domain::key::KeySeq;
use crate::engine::{Result, Service, ServiceError};
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

impl Service {
    /// Returns what limits how a map of this key may grow.
    pub(in crate::engine) async fn room(&self, owner: Option<KeySeq>) -> Result<Room> {
        Ok(Room { quotas: self.quotas, of_key: self.key_room(owner).await? })
    }

    /// Returns what the maps that a key made hold and may hold, if it has a limit.
    pub(in crate::engine) async fn key_room(&self, owner: Option<KeySeq>) -> Result<Option<KeyRoom>> {
        let Some(owner) = owner else { return Ok(None) };
        let limit = self.keys.held(owner).and_then(|held| held.key.properties.max_bytes);
        let Some(most) = limit else { return Ok(None) };
        Ok(Some(KeyRoom { holds: self.key_bytes.of(&self.store, owner).await?, most }))
    }

    /// Refuses one map more of a key that has made as many as it may. To be asked while no other map can be made.
    pub(in crate::engine) async fn check_new_map(&self, owner: Option<KeySeq>) -> Result<()> {
        let Some(owner) = owner else { return Ok(()) };
        let limit = self.keys.held(owner).and_then(|held| held.key.properties.max_maps);
        let Some(most) = limit else { return Ok(()) };
        let maps = self.store.made_by(owner).await?.maps;
        if maps < u64::from(most) {
            return Ok(());
        }
        Err(ServiceError::MapFull(format!(
            "the key has made {maps} maps that exist, and may have {most}; delete some, or ask the operator"
        )))
    }
}
