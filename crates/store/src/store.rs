//! The handle to the database.

use std::sync::Arc;

use super::StoreError;
use super::files::lock::DatabaseLock;
use super::files::paths::DatabaseFiles;
use super::postgres::leases::Leases;
use super::sql::{self, Engine, Pool};
use crate::commit::commit_queue::Committer;
use crate::sql::transaction::Transaction;

/// The database: one writer with group commit, and a pool of readers beside it.
#[derive(Clone, Debug)]
pub struct Store {
    pub(super) readers: Pool,
    pub(super) committer: Committer,
    /// None of a database server, which keeps its own.
    pub(super) files: Option<DatabaseFiles>,
    /// None where another process is the one that serves, or others may serve beside it.
    pub(super) lock: Option<Arc<DatabaseLock>>,
    /// None where this server alone has the database.
    pub(super) leases: Option<Arc<Leases>>,
}

impl Store {
    /// Its files; none where a database server has them.
    pub fn files(&self) -> Option<&DatabaseFiles> {
        self.files.as_ref()
    }

    /// Which engine keeps it.
    pub fn engine(&self) -> Engine {
        self.readers.engine()
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

    /// Returns the version of PostgreSQL, where that keeps it.
    pub async fn postgres_version(&self) -> Result<Option<String>, StoreError> {
        if self.engine() == Engine::Sqlite {
            return Ok(None);
        }
        let select = "select current_setting('server_version')";
        Ok(Some(sql::query_scalar(select).fetch_one(&self.readers).await?))
    }
}
