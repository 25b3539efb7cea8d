//! Opening: pragmas, migrations, the writer and its readers.

use std::str::FromStr;
use std::sync::Arc;

use sqlx::sqlite::{
    SqliteConnectOptions, SqliteJournalMode, SqlitePool, SqlitePoolOptions, SqliteSynchronous,
};

use super::address::is_server_url;
use super::files::disk_reserve::Reserve;
use super::files::lock::{DatabaseLock, Purpose};
use super::files::paths::{BUSY_TIMEOUT, DatabaseFiles};
use super::files::{log, schema, wal_recovery};
use super::{Store, StoreError};
use crate::commit::group_commit::{self, Served};
use crate::commit::own_disk::OwnDisk;

pub(crate) mod postgres;

/// SQLite before this release can lose committed writes in WAL mode (the WAL-reset bug).
const OLDEST_SAFE_SQLITE: &str = "3.51.3";

/// The WAL is cut back to this size after a checkpoint.
const WAL_LIMIT_BYTES: &str = "67108864";

/// Bytes of a page, in new databases.
const PAGE_BYTES: u32 = 16384;

/// Cache of a reader: 512 KiB. Every commit empties it, and the system caches the file anyway.
const READER_CACHE: &str = "-512";

/// Readers beside the one writer.
const READERS: u32 = 8;

impl Store {
    /// Opens the database at `sqlite://PATH`, makes it if it is not there, and migrates it.
    /// Only one process may have it open so; another is refused. That of `postgres://HOST/NAME` must be there, and others may
    /// have it open, too.
    pub async fn open(url: &str) -> Result<Self, StoreError> {
        if is_server_url(url) {
            return postgres::open(url).await;
        }
        let files = DatabaseFiles::of_url(url)?;
        let lock = DatabaseLock::take(&files, Purpose::Serve)?;
        Self::open_locked(url, files, lock).await
    }

    /// Opens it under a lock, which leaves nothing behind where that fails.
    async fn open_locked(url: &str, files: DatabaseFiles, lock: DatabaseLock) -> Result<Self, StoreError> {
        let lock = Arc::new(lock);
        let opened = Self::open_as(url, files.clone(), Some(lock.clone())).await;
        opened.map_err(|error| {
            lock.undo();
            error.of(files.database())
        })
    }

    /// Returns the same, or beside the process that has it open: for short writes to tables that maps do not need, such
    /// as keys.
    pub async fn open_beside(url: &str) -> Result<Self, StoreError> {
        if is_server_url(url) {
            return postgres::open(url).await;
        }
        let files = DatabaseFiles::of_url(url)?;
        match DatabaseLock::take(&files, Purpose::Serve) {
            Ok(lock) => Self::open_locked(url, files, lock).await,
            Err(StoreError::InUse(_)) => {
                let opened = Self::open_as(url, files.clone(), None).await;
                opened.map_err(|error| error.of(files.database()))
            }
            Err(error) => Err(error),
        }
    }

    async fn open_as(
        url: &str,
        files: DatabaseFiles,
        lock: Option<Arc<DatabaseLock>>,
    ) -> Result<Self, StoreError> {
        let reserve = Reserve::beside(files.database());
        // Before SQLite opens the database: it takes what the log has for all that was committed.
        if lock.is_some() {
            for fault in log::look(&files)?.faults {
                tracing::error!(database = %files.database().display(), fault, "the database has lost writes; restore a backup");
            }
        }
        files.make()?;
        let options = SqliteConnectOptions::from_str(url)?
            .create_if_missing(true)
            .journal_mode(SqliteJournalMode::Wal)
            // An acknowledged write is in the WAL *and* synced: NORMAL would sync only at checkpoints.
            .synchronous(SqliteSynchronous::Full)
            .foreign_keys(true)
            .busy_timeout(BUSY_TIMEOUT)
            .page_size(PAGE_BYTES)
            .pragma("wal_autocheckpoint", reserve.log_pages(PAGE_BYTES).to_string())
            .pragma("journal_size_limit", WAL_LIMIT_BYTES)
            .statement_cache_capacity(256);
        let writer = SqlitePoolOptions::new()
            .max_connections(1)
            .idle_timeout(None)
            .max_lifetime(None)
            .connect_with(options.clone())
            .await?;
        check_sqlite(&writer).await?;
        if lock.is_some() {
            wal_recovery::renew(&writer, files.database()).await?;
            schema::migrate(&writer).await?;
        } else {
            // Another process works with the log and the schema as they are.
            schema::expect_newest(&writer).await?;
        }
        let readers = SqlitePoolOptions::new()
            .max_connections(READERS)
            .idle_timeout(None)
            .max_lifetime(None)
            .connect_with(options.read_only(true).pragma("cache_size", READER_CACHE))
            .await?;
        let served = lock.clone().map_or(Served::Beside, |lock| Served::Alone { _lock: lock });
        let disk = OwnDisk::of(writer.clone(), reserve);
        let committer = group_commit::start(writer.into(), Some(disk), served)?;
        Ok(Self { readers: readers.into(), committer, files: Some(files), lock, leases: None })
    }
}

async fn check_sqlite(pool: &SqlitePool) -> Result<(), StoreError> {
    let found: String = sqlx::query_scalar("select sqlite_version()").fetch_one(pool).await?;
    if numbers(&found) < numbers(OLDEST_SAFE_SQLITE) {
        return Err(StoreError::SqliteTooOld { found, needed: OLDEST_SAFE_SQLITE });
    }
    Ok(())
}

fn numbers(version: &str) -> Vec<u32> {
    version.split('.').map_while(|part| part.parse().ok()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn versions_compare_by_their_numbers() {
        assert!(numbers("3.51.3") >= numbers(OLDEST_SAFE_SQLITE));
        assert!(numbers("3.51.10") > numbers("3.51.3"));
        assert!(numbers("3.46.1") < numbers(OLDEST_SAFE_SQLITE));
    }
}
