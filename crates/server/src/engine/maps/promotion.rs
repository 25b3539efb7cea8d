//! Promotion: the copy of another server's map becomes this server's own, once this server owns the map.
//!
//! A map that was loaded while it was another server's need not be loaded again. A copy is promoted if it is at the version that is
//! on disk, and as large as the map's row says; else it is given up, and the map is loaded.

use std::mem::take;
use std::sync::Arc;
use std::time::Duration;

use tokio::time::sleep;

use super::live::LiveMap;
use super::loads::Used;
use super::registry::Registry;
use crate::domain::ids::MapId;
use crate::engine::error::Result;
use crate::engine::lock::lock;
use crate::integrity::rebuild::RebuiltMap;
use crate::store::{MapFacts, News, Store};

/// Times to look whether the last reader of a copy is done.
const LOOKS: u32 = 200;

/// The time between two of them.
const LOOKS_EVERY: Duration = Duration::from_millis(10);

impl Registry {
    /// Returns the copy of a map that this server owns by now, to be its own; `None` if there is none, or not one as new as what is on
    /// disk. Blocks: not for async threads.
    pub(super) async fn promoted(&self, store: &Store, id: &MapId) -> Result<Option<RebuiltMap>> {
        let Some(copies) = &self.copies else { return Ok(None) };
        // One that is being loaded is waited for: it began before a load that would begin now.
        if copies.in_memory_now(id).is_none() && !copies.loads.is_loading(id) {
            return Ok(None);
        }
        let Ok(copy) = copies.get(store, id, Used::InBackground).await else { return Ok(None) };
        let facts = up_to_date(store, &copy).await;
        copy.throw_away();
        copies.forget_over(id);
        let Some(facts) = facts? else { return Ok(None) };
        let Some(copy) = alone(copy).await else { return Ok(None) };
        let Ok(mut state) = copy.state.into_inner() else { return Ok(None) };
        if (state.version, state.index.figures()) != (facts.version, facts.figures) {
            tracing::warn!(map = %id, version = state.version, "a copy is not as the map's row says; the map is loaded");
            return Ok(None);
        }
        let mut index = take(&mut state.index);
        index.reserve(facts.next_keyframe.0, facts.next_anchor.0);
        lock(&self.loads.figures).promoted += 1;
        tracing::info!(map = %id, version = facts.version, "a copy became this server's own map");
        Ok(Some(RebuiltMap { facts, index }))
    }
}

/// Brings a copy up to date, and returns the map's row; `None` if the log of changes does not tell enough. Nobody writes to the map
/// meanwhile: this server owns it.
async fn up_to_date(store: &Store, copy: &LiveMap) -> Result<Option<MapFacts>> {
    let Some((rewrites, _)) = copy.standing.followed_since() else { return Ok(None) };
    let _lane = copy.lane.lock().await;
    loop {
        match store.news(copy.key, copy.newest_version(), rewrites).await? {
            News::Changes(versions) if versions.is_empty() => break,
            News::Changes(versions) => copy.take_over(&versions)?,
            News::Unknown | News::Gone => return Ok(None),
        }
    }
    let facts = store.map_facts(&copy.id, rewrites).await?;
    Ok(facts.filter(|facts| facts.key == copy.key))
}

/// Returns a copy that has left the table, once its last reader is done; `None` if that takes long.
async fn alone(mut copy: Arc<LiveMap>) -> Option<LiveMap> {
    for _ in 0..LOOKS {
        match Arc::try_unwrap(copy) {
            Ok(alone) => return Some(alone),
            Err(shared) => copy = shared,
        }
        sleep(LOOKS_EVERY).await;
    }
    None
}
