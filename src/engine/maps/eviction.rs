//! Loading and eviction: maps come to memory on demand, and idle ones leave it under a budget, least recently used first.
//!
//! A map at work is never evicted. Whatever works on a map (a request, a job on its way to the disk, a model's question)
//! holds an `Arc` of it, and a new one is had only through the table, under its lock. So a cell and a map that under that
//! lock have no other owner are idle, everything acknowledged of them is on disk, and no other owner can appear.
//!
//! Few maps load at once, each after room was made for it: the budget is exceeded by the maps at work and those few. A map
//! that is larger than the budget loads while no other does.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Instant;

use tokio::runtime::Handle;
use tokio::sync::{OnceCell, Semaphore};
use tokio::task::spawn_blocking;

use super::live::LiveMap;
use super::registry::{Cell, Registry};
use crate::config::logging::in_part;
use crate::domain::ids::MapId;
use crate::engine::error::ServiceError;
use crate::engine::limits::bounds::cores;
use crate::integrity::rebuild::rebuild;
use crate::store::{Order, Store, StoreError};

/// Whether a map was asked for by a client, or by work in the background, after which it may leave first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::engine) enum Used {
    ByClient,
    InBackground,
}

/// How maps come to memory and leave it, and how often they did.
#[derive(Debug)]
pub(in crate::engine) struct Loads {
    turns: Arc<Semaphore>,
    at_once: u32,
    /// Counts uses, to tell which came first.
    uses: AtomicU64,
    is_evicting: AtomicBool,
    loaded: AtomicU64,
    microseconds: AtomicU64,
    evicted: AtomicU64,
    oversized: AtomicU64,
}

/// Loads and evictions since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(in crate::engine) struct LoadFigures {
    pub loads: u64,
    pub load_microseconds: u64,
    pub evictions: u64,
    /// Loads of maps that are larger than the budget.
    pub oversized: u64,
}

impl Default for Loads {
    fn default() -> Self {
        let at_once = cores().max(2);
        Self {
            turns: Arc::new(Semaphore::new(at_once)),
            at_once: at_once as u32,
            uses: AtomicU64::new(0),
            is_evicting: AtomicBool::new(false),
            loaded: AtomicU64::new(0),
            microseconds: AtomicU64::new(0),
            evicted: AtomicU64::new(0),
            oversized: AtomicU64::new(0),
        }
    }
}

impl Loads {
    /// Marks a map as the one used last. Work in the background does not count as use.
    pub fn mark_used(&self, live: &LiveMap, used: Used) {
        if used == Used::ByClient {
            live.last_use.store(self.uses.fetch_add(1, Ordering::Relaxed) + 1, Ordering::Relaxed);
        }
    }

    /// Loads and evictions since the start.
    pub fn figures(&self) -> LoadFigures {
        LoadFigures {
            loads: self.loaded.load(Ordering::Relaxed),
            load_microseconds: self.microseconds.load(Ordering::Relaxed),
            evictions: self.evicted.load(Ordering::Relaxed),
            oversized: self.oversized.load(Ordering::Relaxed),
        }
    }
}

impl Registry {
    /// Loads a map, off the async threads: its index is built there. It goes to its end when its client has gone.
    pub(in crate::engine) async fn load(
        self: &Arc<Self>,
        store: &Store,
        id: &MapId,
    ) -> Result<Arc<LiveMap>, ServiceError> {
        let mut about = store.map_memory(id).await?;
        if about.is_none() {
            // It may be on its way to the disk. One that is not takes no turn from those that are.
            store.committer().settled().await;
            about = store.map_memory(id).await?;
        }
        let about = about.ok_or_else(|| ServiceError::no_map(id))?;
        // Alone if nothing else fits beside it.
        let turns = if about > self.memory.budget() { self.loads.at_once } else { 1 };
        let turn =
            self.loads.turns.clone().acquire_many_owned(turns).await.map_err(|_| StoreError::Closed)?;
        let (registry, store, id, handle) = (self.clone(), store.clone(), id.clone(), Handle::current());
        let loading = move || {
            let _turn = turn;
            registry.make_room(about);
            let started = Instant::now();
            let loaded = handle.block_on(async {
                // What a map that is forgotten had queued is settled first: a write under way would be missed.
                store.committer().settled().await;
                rebuild(&store, &id, Order::Forwards).await
            })?;
            let loaded = loaded.ok_or_else(|| ServiceError::no_map(&id))?;
            let feed = registry.feeds.of(loaded.facts.key, loaded.facts.next_event - 1);
            let live = LiveMap::new(id, loaded, feed, &registry.memory);
            registry.loaded(&live, started);
            registry.make_room(0);
            Ok(live)
        };
        spawn_blocking(in_part("load", loading)).await.map_err(ServiceError::panicked)?
    }

    fn loaded(&self, live: &LiveMap, started: Instant) {
        self.loads.loaded.fetch_add(1, Ordering::Relaxed);
        self.loads.microseconds.fetch_add(started.elapsed().as_micros() as u64, Ordering::Relaxed);
        let (bytes, budget) = (live.memory.bytes(), self.memory.budget());
        if bytes > budget {
            self.loads.oversized.fetch_add(1, Ordering::Relaxed);
            tracing::warn!(map = %live.id, bytes, budget, "a map is larger than the memory for maps (--map-memory)");
        }
    }

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
    fn make_room(&self, more: u64) {
        let excess = self.memory.excess(more);
        if excess == 0 {
            return;
        }
        let evicted = self.take_idle(excess);
        self.loads.evicted.fetch_add(evicted.len() as u64, Ordering::Relaxed);
        drop(evicted);
    }

    /// Takes idle maps of so many bytes from the table, and the cells that hold nothing.
    fn take_idle(&self, bytes: u64) -> Vec<Cell> {
        let mut cells = self.lock();
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
