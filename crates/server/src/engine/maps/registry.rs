//! The table of the maps in memory, through which they come and leave.
//!
//! No map may be in memory twice: each would decide upon what it knows, and the later commit would undo the earlier one. So
//! a map comes to memory by one way only, a load into the cell that the table holds for it ([`super::loading`]). A cell
//! leaves the table only when nothing is in it, when its map decides nothing any more, or when no other part of the process
//! holds the cell or its map ([`super::eviction`]); and what was loaded into a cell that has left is thrown away.

use std::collections::HashMap;
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex};

use tokio::sync::OnceCell;

use super::feeds::Feeds;
use super::live::{Figures, LiveMap};
use super::loads::Loads;
use super::map_memory::MapMemory;
use crate::domain::ids::MapId;
use crate::engine::lock::lock;

/// A map's place in the table; empty until it is loaded.
pub(in crate::engine) type Cell = Arc<OnceCell<Arc<LiveMap>>>;

/// The maps in memory.
#[derive(Debug)]
pub(in crate::engine) struct Registry {
    pub(super) cells: Mutex<HashMap<MapId, Cell>>,
    /// What the maps take, and may take.
    pub memory: Arc<MapMemory>,
    /// The turns of maps to be loaded, and counts.
    pub loads: Loads,
    /// Who listens to the maps' events.
    pub feeds: Arc<Feeds>,
    /// Held while a map is made or deleted, so that a name means one map at a time.
    pub births: Arc<tokio::sync::Mutex<()>>,
    /// Whether it holds copies of maps that other servers own.
    pub(super) follows: bool,
    /// The table of those copies, which may become this server's own.
    pub(super) copies: Option<Arc<Registry>>,
}

impl Registry {
    /// Returns a table of this server's maps, which may take this memory, in bytes.
    pub fn new(memory: u64, copies: Option<Arc<Self>>) -> Self {
        Self {
            cells: Mutex::default(),
            memory: MapMemory::new(memory),
            loads: Loads::default(),
            feeds: Arc::default(),
            births: Arc::default(),
            follows: false,
            copies,
        }
    }

    /// Returns a table of copies of maps that other servers own.
    pub fn of_followed(memory: u64) -> Self {
        Self { follows: true, ..Self::new(memory, None) }
    }

    /// Returns the cell that the table holds for a map, an empty one if it held none.
    pub(super) fn cell(&self, id: &MapId) -> Cell {
        lock(&self.cells).entry(id.clone()).or_default().clone()
    }

    /// Returns the map, if it is in memory now; this does not count as use.
    pub fn in_memory_now(&self, id: &MapId) -> Option<Arc<LiveMap>> {
        lock(&self.cells).get(id)?.get().filter(|live| !live.is_over()).cloned()
    }

    /// Whether a map is in memory, or on its way there.
    pub fn has(&self, id: &MapId) -> bool {
        lock(&self.cells).contains_key(id)
    }

    /// Returns the maps in memory that are wanted. They stay there while they are held, and the others may leave.
    pub fn in_memory(&self, mut wanted: impl FnMut(&LiveMap) -> bool) -> Vec<Arc<LiveMap>> {
        let cells = lock(&self.cells);
        cells.values().filter_map(|cell| cell.get().filter(|live| wanted(live)).cloned()).collect()
    }

    /// Returns how large each map in memory is. It holds none, and waits for nothing.
    pub fn figures(&self) -> Vec<Figures> {
        lock(&self.cells).values().filter_map(|cell| cell.get()).map(|live| live.figures()).collect()
    }

    /// Takes a cell from the table, unless a map has come to life in it meanwhile.
    pub(super) fn forget(&self, id: &MapId, cell: &Cell) {
        let mut cells = lock(&self.cells);
        let current = cells.get(id).is_some_and(|current| Arc::ptr_eq(current, cell));
        if current && cell.get().is_none_or(|live| live.is_over()) {
            cells.remove(id);
        }
    }

    /// Takes a map from the table if it decides nothing any more.
    pub fn forget_over(&self, id: &MapId) {
        let cell = lock(&self.cells).get(id).cloned();
        if let Some(cell) = cell {
            self.forget(id, &cell);
        }
    }

    /// Takes the releases of a deleted map from the table: they decide and answer nothing any more. What is being loaded is thrown away.
    /// Returns those that were in memory.
    pub fn forget_releases(&self, of: &MapId) -> Vec<Arc<LiveMap>> {
        let is_release = |id: &MapId| matches!(id.parts(), (map, Some(_)) if map == of.as_str());
        let mut ended = Vec::new();
        lock(&self.cells).retain(|id, cell| {
            if is_release(id) {
                ended.extend(cell.get().cloned());
            }
            !is_release(id)
        });
        for live in &ended {
            live.gone.store(true, Ordering::Release);
        }
        ended
    }

    /// Whether the table holds this cell for the map.
    pub(super) fn holds(&self, id: &MapId, cell: &Cell) -> bool {
        lock(&self.cells).get(id).is_some_and(|current| Arc::ptr_eq(current, cell))
    }
}
