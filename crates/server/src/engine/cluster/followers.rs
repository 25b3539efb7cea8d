//! Followers: the copies of maps that other servers own, and figures about them.

use std::collections::HashMap;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use tokio::sync::Semaphore;

use crate::domain::ids::MapId;
use crate::engine::lock::lock;
use crate::engine::maps::registry::Registry;
use crate::store::MapKey;

/// Share of the memory for maps that copies may take, beside the maps that this server owns: one part in so many.
const PART_OF_MEMORY: u64 = 4;

/// A copy that nobody asked for so long is given up.
const UNUSED_KEPT: Duration = Duration::from_mins(1);

/// Maps that are loaded ahead at once. Further ones are loaded when this server has them.
const AHEAD_AT_ONCE: usize = 2;

/// The copies of maps that other servers own.
#[derive(Debug)]
pub(in crate::engine) struct Followers {
    pub registry: Arc<Registry>,
    /// Versions that copies took over from the log.
    pub versions: AtomicU64,
    /// Copies that were loaded anew.
    pub loaded_anew: AtomicU64,
    /// When all copies were last found to be up to date; none before there was one.
    up_to_date: Mutex<Option<Instant>>,
    /// The last use of each copy, and since when it is the last.
    uses: Mutex<HashMap<MapKey, (u64, Instant)>>,
    /// The turns of copies that are loaded ahead.
    pub(super) ahead: Arc<Semaphore>,
}

impl Followers {
    /// Returns none yet, beside owned maps that may take this memory, in bytes.
    pub fn new(map_memory: u64) -> Self {
        Self {
            registry: Arc::new(Registry::of_followed(map_memory / PART_OF_MEMORY)),
            versions: AtomicU64::new(0),
            loaded_anew: AtomicU64::new(0),
            up_to_date: Mutex::default(),
            uses: Mutex::default(),
            ahead: Arc::new(Semaphore::new(AHEAD_AT_ONCE)),
        }
    }

    /// Returns the copies; those that nobody asked for in a while are given up.
    pub(super) fn in_use(&self) -> Vec<(MapId, MapKey)> {
        let now = Instant::now();
        let mut uses = lock(&self.uses);
        let mut copies = self.registry.in_memory(|live| !live.is_over());
        copies.retain(|copy| {
            let last = copy.last_use.load(Ordering::Relaxed);
            let of_copy = uses.entry(copy.key).or_insert((last, now));
            if of_copy.0 != last {
                *of_copy = (last, now);
            }
            let is_used = now.duration_since(of_copy.1) < UNUSED_KEPT;
            if !is_used {
                copy.throw_away();
                self.registry.forget_over(&copy.id);
            }
            is_used
        });
        uses.retain(|key, _| copies.iter().any(|copy| copy.key == *key));
        copies.iter().map(|copy| (copy.id.clone(), copy.key)).collect()
    }

    /// Notes that every copy is as new as what is on disk.
    pub(super) fn note_up_to_date(&self) {
        *lock(&self.up_to_date) = Some(Instant::now());
    }

    /// Returns the number of copies.
    pub fn count(&self) -> u64 {
        self.registry.in_memory(|live| !live.is_over()).len() as u64
    }

    /// Returns the seconds since every copy was up to date; 0 without copies.
    pub fn lag_s(&self) -> u64 {
        let up_to_date = *lock(&self.up_to_date);
        if self.count() == 0 { 0 } else { up_to_date.map_or(0, |at| at.elapsed().as_secs()) }
    }
}
