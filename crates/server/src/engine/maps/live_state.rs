//! The state of a map in memory: its index at one version.

use crate::domain::event::Event;
use crate::recognition::map::index::MapIndex;

/// An index of a map with fewer bytes on disk is freed where it is dropped.
const FREED_AT_ONCE_BYTES: u64 = 1 << 20;

/// A map at one version.
#[derive(Debug)]
pub(in crate::engine) struct State {
    /// Its facts and what follows from them.
    pub index: MapIndex,
    /// Grows by one with each write.
    pub version: u64,
    /// The number of the next event.
    pub(super) next_event: u64,
}

impl Drop for State {
    fn drop(&mut self) {
        free(std::mem::take(&mut self.index));
    }
}

/// Frees an index. A large one takes long, and its last owner may be an async thread or hold a lock.
pub(super) fn free(index: MapIndex) {
    if index.bytes() < FREED_AT_ONCE_BYTES {
        return;
    }
    // Without a runtime no one waits for this thread.
    if let Ok(runtime) = tokio::runtime::Handle::try_current() {
        runtime.spawn_blocking(move || drop(index));
    }
}

/// Numbers events; their map's version is the one they belong to.
pub(super) fn number(state: &mut State, mut events: Vec<Event>) -> Vec<Event> {
    for event in &mut events {
        event.seq = state.next_event;
        event.map_version = state.version;
        state.next_event += 1;
    }
    events
}
