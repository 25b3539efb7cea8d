//! Maps in memory: how they are loaded, written, shared and evicted.

mod eviction;
pub(super) mod features;
pub(super) mod feeds;
mod following;
mod leaving;
pub(super) mod live;
mod live_state;
mod loading;
pub(super) mod loads;
pub(super) mod map_memory;
pub(super) mod pinned;
mod promotion;
pub(super) mod registry;
mod release_uses;
mod standing;
mod use_counting;
pub(super) mod write_path;
