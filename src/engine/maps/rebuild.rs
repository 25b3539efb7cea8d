//! Rebuild: the index of a map is built from the facts that the store tells.

use crate::domain::ids::MapId;
use crate::recognition::map::index::MapIndex;
use crate::store::{MapFacts, Order, Store, StoreError};

/// A map as it is on disk.
#[derive(Debug)]
pub(in crate::engine) struct RebuiltMap {
    /// What its row says.
    pub facts: MapFacts,
    /// Everything that follows from its facts.
    pub index: MapIndex,
}

/// Builds a map's index from its facts, told in an order; `None` if there is no such map. The index equals the live one:
/// that is the law of the house.
pub(in crate::engine) async fn rebuild(
    store: &Store,
    id: &MapId,
    order: Order,
) -> Result<Option<RebuiltMap>, StoreError> {
    let mut index = MapIndex::default();
    let facts = store.load(id, order, |changes| index.apply(changes)).await?;
    Ok(facts.map(|facts| {
        index.reserve(facts.next_keyframe.0, facts.next_anchor.0);
        RebuiltMap { facts, index }
    }))
}
