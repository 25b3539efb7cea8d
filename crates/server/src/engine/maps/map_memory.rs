//! The memory of the maps: a budget, and what each map takes of it.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Where eviction stops, in sixteenths of the budget: a little below it, so that not every load evicts.
const EVICT_DOWN_TO: u64 = 15;

/// The memory that maps take, and may take.
#[derive(Debug)]
pub(in crate::engine) struct MapMemory {
    budget: u64,
    used: AtomicU64,
}

/// What one map takes of the memory; given back when dropped.
#[derive(Debug)]
pub(in crate::engine) struct MemoryShare {
    of: Arc<MapMemory>,
    bytes: AtomicU64,
}

impl MapMemory {
    pub fn new(budget: u64) -> Arc<Self> {
        Arc::new(Self { budget, used: AtomicU64::new(0) })
    }

    /// Returns the most that maps may take together, in bytes.
    pub fn budget(&self) -> u64 {
        self.budget
    }

    /// Returns what they take, in bytes.
    pub fn used(&self) -> u64 {
        self.used.load(Ordering::Relaxed)
    }

    /// Returns how much has to go before `more` fits, in bytes.
    pub fn excess(&self, more: u64) -> u64 {
        let wanted = self.used().saturating_add(more);
        if wanted <= self.budget {
            return 0;
        }
        wanted.saturating_sub(self.budget / 16 * EVICT_DOWN_TO)
    }

    /// Takes a share that grows and shrinks with its map.
    pub fn share(self: &Arc<Self>, bytes: u64) -> MemoryShare {
        self.used.fetch_add(bytes, Ordering::Relaxed);
        MemoryShare { of: self.clone(), bytes: AtomicU64::new(bytes) }
    }
}

impl MemoryShare {
    /// Returns what the map takes, in bytes.
    pub fn bytes(&self) -> u64 {
        self.bytes.load(Ordering::Relaxed)
    }

    /// Sets what the map takes now, in bytes.
    pub fn set(&self, bytes: u64) {
        let before = self.bytes.swap(bytes, Ordering::Relaxed);
        // Wraps around where it shrinks.
        self.of.used.fetch_add(bytes.wrapping_sub(before), Ordering::Relaxed);
    }
}

impl Drop for MemoryShare {
    fn drop(&mut self) {
        self.set(0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_add_up_and_are_given_back() {
        let memory = MapMemory::new(160);
        let (a, b) = (memory.share(100), memory.share(50));
        assert_eq!((memory.used(), memory.excess(10), memory.excess(20)), (150, 0, 20));
        a.set(20);
        assert_eq!((memory.used(), a.bytes()), (70, 20));
        drop((a, b));
        assert_eq!(memory.used(), 0);
    }
}
