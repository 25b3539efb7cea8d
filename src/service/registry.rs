//! The maps in memory: loaded once, when first asked for, and anew after a write failed.
//!
//! No map may be in memory twice: each would decide upon what it knows, and the later commit would undo the earlier one. So
//! a map comes to memory by one way only, a load into the cell that the table holds for it; a cell leaves the table
//! only when nothing is in it, or a map that decides nothing any more; and what was loaded into a cell that has left is thrown away.

use std::collections::HashMap;
use std::sync::atomic::{AtomicI64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use tokio::sync::OnceCell;

use super::error::ServiceError;
use super::live::LiveMap;
use crate::model::ids::MapId;
use crate::store::{MapKey, Store};

/// How often a request loads a map whose writes keep failing, or that comes and goes.
const LOADS_MAX: usize = 5;

type Cell = Arc<OnceCell<Arc<LiveMap>>>;

/// The maps in memory.
#[derive(Debug)]
pub(super) struct Registry {
    cells: Mutex<HashMap<MapId, Cell>>,
    next_key: AtomicI64,
    /// Held while a map is made or deleted, so that a name means one map at a time.
    pub births: Arc<tokio::sync::Mutex<()>>,
}

impl Registry {
    pub fn new(next_key: MapKey) -> Self {
        Self { cells: Mutex::default(), next_key: AtomicI64::new(next_key), births: Arc::default() }
    }

    /// A key never given before.
    pub fn next_key(&self) -> MapKey {
        self.next_key.fetch_add(1, Ordering::Relaxed)
    }

    /// The map, loaded if need be, and anew if a write to it failed. Concurrent first requests share one load.
    pub async fn get(&self, store: &Store, id: &MapId) -> Result<Arc<LiveMap>, ServiceError> {
        for _ in 0..LOADS_MAX {
            let cell = self.lock().entry(id.clone()).or_default().clone();
            let loaded = cell.get_or_try_init(|| async {
                // What a map that is forgotten had queued is settled first: a write under way would be missed.
                store.committer().settled().await;
                match store.load(id).await? {
                    Some(loaded) => Ok(LiveMap::new(id.clone(), loaded)),
                    None => Err(ServiceError::no_map(id)),
                }
            });
            match loaded.await {
                Ok(live) if live.is_over() => self.forget(id, &cell),
                Ok(live) if self.holds(id, &cell) => return Ok(live.clone()),
                Ok(_) => {}
                Err(error) => {
                    self.forget(id, &cell);
                    return Err(error);
                }
            }
        }
        Err(ServiceError::Unavailable {
            detail: "this map is loaded again and again, because writes to it fail or it comes and goes"
                .to_owned(),
            retry_after_s: 1,
        })
    }

    /// The map, if it is in memory.
    pub fn in_memory_now(&self, id: &MapId) -> Option<Arc<LiveMap>> {
        self.lock().get(id)?.get().cloned()
    }

    /// Every map in memory.
    pub fn in_memory(&self) -> Vec<Arc<LiveMap>> {
        self.lock().values().filter_map(|cell| cell.get().cloned()).collect()
    }

    /// Takes a cell from the table, unless a map has come to life in it meanwhile.
    fn forget(&self, id: &MapId, cell: &Cell) {
        let mut cells = self.lock();
        let current = cells.get(id).is_some_and(|current| Arc::ptr_eq(current, cell));
        if current && cell.get().is_none_or(|live| live.is_over()) {
            cells.remove(id);
        }
    }

    fn holds(&self, id: &MapId, cell: &Cell) -> bool {
        self.lock().get(id).is_some_and(|current| Arc::ptr_eq(current, cell))
    }

    fn lock(&self) -> MutexGuard<'_, HashMap<MapId, Cell>> {
        // A table of cells is whole after each of its operations.
        self.cells.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
