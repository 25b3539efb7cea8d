//! A pinned map: the one that a name meant when a long request began, whatever the name means later.

use std::sync::Arc;

use super::live::LiveMap;
use super::{Service, ServiceError};
use crate::model::ids::MapId;
use crate::store::MapKey;

/// A map, and no other that is given its name after it is deleted.
#[derive(Clone, Debug)]
pub struct PinnedMap {
    id: MapId,
    key: MapKey,
}

impl PinnedMap {
    /// Pins a map in memory.
    pub(super) fn of(live: &LiveMap) -> Self {
        Self { id: live.id.clone(), key: live.key }
    }

    /// Its name.
    pub fn id(&self) -> &MapId {
        &self.id
    }
}

impl Service {
    /// The map that has this name now.
    pub async fn pin_map(&self, id: &MapId) -> Result<PinnedMap, ServiceError> {
        let live = self.live(id).await?;
        Ok(PinnedMap::of(&live))
    }

    /// The pinned map in memory. One that is deleted is as little there as before another got its name.
    pub(super) async fn live_pinned(&self, map: &PinnedMap) -> Result<Arc<LiveMap>, ServiceError> {
        let live = self.live(&map.id).await?;
        if live.key == map.key { Ok(live) } else { Err(ServiceError::no_map(&map.id)) }
    }
}
