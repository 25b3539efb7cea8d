//! The disk of a database that lies in a file: its log, and the space that is kept for deletes.

use sqlx::sqlite::SqlitePool;
use tracing::warn;

use crate::files::disk_reserve::Reserve;

/// The disk that the writer takes care of. A database server has its own.
#[derive(Clone, Debug)]
pub(crate) struct OwnDisk {
    /// The one connection that writes.
    writer: SqlitePool,
    reserve: Reserve,
}

impl OwnDisk {
    pub(crate) fn of(writer: SqlitePool, reserve: Reserve) -> Self {
        Self { writer, reserve }
    }

    /// The one connection that writes.
    pub(crate) fn writer(&self) -> &SqlitePool {
        &self.writer
    }

    /// Keeps space for deletes. False if the disk has not got it, or nothing beside it.
    pub(crate) async fn keep_reserve(&self) -> bool {
        self.keep(self.reserve.bytes()).await
    }

    /// Gives back to the disk what deletes left in the log, and keeps space again. False if there is no room yet.
    pub(crate) async fn make_room(&self) -> bool {
        self.empty_log().await;
        // A database that has as much free within needs no more for itself: only its log must fit beside it.
        let enough = self.reserve.bytes().saturating_sub(self.free_within().await);
        self.keep(enough).await
    }

    /// Gives the space to deletes.
    pub(crate) async fn release_reserve(&self) {
        let reserve = self.reserve.clone();
        let _ = tokio::task::spawn_blocking(move || reserve.release()).await;
        self.empty_log().await;
    }

    /// Brings the log into the database, unless somebody still reads (a backup): then the next start does.
    pub(crate) async fn checkpoint(&self) {
        let Ok(mut db) = self.writer.acquire().await else { return };
        let settled = async {
            sqlx::query("pragma busy_timeout = 0").execute(&mut *db).await?;
            sqlx::query("pragma wal_checkpoint(truncate)").execute(&mut *db).await
        };
        if let Err(error) = settled.await {
            warn!(%error, "the write-ahead log stays beside the database until the next start");
        }
    }

    /// Returns what deletes have freed within the database's file, in bytes.
    async fn free_within(&self) -> u64 {
        let select = "select freelist_count * page_size from pragma_freelist_count, pragma_page_size";
        let free: Result<i64, _> = sqlx::query_scalar(select).fetch_one(&self.writer).await;
        free.map_or(0, i64::unsigned_abs)
    }

    async fn keep(&self, enough: u64) -> bool {
        let reserve = self.reserve.clone();
        tokio::task::spawn_blocking(move || reserve.keep(enough)).await.unwrap_or(true)
    }

    /// Brings the write-ahead log into the database's file, and frees its space.
    async fn empty_log(&self) {
        if let Err(error) = sqlx::query("pragma wal_checkpoint(truncate)").execute(&self.writer).await {
            tracing::debug!(%error, "the write-ahead log stays as it is");
        }
    }
}
