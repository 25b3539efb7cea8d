//! Loading: maps come to memory when they are first asked for, and again after a write to them failed.
//!
//! Few maps load at once, each after room was made for it: the budget is exceeded by the maps at work and those few. A map
//! that is larger than the budget loads while no other does.

use std::sync::Arc;
use std::time::Instant;

use tokio::runtime::Handle;

use super::live::LiveMap;
use super::loads::Used;
use super::registry::{Cell, Registry};
use super::standing::Standing;
use crate::domain::ids::MapId;
use crate::engine::error::{Result, ServiceError};
use crate::engine::tasks::{blocking_part, to_its_end};
use crate::integrity::rebuild::rebuild;
use crate::store::{FactsForCopies, Order, Store, Taken};

/// Maximum loads for one request of a map whose writes keep failing, or that comes and goes.
const LOADS_MAX: usize = 5;

impl Registry {
    /// Returns the map, loaded if need be, and anew if a write to it failed. Concurrent first requests share one load.
    pub async fn get(self: &Arc<Self>, store: &Store, id: &MapId, used: Used) -> Result<Arc<LiveMap>> {
        for _ in 0..LOADS_MAX {
            let cell = self.cell(id);
            let live = self.filled(&cell, store, id).await?;
            if live.is_over() {
                self.forget(id, &cell);
            } else if self.holds(id, &cell) {
                self.loads.mark_used(&live, used);
                return Ok(live);
            }
        }
        Err(ServiceError::unavailable(
            "this map is loaded again and again, because writes to it fail or it comes and goes",
        ))
    }

    /// Returns the map of a cell, loaded if need be. A load goes to its end when its client has gone: the next one finds the map.
    async fn filled(self: &Arc<Self>, cell: &Cell, store: &Store, id: &MapId) -> Result<Arc<LiveMap>> {
        if let Some(live) = cell.get() {
            return Ok(live.clone());
        }
        let (registry, cell, store, id) = (self.clone(), cell.clone(), store.clone(), id.clone());
        to_its_end(async move {
            let loaded = cell.get_or_try_init(|| registry.load(&store, &id)).await.cloned();
            if loaded.is_err() {
                registry.forget(&id, &cell);
            }
            loaded
        })
        .await?
    }

    /// Loads a map, off the async threads: its index is built there.
    async fn load(self: &Arc<Self>, store: &Store, id: &MapId) -> Result<Arc<LiveMap>> {
        let mut about = store.map_memory(id).await?;
        if about.is_none() {
            // It may be on its way to the disk. One that is not takes no turn from those that are.
            store.committer().settled().await;
            about = store.map_memory(id).await?;
        }
        let about = about.ok_or_else(|| ServiceError::no_map(id))?;
        // Alone if nothing else fits beside it.
        let turn = self.loads.turn(about > self.memory.budget()).await?;
        let (registry, store, id, handle) = (self.clone(), store.clone(), id.clone(), Handle::current());
        let loading = move || {
            let _turn = turn;
            let _loading = registry.loads.begin_load(&id);
            registry.make_room(about);
            let started = Instant::now();
            let loaded = handle.block_on(async {
                // What a map that is forgotten had queued is settled first: a write under way would be missed.
                store.committer().settled().await;
                if registry.follows {
                    let standing = followed(&store, &id).await?;
                    let loaded = rebuild(FactsForCopies(&store), &id, Order::Forwards).await?;
                    return Ok::<_, ServiceError>((loaded, standing));
                }
                let standing = taken(&store, &id).await?;
                let loaded = match registry.promoted(&store, &id).await? {
                    Some(promoted) => Some(promoted),
                    None => rebuild(&store, &id, Order::Forwards).await?,
                };
                Ok((loaded, standing))
            });
            let (loaded, standing) = loaded?;
            let loaded = loaded.ok_or_else(|| ServiceError::no_map(&id))?;
            let feed = registry.feeds.of(loaded.facts.key, loaded.facts.next_event - 1);
            let live = LiveMap::new(id, loaded, standing, feed, &registry.memory);
            registry.loaded(&live, started);
            registry.make_room(0);
            Ok(live)
        };
        blocking_part("load", loading).await?
    }

    /// Counts a load, and warns of a map that is larger than the budget.
    fn loaded(&self, live: &LiveMap, started: Instant) {
        let (bytes, budget) = (live.memory.bytes(), self.memory.budget());
        self.loads.count_load(started.elapsed(), bytes > budget);
        if bytes > budget {
            tracing::warn!(map = %live.id, bytes, budget, "a map is larger than the memory for maps (--map-memory)");
        }
    }
}

/// Begins to follow a map: what happens from here on is told or makes it load anew.
async fn followed(store: &Store, id: &MapId) -> Result<Standing> {
    let map = store.map_key(id).await?.ok_or_else(|| ServiceError::no_map(id))?;
    store.follow(&[map]).await?;
    Ok(Standing::Follower { rewrites: store.rewrites(map).await?, since: Instant::now() })
}

/// Takes a map for this server, where others could have it.
async fn taken(store: &Store, id: &MapId) -> Result<Standing> {
    match store.take(id).await? {
        None => Ok(Standing::Alone),
        Some(Taken::Here(lease)) => {
            // What its former owner left to be done behind.
            store.committer().look_for_work();
            Ok(Standing::Owner(lease))
        }
        Some(Taken::NoMap) => Err(ServiceError::no_map(id)),
        Some(Taken::Elsewhere) => Err(ServiceError::unavailable("another server has this map; try again")),
    }
}
