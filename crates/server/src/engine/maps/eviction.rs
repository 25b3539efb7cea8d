//! Eviction: idle maps leave memory under a budget, least recently used first.
//!
//! A map at work is never evicted. Whatever works on a map (a request, a job on its way to the disk, a model's question)
//! holds an `Arc` of it, and a new one is had only through the table, under its lock. So a cell and a map that under that
//! lock have no other owner are idle, everything acknowledged of them is on disk, and no other owner can appear.

use std::sync::Arc;
use std::sync::atomic::Ordering;

use tokio::task::spawn_blocking;

use super::registry::{Cell, Registry};
use crate::domain::ids::MapId;
use crate::engine::lock::lock;

impl Registry {
    /// Evicts in the background if the maps have grown beyond the budget.
    pub(in crate::engine) fn keep_to_budget(self: &Arc<Self>) {
        if self.memory.excess(0) == 0 || self.loads.is_evicting.swap(true, Ordering::AcqRel) {
            return;
        }
        let registry = self.clone();
        drop(spawn_blocking(move || {
            registry.make_room(0);
            registry.loads.is_evicting.store(false, Ordering::Release);
        }));
    }

    /// Evicts idle maps, least recently used first, until `more` bytes fit into the budget or all that is left is at work.
    /// Frees their memory: not for async threads.
    pub(super) fn make_room(&self, more: u64) {
        let excess = self.memory.excess(more);
        if excess == 0 {
            return;
        }
        let evicted = self.take_idle(excess);
        lock(&self.loads.figures).evictions += evicted.len() as u64;
        drop(evicted);
    }

    /// Takes idle maps of so many bytes from the table, and the cells that hold nothing.
    fn take_idle(&self, bytes: u64) -> Vec<Cell> {
        let mut cells = lock(&self.cells);
        let mut idle: Vec<(u64, MapId, u64)> = Vec::new();
        cells.retain(|id, cell| {
            // What nobody holds is idle: under the lock of the table, nobody can begin to.
            let Some(unheld) = Arc::get_mut(cell) else { return true };
            let Some(live) = unheld.get_mut() else { return false };
            if let Some(live) = Arc::get_mut(live) {
                idle.push((live.last_use.load(Ordering::Relaxed), id.clone(), live.memory.bytes()));
            }
            true
        });
        idle.sort_unstable();
        let mut taken = 0;
        let mut evicted = Vec::new();
        for (_, id, of_map) in idle {
            if taken >= bytes {
                break;
            }
            taken += of_map;
            evicted.extend(cells.remove(&id));
        }
        // Given back before the lock is, so that no other thread evicts for the same need again.
        for live in evicted.iter().filter_map(|cell| cell.get()) {
            live.memory.set(0);
        }
        evicted
    }
}
