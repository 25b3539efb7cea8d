//! Facts of a map: its row, its changes, and the order in which they are read.

use revisit_core::domain::change::Change;
use revisit_core::domain::ids::{AnchorSeq, KeyframeSeq, MapId};
use revisit_core::domain::key::KeySeq;
use revisit_core::domain::map::{Learned, MapFigures};
use revisit_core::domain::request::Digest;

use super::error::StoreError;
use crate::map_key::MapKey;

/// A map's row. Its changes are read beside it, part by part: together they take as much memory as the index that is built
/// from them.
#[derive(Clone, Debug)]
pub struct MapFacts {
    /// Its key.
    pub key: MapKey,
    /// Its version.
    pub version: u64,
    /// The dense numbers given next: those below were given, also to facts that are deleted.
    pub next_keyframe: KeyframeSeq,
    /// The dense numbers given next.
    pub next_anchor: AnchorSeq,
    /// The number of its next event.
    pub next_event: u64,
    /// The number of the next loop query to be kept.
    pub next_kept: i64,
    /// The digest of the body that made it.
    pub digest: Digest,
    /// The key that made it.
    pub owner: Option<KeySeq>,
    /// The size of what it holds, as its row says.
    pub figures: MapFigures,
    /// Its knowledge of its building, as its row says; `None` if nothing was written to it since rows say so.
    pub learned: Learned,
}

/// The order in which facts are read. It must not matter: `revisit check` compares the two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// As they came.
    Forwards,
    /// The last first, and what moves things after the things.
    Backwards,
}

/// A source of facts: the store, or a database that is inspected.
pub trait FactSource {
    /// Reads a map's changes in an order, part by part, and returns its row; `None` if there is no such map.
    fn load(
        &mut self,
        id: &MapId,
        order: Order,
        take: impl FnMut(Vec<Change>) + Send,
    ) -> impl Future<Output = Result<Option<MapFacts>, StoreError>> + Send;
}
