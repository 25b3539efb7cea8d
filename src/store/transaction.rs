//! Transactions that outlive a bad disk.
//!
//! After an error of the disk SQLite rolls back by itself. sqlx counts transactions and does not learn of it: its
//! ROLLBACK fails, and the connection counts one transaction too many for ever. The writer could then never begin
//! again, and a reader would go on within a savepoint, in front of a snapshot that never moves. So transactions are
//! begun and ended here, in plain SQL; a connection nobody can vouch for is closed.

use std::ops::{Deref, DerefMut};

use sqlx::pool::PoolConnection;
use sqlx::sqlite::SqlitePool;
use sqlx::{Sqlite, SqliteConnection};

use super::StoreError;

/// A transaction on a connection of a pool. Dropped before its end, it takes the connection with it.
pub(super) struct Transaction {
    connection: Option<PoolConnection<Sqlite>>,
}

impl Transaction {
    /// Begins to write; waits for no lock in the middle.
    pub(super) async fn write(pool: &SqlitePool) -> Result<Self, StoreError> {
        Self::begin(pool, "begin immediate").await
    }

    /// Begins to read one version of the database.
    pub(super) async fn read(pool: &SqlitePool) -> Result<Self, StoreError> {
        Self::begin(pool, "begin").await
    }

    async fn begin(pool: &SqlitePool, begin: &'static str) -> Result<Self, StoreError> {
        let mut this = Self { connection: Some(pool.acquire().await?) };
        sqlx::query(begin).execute(&mut *this).await?;
        Ok(this)
    }

    /// Commits; after an error nothing of it counts.
    pub(super) async fn commit(mut self) -> Result<(), StoreError> {
        match sqlx::query("commit").execute(&mut *self).await {
            Ok(_) => {
                self.connection = None;
                Ok(())
            }
            Err(error) => {
                self.roll_back().await;
                Err(error.into())
            }
        }
    }

    /// Takes back what was done, or notices that SQLite has done so.
    pub(super) async fn roll_back(mut self) {
        let nothing_to_do = |error: &sqlx::Error| {
            error
                .as_database_error()
                .is_some_and(|error| error.message().contains("no transaction is active"))
        };
        match sqlx::query("rollback").execute(&mut *self).await {
            Ok(_) => self.connection = None,
            Err(error) if nothing_to_do(&error) => self.connection = None,
            Err(error) => tracing::warn!(%error, "a connection could not roll back; it is closed"),
        }
    }
}

impl Deref for Transaction {
    type Target = SqliteConnection;

    fn deref(&self) -> &SqliteConnection {
        self.connection.as_ref().unwrap_or_else(|| unreachable!("only its end takes the connection"))
    }
}

impl DerefMut for Transaction {
    fn deref_mut(&mut self) -> &mut SqliteConnection {
        self.connection.as_mut().unwrap_or_else(|| unreachable!("only its end takes the connection"))
    }
}

impl Drop for Transaction {
    fn drop(&mut self) {
        if let Some(connection) = &mut self.connection {
            connection.close_on_drop();
        }
    }
}
