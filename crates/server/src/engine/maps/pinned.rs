//! A pinned map: the one that a name meant when a long request began, whatever the name means later.

use std::sync::Arc;

use super::live::LiveMap;
use crate::domain::ids::MapId;
use crate::engine::{Result, Service, ServiceError};
use crate::store::MapKey;

/// A map, and no other that is given its name after it is deleted.
#[derive(Clone, Debug)]
pub struct PinnedMap {
    /// Its name.
    pub id: MapId,
    pub(in crate::engine) key: MapKey,
}

impl Service {
    /// Returns the map that has this name now, which need not be in memory for that.
    pub async fn pin_map(&self, id: &MapId) -> Result<PinnedMap> {
        Ok(PinnedMap { id: id.clone(), key: self.key_of(id).await? })
    }

    /// Returns the key of the pinned map while it is there.
    pub(in crate::engine) async fn key_of_pinned(&self, map: &PinnedMap) -> Result<MapKey> {
        let key = self.key_of(&map.id).await?;
        if key == map.key { Ok(key) } else { Err(ServiceError::no_map(&map.id)) }
    }

    /// Returns the pinned map in memory. One that is deleted is as little there as before another got its name.
    pub(in crate::engine) async fn live_pinned(&self, map: &PinnedMap) -> Result<Arc<LiveMap>> {
        let live = self.live(&map.id).await?;
        if live.key == map.key { Ok(live) } else { Err(ServiceError::no_map(&map.id)) }
    }

    /// [`Self::live_pinned`] for work that no client waits for.
    pub(in crate::engine) async fn live_pinned_in_background(&self, map: &PinnedMap) -> Result<Arc<LiveMap>> {
        let live = self.live_in_background(&map.id).await?;
        if live.key == map.key { Ok(live) } else { Err(ServiceError::no_map(&map.id)) }
    }
}
