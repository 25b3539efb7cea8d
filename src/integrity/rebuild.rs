//! Rebuild: the index of a map from its facts on disk.

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

/// Builds a map's index from its facts, read in an order; `None` if there is no such map. The index equals the live one:
/// that is the law of the house.
pub async fn rebuild(
    mut source: impl FactSource,
    id: &MapId,
    order: Order,
) -> Result<Option<RebuiltMap>, StoreError> {
    let mut index = MapIndex::default();
    index.begin_loading();
    let facts = source.load(id, order, |changes| index.apply(changes)).await?;
    index.finish_loading();
    Ok(facts.map(|facts| {
        index.reserve(facts.next_keyframe.0, facts.next_anchor.0);
        RebuiltMap { facts, index }
    }))
}
