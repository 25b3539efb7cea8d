//! Eviction: idle maps leave memory under a budget, least recently used first.
//!
//! A map at work is never evicted. Whatever works on a map (a request, a job on its way to the disk, a model's question)
//! holds an `Arc` of it, and a new one is had only through the table, under its lock. So a cell and a map that under that
//! lock have no other owner are idle, everything acknowledged of them is on disk, and no other owner can appear.

use std::sync::Arc;
use std::sync::atomic::Ordering;

use tokio::sync::OnceCell;
use tokio::task::spawn_blocking;

use super::registry::{Cell, Registry};
use crate::domain::ids::MapId;
use crate::engine::lock::lock;

impl Registry {
    /// Evicts in the background if the maps have grown beyond the budget.
    pub(in crate::engine) fn keep_to_budget(self: &Arc<Self>) {
        if self.memory.excess(0) == 0 || !self.loads.begin_evicting() {
            return;
        }
        let registry = self.clone();
        drop(spawn_blocking(move || {
            registry.make_room(0);
            registry.loads.end_evicting();
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
        cells.retain(|id, cell| match idle_in(cell) {
            Some(Idle::Empty) => false,
            Some(Idle::Map { last_use, bytes }) => {
                idle.push((last_use, id.clone(), bytes));
                true
            }
            None => true,
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

/// A cell that no other part of the process holds.
enum Idle {
    /// Nothing was loaded into it.
    Empty,
    Map {
        last_use: u64,
        bytes: u64,
    },
}

/// Returns what a cell holds if nobody works on it: under the lock of the table, nobody can begin to.
fn idle_in(cell: &mut Cell) -> Option<Idle> {
    let cell = Arc::get_mut(cell)?;
    let Some(live) = OnceCell::get_mut(cell) else { return Some(Idle::Empty) };
    let live = Arc::get_mut(live)?;
    Some(Idle::Map { last_use: live.last_use.load(Ordering::Relaxed), bytes: live.memory.bytes() })
}
