//! Copies of maps: all rows of one version of a map under another key.
//!
//! The rows are read in one read transaction and written in short jobs between those of other maps. Until the last one, which
//! names it, the copy is no map (`maps.deleted` is 2); the next start deletes one that was not completed. Nobody waits for a
//! copy but who asked for it. Meanwhile the write-ahead log grows by what is written, as it does during an export.

use std::sync::atomic::{AtomicU64, Ordering};

use revisit_core::domain::ids::MapId;
use revisit_core::domain::map::MapProperties;

use super::copies::copied_rows::{Which, map_row, read_blocks};
use super::rows::map_rows;
use super::{Store, StoreError};
use crate::jobs::job::{CopiedAs, Job};
use crate::map_key::MapKey;
use crate::sql;
use crate::sql::transaction::Transaction;

/// Numbers the copies of this process.
static NEXT_COPY: AtomicU64 = AtomicU64::new(0);

/// A copy of a map that has all rows and no name yet. It is thrown away unless it is finished.
#[derive(Debug)]
#[must_use]
pub struct MapCopy {
    store: Store,
    key: MapKey,
    /// The version that was copied.
    pub version: u64,
    has_name: bool,
}

impl Store {
    /// Copies the rows of a map as they are on disk; `None` if there is no such map.
    pub async fn copy_map(&self, id: &MapId) -> Result<Option<MapCopy>, StoreError> {
        let mut db = self.snapshot().await?;
        let select = "select map_key, version from maps where id = $1 and deleted = 0";
        let found = sql::query_as(select).bind(id).fetch_optional(&mut *db).await?;
        let Some((map, version)) = found else {
            db.commit().await?;
            return Ok(None);
        };
        let result = self.copy_rows(&mut db, map).await;
        db.commit().await?;
        Ok(Some(MapCopy { store: self.clone(), key: result?, version, has_name: false }))
    }

    async fn copy_rows(&self, db: &mut Transaction, map: MapKey) -> Result<MapKey, StoreError> {
        // No client can give an id with a slash, and no release has two.
        let id = format!(
            "copying//{}-{map}-{}",
            self.leases.as_ref().map_or("", |of| of.node()),
            NEXT_COPY.fetch_add(1, Ordering::Relaxed)
        );
        let row = map_row(db, map).await?;
        self.committer.commit(Job::BeginCopy { row: Box::new(row), id: id.clone() }).await?;
        let select = "select map_key from maps where id = $1";
        let key: MapKey = sql::query_scalar(select).bind(&id).fetch_one(&self.readers).await?;
        let copied = read_blocks(db, map, Which::OfCopy, |block| {
            self.committer.commit(Job::CopyRows { map: key, block: Box::new(block) })
        });
        if let Err(error) = copied.await {
            self.committer.submit_alone(Job::DiscardCopy(key));
            return Err(error);
        }
        Ok(key)
    }
}

impl MapCopy {
    /// Gives it its name: from then on it is a map.
    pub async fn finish(mut self, copied_as: CopiedAs) -> Result<(), StoreError> {
        let job = Job::FinishCopy { map: self.key, copied_as: Box::new(copied_as) };
        // Who no longer waits for the disk may have it named all the same.
        self.has_name = true;
        let finished = self.store.committer.commit(job).await;
        self.has_name = finished.is_ok();
        finished
    }

    /// Returns the properties that were copied.
    pub async fn properties(&self) -> Result<MapProperties, StoreError> {
        let mut db = self.store.snapshot().await?;
        let select = "select * from maps where map_key = $1";
        let row = sql::query(select).bind(self.key).fetch_one(&mut *db).await?;
        let properties = map_rows::properties(&row);
        db.commit().await?;
        properties
    }
}

impl Drop for MapCopy {
    fn drop(&mut self) {
        if !self.has_name {
            self.store.committer.submit_alone(Job::DiscardCopy(self.key));
        }
    }
}
