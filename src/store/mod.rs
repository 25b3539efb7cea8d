//! The store: every fact in plain SQL tables, on disk before it is acknowledged.
//!
//! | concept | file |
//! |---|---|
//! | opening, pragmas, migrations | this file, [`schema`] |
//! | one writer in a thread of its own, group commit | [`committer`], [`lanes`], [`writer`] |
//! | large deletions and corrections, in slices | [`slices`], [`deletion`], [`deferred`], [`parts`], [`fold`] |
//! | what a map was sent, and read back in order | [`former_values`], [`operations`], [`export`] |
//! | what it is asked to do, and what that costs | [`job`], [`cost`] |
//! | from changes to rows, a group at a time | [`mod@write`], [`additions`], [`rows`], [`map_rows`], [`keyframe_rows`] |
//! | from rows to changes, when a map is first asked for | [`facts`], [`load`], [`decode`], [`validate`] |
//! | what models said, and what it cost | [`model_rows`] |
//! | jobs that ask models again, and the verdicts they replaced | [`judgement_rows`], [`replaced_rows`] |
//! | API keys | [`key_rows`] |
//! | reads of one row | [`read`] |
//! | a disk that is full or fails | [`health`], [`reserve`], [`transaction`], [`renewal`] |
//! | packed lists in blobs | [`blob`] |
//! | where it lies, and who may write to it | [`files`], [`lock`] |
//! | copies of it, and what it holds | [`copying`], [`holdings`] |
//! | looking at it as it is | [`inspection`], [`log`] |

mod commit;
pub mod copying;
mod error;
mod export;
mod facts;
pub mod files;
mod holdings;
mod inspection;
mod rows;
mod slices;
#[cfg(test)]
mod slices_equal_direct_writes;

use std::str::FromStr;
use std::sync::Arc;
use std::time::Duration;

use sqlx::sqlite::{
    SqliteConnectOptions, SqliteJournalMode, SqlitePool, SqlitePoolOptions, SqliteSynchronous,
};

pub use commit::commit_queue::{CommitStats, Committer, PoisonFlag};
pub use commit::job::{Batch, Job, MapKey, NewKeyframeRows};
use commit::transaction::Transaction;
pub use error::StoreError;
pub use export::Export;
pub use facts::{MapFacts, Order};
use files::disk_reserve::Reserve;
pub use files::lock::{DatabaseLock, Purpose};
pub use files::log::LogFindings;
use files::paths::DatabaseFiles;
pub use files::schema::newest as newest_schema;
pub use holdings::Holdings;
pub use inspection::{Inspected, Inspection, RowFindings};
pub use rows::blob::unpacks;
pub use rows::judgement_rows::Fingerprints;
pub use rows::key_rows::{KeyTable, NewKeyRow, standing_keys};
pub use rows::map_rows::MapRow;
pub use rows::model_rows::{Spent, UsageRow};
pub use rows::read::{DetectionRow, KeyframeRow};

/// SQLite before this release can lose committed writes in WAL mode (the WAL-reset bug).
const OLDEST_SAFE_SQLITE: &str = "3.51.3";

/// How long a connection waits for a lock another process holds.
const BUSY_TIMEOUT: Duration = Duration::from_secs(10);

/// The WAL is cut back to this size after a checkpoint.
const WAL_LIMIT_BYTES: &str = "67108864";

/// Bytes of a page, in new databases.
const PAGE_BYTES: u32 = 16384;

/// What a reader may cache: 512 KiB. Every commit empties it, and the system caches the file anyway.
const READER_CACHE: &str = "-512";

/// Readers beside the one writer.
const READERS: u32 = 8;

/// The database: one writer with group commit, and a pool of readers beside it.
#[derive(Clone, Debug)]
pub struct Store {
    readers: SqlitePool,
    committer: Committer,
    files: DatabaseFiles,
    /// None where another process is the one that serves.
    lock: Option<Arc<DatabaseLock>>,
}

impl Store {
    /// Opens the database at `sqlite://PATH`, makes it if it is not there, and migrates it.
    /// Only one process may have it open so; another is refused.
    pub async fn open(url: &str) -> Result<Self, StoreError> {
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

    /// The same, or beside the process that has it open: for short writes to tables that maps do not need, such as keys.
    pub async fn open_beside(url: &str) -> Result<Self, StoreError> {
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
            for fault in files::log::look(&files)?.faults {
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
            files::wal_recovery::renew(&writer, files.database()).await?;
            files::schema::migrate(&writer).await?;
        } else {
            // Another process works with the log and the schema as they are.
            files::schema::expect_newest(&writer).await?;
        }
        let readers = SqlitePoolOptions::new()
            .max_connections(READERS)
            .idle_timeout(None)
            .max_lifetime(None)
            .connect_with(options.read_only(true).pragma("cache_size", READER_CACHE))
            .await?;
        let committer = Committer::start(writer, reserve, lock.clone())?;
        Ok(Self { readers, committer, files, lock })
    }

    /// Where it lies.
    pub fn files(&self) -> &DatabaseFiles {
        &self.files
    }

    /// The one writer.
    pub fn committer(&self) -> &Committer {
        &self.committer
    }

    /// Finishes what is queued, and closes the database.
    pub async fn close(&self) {
        // The writer last: the last connection brings the log into the database, which readers cannot.
        self.readers.close().await;
        self.committer.close().await;
        if let Some(lock) = &self.lock {
            lock.release();
        }
    }

    /// One version of the database to read.
    async fn snapshot(&self) -> Result<Transaction, StoreError> {
        Transaction::read(&self.readers).await
    }

    /// Has it been closed?
    pub fn is_closed(&self) -> bool {
        self.readers.is_closed()
    }

    /// The version of SQLite.
    pub async fn sqlite_version(&self) -> Result<String, StoreError> {
        Ok(sqlx::query_scalar("select sqlite_version()").fetch_one(&self.readers).await?)
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

    /// An empty database with this version's schema, and the folder that it lies in.
    pub(super) async fn database() -> (tempfile::TempDir, SqlitePool) {
        let folder = tempfile::tempdir().expect("a folder");
        let options = SqliteConnectOptions::new().filename(folder.path().join("test.db"));
        let options = options.create_if_missing(true).journal_mode(SqliteJournalMode::Wal);
        // A test that loses its machine has other worries.
        let options = options.synchronous(SqliteSynchronous::Off);
        let pool = SqlitePoolOptions::new().max_connections(1).connect_with(options).await.expect("a pool");
        files::schema::migrate(&pool).await.expect("a schema");
        (folder, pool)
    }

    #[test]
    fn versions_compare_by_their_numbers() {
        assert!(numbers("3.51.3") >= numbers(OLDEST_SAFE_SQLITE));
        assert!(numbers("3.51.10") > numbers("3.51.3"));
        assert!(numbers("3.46.1") < numbers(OLDEST_SAFE_SQLITE));
    }
}
