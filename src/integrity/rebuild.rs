//! Rebuild: the index of a map from the facts on disk.

use crate::domain::ids::MapId;
use crate::recognition::map::index::MapIndex;
use crate::store::{Inspected, MapFacts, Order, StoreError};

/// Builds a map's index from its facts, told in an order; `None` if there is no such map.
pub(super) async fn rebuild(
    db: &mut Inspected,
    id: &MapId,
    order: Order,
) -> Result<Option<(MapFacts, MapIndex)>, StoreError> {
    let mut index = MapIndex::default();
    let facts = db.load(id, order, |changes| index.apply(changes)).await?;
    Ok(facts.map(|facts| {
        index.reserve(facts.next_keyframe.0, facts.next_anchor.0);
        (facts, index)
    }))
}
