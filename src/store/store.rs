//! The handle to the database.

use std::sync::Arc;

use sqlx::sqlite::SqlitePool;

use super::StoreError;
use super::commit::commit_queue::Committer;
use super::commit::transaction::Transaction;
use super::files::lock::DatabaseLock;
use super::files::paths::DatabaseFiles;

/// The database: one writer with group commit, and a pool of readers beside it.
#[derive(Clone, Debug)]
pub struct Store {
    pub(super) readers: SqlitePool,
    pub(super) committer: Committer,
    pub(super) files: DatabaseFiles,
    /// None where another process is the one that serves.
    pub(super) lock: Option<Arc<DatabaseLock>>,
}

impl Store {
    /// Its files.
    pub fn files(&self) -> &DatabaseFiles {
        &self.files
    }

    /// Returns the one writer.
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
    pub(super) async fn snapshot(&self) -> Result<Transaction, StoreError> {
        Transaction::read(&self.readers).await
    }

    /// Whether it has been closed.
    pub fn is_closed(&self) -> bool {
        self.readers.is_closed()
    }

    /// Returns the version of SQLite.
    pub async fn sqlite_version(&self) -> Result<String, StoreError> {
        Ok(sqlx::query_scalar("select sqlite_version()").fetch_one(&self.readers).await?)
    }
}
