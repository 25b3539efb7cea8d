//! Loads: the turns of maps to come to memory, and counts of loads and evictions.

use std::collections::HashSet;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use tokio::sync::{OwnedSemaphorePermit, Semaphore};

use super::live::LiveMap;
use crate::config::limits::cores;
use crate::domain::ids::MapId;
use crate::engine::error::Result;
use crate::engine::lock::lock;
use crate::store::StoreError;

/// The user of a map: a client, or work in the background, after which the map may leave first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::engine) enum Used {
    ByClient,
    InBackground,
}

/// Marks a map as being loaded until it is dropped.
pub(in crate::engine) struct LoadGuard<'l>(&'l Loads, MapId);

impl Drop for LoadGuard<'_> {
    fn drop(&mut self) {
        lock(&self.0.loading).remove(&self.1);
    }
}

/// The loads and evictions under way, and how many there were.
#[derive(Debug)]
pub(in crate::engine) struct Loads {
    turns: Arc<Semaphore>,
    at_once: u32,
    /// Maps that have their turn, and are being loaded.
    loading: Mutex<HashSet<MapId>>,
    /// Counts uses, to tell which came first.
    uses: AtomicU64,
    /// Whether somebody evicts in the background.
    pub(super) is_evicting: AtomicBool,
    pub figures: Mutex<LoadFigures>,
}

/// Loads and evictions since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LoadFigures {
    /// Maps that came to memory.
    pub loads: u64,
    /// Microseconds that their loading took.
    pub load_microseconds: u64,
    /// Maps that left memory for others.
    pub evictions: u64,
    /// Loads of maps that are larger than the budget.
    pub oversized: u64,
    /// Copies that became this server's own.
    pub promoted: u64,
}

impl Default for Loads {
    fn default() -> Self {
        let at_once = cores().max(2);
        Self {
            turns: Arc::new(Semaphore::new(at_once)),
            at_once: at_once as u32,
            loading: Mutex::default(),
            uses: AtomicU64::new(0),
            is_evicting: AtomicBool::new(false),
            figures: Mutex::default(),
        }
    }
}

impl Loads {
    /// Waits for the turn of a map to be loaded; `alone` while no other map is.
    pub async fn turn(&self, alone: bool) -> Result<OwnedSemaphorePermit> {
        let turns = if alone { self.at_once } else { 1 };
        Ok(self.turns.clone().acquire_many_owned(turns).await.map_err(|_| StoreError::Closed)?)
    }

    /// Marks a map that has its turn as being loaded, until the guard is dropped.
    pub fn begin_load(&self, map: &MapId) -> LoadGuard<'_> {
        lock(&self.loading).insert(map.clone());
        LoadGuard(self, map.clone())
    }

    /// Whether a map has its turn, and is being loaded.
    pub fn is_loading(&self, map: &MapId) -> bool {
        lock(&self.loading).contains(map)
    }

    /// Marks a map as the one used last. Work in the background does not count as use.
    pub fn mark_used(&self, live: &LiveMap, used: Used) {
        if used == Used::ByClient {
            live.last_use.store(self.uses.fetch_add(1, Ordering::Relaxed) + 1, Ordering::Relaxed);
        }
    }

    /// Counts a load, and whether its map is larger than the budget.
    pub fn count_load(&self, took: Duration, is_oversized: bool) {
        let mut figures = lock(&self.figures);
        figures.loads += 1;
        figures.load_microseconds += took.as_micros() as u64;
        figures.oversized += u64::from(is_oversized);
    }
}
