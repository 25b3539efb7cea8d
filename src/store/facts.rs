//! Facts of a map: what its row says, and in which order its changes are told.

use super::commit::job::MapKey;
use crate::domain::ids::{AnchorSeq, KeyframeSeq};
use crate::domain::key::KeySeq;
use crate::domain::map::{Learned, MapFigures};
use crate::domain::request::Digest;

/// What a map's row says. Its changes are told beside it, part by part: together they take as much memory as the index that
/// is built from them.
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
    /// How much it holds, as its row says.
    pub figures: MapFigures,
    /// Its knowledge of its building, as its row says; `None` if nothing was written to it since rows say so.
    pub learned: Option<Learned>,
}

/// In which order facts are told. It must not matter: `revisit check` compares the two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// As they came.
    Forwards,
    /// The last first, and what moves things after the things.
    Backwards,
}
