//! The maps in memory: loaded when first asked for, again after a write failed, and evicted when memory is short.
//!
//! No map may be in memory twice: each would decide upon what it knows, and the later commit would undo the earlier one. So
//! a map comes to memory by one way only, a load into the cell that the table holds for it. A cell leaves the table
//! only when nothing is in it, when its map decides nothing any more, or when no other part of the process holds the cell or
//! its map ([`super::eviction`]); and what was loaded into a cell that has left is thrown away.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use tokio::sync::OnceCell;

use super::eviction::{Loads, Used};
use super::feeds::Feeds;
use super::live::LiveMap;
use super::map_memory::MapMemory;
use crate::domain::ids::MapId;
use crate::engine::error::ServiceError;
use crate::store::Store;

/// How often a request loads a map whose writes keep failing, or that comes and goes.
const LOADS_MAX: usize = 5;

pub(in crate::engine) type Cell = Arc<OnceCell<Arc<LiveMap>>>;

/// The maps in memory.
#[derive(Debug)]
pub(in crate::engine) struct Registry {
    cells: Mutex<HashMap<MapId, Cell>>,
    /// What the maps take, and may take.
    pub memory: Arc<MapMemory>,
    /// How maps come to memory and leave it.
    pub loads: Loads,
    /// Who listens to the maps' events.
    pub feeds: Arc<Feeds>,
    /// Held while a map is made or deleted, so that a name means one map at a time.
    pub births: Arc<tokio::sync::Mutex<()>>,
}

impl Registry {
    pub fn new(memory: u64) -> Self {
        Self {
            cells: Mutex::default(),
            memory: MapMemory::new(memory),
            loads: Loads::default(),
            feeds: Arc::default(),
            births: Arc::default(),
        }
    }

    /// Returns the map, loaded if need be, and anew if a write to it failed. Concurrent first requests share one load.
    pub async fn get(
        self: &Arc<Self>,
        store: &Store,
        id: &MapId,
        used: Used,
    ) -> Result<Arc<LiveMap>, ServiceError> {
        for _ in 0..LOADS_MAX {
            let cell = self.lock().entry(id.clone()).or_default().clone();
            match cell.get_or_try_init(|| self.load(store, id)).await {
                Ok(live) if live.is_over() => self.forget(id, &cell),
                Ok(live) if self.holds(id, &cell) => {
                    self.loads.mark_used(live, used);
                    return Ok(live.clone());
                }
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

    /// Returns the map, if it is in memory now; this does not count as use.
    pub fn in_memory_now(&self, id: &MapId) -> Option<Arc<LiveMap>> {
        self.lock().get(id)?.get().filter(|live| !live.is_over()).cloned()
    }

    /// Returns the maps in memory that are wanted. They stay there while they are held, and the others may leave.
    pub fn in_memory(&self, mut wanted: impl FnMut(&LiveMap) -> bool) -> Vec<Arc<LiveMap>> {
        let cells = self.lock();
        cells.values().filter_map(|cell| cell.get().filter(|live| wanted(live)).cloned()).collect()
    }

    /// Looks at every map in memory, holding none: what is quick and waits for nothing.
    pub fn each_in_memory(&self, mut look: impl FnMut(&LiveMap)) {
        self.lock().values().filter_map(|cell| cell.get()).for_each(|live| look(live));
    }

    /// Takes a cell from the table, unless a map has come to life in it meanwhile.
    fn forget(&self, id: &MapId, cell: &Cell) {
        let mut cells = self.lock();
        let current = cells.get(id).is_some_and(|current| Arc::ptr_eq(current, cell));
        if current && cell.get().is_none_or(|live| live.is_over()) {
            cells.remove(id);
        }
    }

    /// Takes a map from the table if it decides nothing any more.
    pub fn forget_over(&self, id: &MapId) {
        let cell = self.lock().get(id).cloned();
        if let Some(cell) = cell {
            self.forget(id, &cell);
        }
    }

    fn holds(&self, id: &MapId, cell: &Cell) -> bool {
        self.lock().get(id).is_some_and(|current| Arc::ptr_eq(current, cell))
    }

    pub(in crate::engine) fn lock(&self) -> MutexGuard<'_, HashMap<MapId, Cell>> {
        // A table of cells is whole after each of its operations.
        self.cells.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
