//! Transfer of a whole database into another one, of either engine, verified map by map.
//!
//! A map is verified by all of its rows, which must be the same, and by its index, which is built from either database and must be
//! the same as well. What was transferred before is verified anew, and not copied again.

use thiserror::Error;

use super::rebuild::rebuild;
use crate::domain::counted::counted;
use crate::domain::ids::MapId;
use crate::store::{HeldMap, Order, Store, StoreError};

/// A map that is in both databases.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Transferred {
    /// Its name; of a release, `map/release`.
    pub id: MapId,
    /// Its version.
    pub version: u64,
    /// Its rows.
    pub rows: u64,
    /// Its keyframes.
    pub keyframes: u64,
    /// Whether it was there already.
    pub was_there: bool,
}

/// Why a transfer ended.
#[derive(Clone, Debug, Error)]
pub enum TransferError {
    /// A database does not do what it is asked.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// Servers have a database open.
    #[error("the {which} is served by {}; stop them first", counted(*count, "server"))]
    Served {
        /// Their number.
        count: u64,
        /// `source` or `target`.
        which: &'static str,
    },
    /// The target holds something that is not the source's.
    #[error("the target holds {0}, which the source does not: begin with an empty target")]
    Foreign(String),
    /// A map is not the same in both.
    #[error("map {map}: its {what} differ between source and target{hint}")]
    Differs {
        /// The map.
        map: MapId,
        /// The part that differs.
        what: &'static str,
        /// Advice, or nothing.
        hint: &'static str,
    },
}

/// Transfers everything, and tells of each map when it is verified. Nobody may serve either database.
pub async fn transfer(
    from: &Store,
    to: &Store,
    mut tell: impl FnMut(&Transferred),
) -> Result<Vec<Transferred>, TransferError> {
    expect_not_served(from, "source").await?;
    expect_not_served(to, "target").await?;
    to.discard_incomplete().await?;
    let maps = from.held_maps().await?;
    let there: Vec<MapId> = to.held_maps().await?.into_iter().map(|held| held.id).collect();
    // One that the source has not would be another database's.
    if let Some(foreign) = there.iter().find(|id| !maps.iter().any(|map| map.id == **id)) {
        return Err(TransferError::Foreign(format!("map {foreign}")));
    }
    keys_agree(from, to).await?;
    to.take_beside_maps_from(from).await?;
    let mut transferred = Vec::new();
    for map in &maps {
        let was_there = there.contains(&map.id);
        if !was_there {
            to.take_map_from(from, map).await?;
        }
        let verified = verified((from, map), to, was_there).await?;
        tell(&verified);
        transferred.push(verified);
    }
    to.take_releases_from(from).await?;
    Ok(transferred)
}

/// Fails if servers have a database open, which is the `source` or the `target`.
pub async fn expect_not_served(store: &Store, which: &'static str) -> Result<(), TransferError> {
    match store.server_count().await? {
        0 => Ok(()),
        count => Err(TransferError::Served { count, which }),
    }
}

/// Fails if the target has a key that the source has not.
async fn keys_agree(from: &Store, to: &Store) -> Result<(), TransferError> {
    let keys = from.held_keys().await?;
    match to.held_keys().await?.into_iter().find(|key| !keys.contains(key)) {
        Some((_, name, _)) => Err(TransferError::Foreign(format!("the API key {name}"))),
        None => Ok(()),
    }
}

async fn verified(
    (from, map): (&Store, &HeldMap),
    to: &Store,
    was_there: bool,
) -> Result<Transferred, TransferError> {
    let differs = |what| TransferError::Differs {
        map: map.id.clone(),
        what,
        hint: if was_there { "; it was there before: begin with an empty target" } else { "" },
    };
    let key = to.map_key(&map.id).await?.ok_or_else(|| differs("rows"))?;
    let (digest, rows) = from.digest_of_map(map.key).await?;
    if to.digest_of_map(key).await? != (digest, rows) {
        return Err(differs("rows"));
    }
    let at_first = rebuild(from, &map.id, Order::Forwards).await?.ok_or_else(|| differs("facts"))?;
    let copied = rebuild(to, &map.id, Order::Backwards).await?.ok_or_else(|| differs("facts"))?;
    if at_first.index != copied.index || at_first.facts.version != copied.facts.version {
        return Err(differs("facts"));
    }
    let keyframes = at_first.index.keyframe_count() as u64;
    Ok(Transferred { id: map.id.clone(), version: map.version, rows, keyframes, was_there })
}
