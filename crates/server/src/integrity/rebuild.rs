//! Rebuild: the index of a map from its facts on disk.

use std::panic::resume_unwind;
use std::sync::mpsc::sync_channel;

use tokio::task::spawn_blocking;

use crate::domain::change::Change;
use crate::domain::ids::MapId;
use crate::recognition::map::index::MapIndex;
use crate::store::{FactSource, MapFacts, Order, StoreError};

/// A map as it is on disk.
#[derive(Debug)]
pub struct RebuiltMap {
    /// Its row.
    pub facts: MapFacts,
    /// Everything that follows from its facts.
    pub index: MapIndex,
}

/// Parts that are read ahead of the index, which builds a block of its inverted file at once: 23 MB of keyframes with 700 words.
const PARTS_AHEAD: usize = 16;

/// Builds a map's index from its facts, read in an order; `None` if there is no such map. The index equals the live one:
/// that is the law of the house. One thread reads while another builds.
pub async fn rebuild(
    mut source: impl FactSource,
    id: &MapId,
    order: Order,
) -> Result<Option<RebuiltMap>, StoreError> {
    let (give, parts) = sync_channel::<Vec<Change>>(PARTS_AHEAD);
    let building = spawn_blocking(move || {
        let mut index = MapIndex::default();
        index.begin_loading();
        // The other order derives all at every part: the law is that it must not matter.
        if order == Order::Forwards {
            index.put_objects_off();
        }
        for part in parts {
            index.apply(&part);
        }
        index.finish_loading();
        index
    });
    // A builder that is gone has panicked, which is told below.
    let facts = source.load(id, order, |changes| drop(give.send(changes))).await;
    drop(give);
    let mut index = match building.await {
        Ok(index) => index,
        Err(error) => match error.try_into_panic() {
            Ok(panic) => resume_unwind(panic),
            // The process is stopping.
            Err(_) => return Err(StoreError::Closed),
        },
    };
    Ok(facts?.map(|facts| {
        index.reserve(facts.next_keyframe.0, facts.next_anchor.0);
        RebuiltMap { facts, index }
    }))
}
