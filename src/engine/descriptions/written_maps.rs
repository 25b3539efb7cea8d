//! The maps that were written to since the worker's last round.

use std::collections::HashMap;
use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::domain::ids::MapId;
use crate::engine::maps::live::LiveMap;
use crate::store::MapKey;

/// Maps by key, each with its name and the newest version that was decided.
#[derive(Debug, Default)]
pub(in crate::engine) struct WrittenMaps(Mutex<HashMap<MapKey, (MapId, u64)>>);

impl WrittenMaps {
    /// Notes that a map was written to.
    pub fn note(&self, live: &LiveMap) {
        self.lock().insert(live.key, (live.id.clone(), live.newest_version()));
    }

    /// Takes all that was noted.
    pub fn take(&self) -> HashMap<MapKey, (MapId, u64)> {
        std::mem::take(&mut *self.lock())
    }

    fn lock(&self) -> MutexGuard<'_, HashMap<MapKey, (MapId, u64)>> {
        // An entry is inserted as a whole.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
