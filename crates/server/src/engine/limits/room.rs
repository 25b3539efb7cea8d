//! Room: what limits how a map may grow, and whether there may be one more.

use super::quota::{KeyRoom, Room};
use crate::domain::key::KeySeq;
use crate::engine::{Result, Service, ServiceError};

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
