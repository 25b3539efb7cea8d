//! Transfer: everything that a database holds goes into another one, of either engine.
//!
//! Each map is copied as copies of maps are ([`super::map_copy`]): its rows are read in one transaction and written in short jobs, and
//! until the last one, which names it, it is no map. What is complete stays when a transfer is broken off, and the next one goes on.

use revisit_core::domain::ids::MapId;

use super::StoreError;
use super::copies::copied_rows::{Which, map_row, read_blocks};
use super::copies::transferred_rows::{self, HeldMap};
use super::store::Store;
use crate::jobs::job::{CopiedAs, Job};
use crate::map_key::MapKey;
use crate::sql;

impl Store {
    /// Returns the maps that are complete and not deleted, releases among them, by name.
    pub async fn held_maps(&self) -> Result<Vec<HeldMap>, StoreError> {
        let mut db = self.snapshot().await?;
        let held = transferred_rows::held_maps(&mut db).await;
        db.commit().await?;
        held
    }

    /// Returns how many servers serve the database now. One that is a file is served by nobody while it is open here.
    pub async fn server_count(&self) -> Result<u64, StoreError> {
        if self.leases.is_none() {
            return Ok(0);
        }
        let select = "select count(*) from nodes where expires > clock_timestamp()";
        Ok(sql::query_scalar(select).fetch_one(&self.readers).await?)
    }

    /// Throws away the maps whose transfer was not completed.
    pub async fn discard_incomplete(&self) -> Result<(), StoreError> {
        let mut db = self.snapshot().await?;
        let incomplete = transferred_rows::incomplete(&mut db).await;
        db.commit().await?;
        for map in incomplete? {
            self.committer.commit(Job::DiscardCopy(map)).await?;
        }
        Ok(())
    }

    /// Copies a map of another database into this one, with all that belongs to it.
    pub async fn take_map_from(&self, other: &Self, map: &HeldMap) -> Result<(), StoreError> {
        let mut db = other.snapshot().await?;
        let row = map_row(&mut db, map.key).await?;
        let id = format!("copying//{:032}-{}", 0, map.key);
        self.committer.commit(Job::BeginCopy { row: Box::new(row), id: id.clone() }).await?;
        let select = "select map_key from maps where id = $1";
        let copy: MapKey = sql::query_scalar(select).bind(&id).fetch_one(&self.readers).await?;
        let written = read_blocks(&mut db, map.key, Which::Every, |block| {
            self.committer.commit(Job::CopyRows { map: copy, block: Box::new(block) })
        });
        let written = written.await;
        db.commit().await?;
        let copied_as = Box::new(CopiedAs::Itself { id: map.id.clone() });
        let finished = match written {
            Ok(()) => self.committer.commit(Job::FinishCopy { map: copy, copied_as }).await,
            Err(error) => Err(error),
        };
        if finished.is_err() {
            self.committer.submit_alone(Job::DiscardCopy(copy));
        }
        finished
    }

    /// Copies keys, and what models answered and cost: before the maps, so that no part of a copy can be served without its keys.
    pub async fn take_beside_maps_from(&self, other: &Self) -> Result<(), StoreError> {
        let mut db = other.snapshot().await?;
        let read = transferred_rows::read_beside_maps(&mut db, |block| {
            self.committer.commit(Job::AddRows(Box::new(block)))
        });
        let read = read.await;
        db.commit().await?;
        read
    }

    /// Copies which maps are releases of which, and the number of the last event.
    pub async fn take_releases_from(&self, other: &Self) -> Result<(), StoreError> {
        let mut db = other.snapshot().await?;
        let releases = transferred_rows::read_releases(&mut db).await;
        let last_event = transferred_rows::last_event(&mut db).await;
        db.commit().await?;
        let keys = |id: String| async move {
            let id: Result<MapId, _> = revisit_core::domain::ids::StoredId::stored(&id);
            let id = id.map_err(|error| StoreError::corrupt(error.to_string()))?;
            self.map_key(&id).await?.ok_or_else(|| StoreError::corrupt(format!("map {id} was not copied")))
        };
        for (of, held, row) in releases? {
            let maps = (keys(of).await?, keys(held).await?);
            self.committer.commit(Job::AddRelease { maps, row: Box::new(row) }).await?;
        }
        self.committer.commit(Job::RaiseLastEvent(last_event?)).await
    }

    /// Returns a digest of all rows of a map, the same in whatever database they lie, and their number.
    pub async fn digest_of_map(&self, map: MapKey) -> Result<([u8; 32], u64), StoreError> {
        let mut db = self.snapshot().await?;
        let digest = transferred_rows::digest(&mut db, map).await;
        db.commit().await?;
        digest
    }

    /// Returns the API keys, each by its number, name and the hash of its secret.
    pub async fn held_keys(&self) -> Result<Vec<(i64, String, Vec<u8>)>, StoreError> {
        Ok(sql::query_as("select key, name, hash from keys order by key").fetch_all(&self.readers).await?)
    }
}
