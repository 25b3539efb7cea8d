//! The room of a key: how many maps it may have made, and how many bytes they may hold.

use std::sync::Arc;
use std::time::Duration;

use moka::future::Cache;

use super::quota::Room;
use crate::domain::key::KeySeq;
use crate::engine::{Service, ServiceError};
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
    async fn of(&self, store: &Store, key: KeySeq) -> Result<u64, ServiceError> {
        let count = async { Ok(store.made_by(key).await?.bytes) };
        let found = self.0.try_get_with(key, count).await;
        found.map_err(|error: Arc<StoreError>| error.to_string()).map_err(ServiceError::Internal)
    }
}

/// What the maps that a key made hold, with their releases, and may hold, in bytes.
#[derive(Clone, Copy, Debug)]
pub(in crate::engine) struct KeyRoom {
    holds: u64,
    most: u64,
}

impl KeyRoom {
    /// Refuses what would take them beyond the limit.
    pub fn check(self, more: u64) -> Result<(), ServiceError> {
        if self.holds.saturating_add(more) <= self.most {
            return Ok(());
        }
        let detail = format!(
            "the maps of the key that made this one hold {} bytes with their releases, and may hold {}; delete some, or ask the \
             operator",
            self.holds, self.most
        );
        Err(ServiceError::MapFull { detail })
    }
}

impl Service {
    /// Returns what limits how a map of this key may grow.
    pub(in crate::engine) async fn room(&self, owner: Option<KeySeq>) -> Result<Room, ServiceError> {
        Ok(Room { quotas: self.quotas, of_key: self.key_room(owner).await? })
    }

    /// Returns what the maps that a key made hold and may hold, if it has a limit.
    pub(in crate::engine) async fn key_room(
        &self,
        owner: Option<KeySeq>,
    ) -> Result<Option<KeyRoom>, ServiceError> {
        let Some(owner) = owner else { return Ok(None) };
        let Some(most) = self.keys.properties(owner).and_then(|of| of.max_bytes) else { return Ok(None) };
        Ok(Some(KeyRoom { holds: self.key_bytes.of(&self.store, owner).await?, most }))
    }

    /// Refuses one map more of a key that has made as many as it may. To be asked while no other map can be made.
    pub(in crate::engine) async fn check_new_map(&self, owner: Option<KeySeq>) -> Result<(), ServiceError> {
        let Some(owner) = owner else { return Ok(()) };
        let Some(most) = self.keys.properties(owner).and_then(|of| of.max_maps) else { return Ok(()) };
        let maps = self.store.made_by(owner).await?.maps;
        if maps < u64::from(most) {
            return Ok(());
        }
        let detail = format!(
            "the key has made {maps} maps that exist, and may have {most}; delete some, or ask the operator"
        );
        Err(ServiceError::MapFull { detail })
    }
}
