//! Transactions that outlive a bad disk.
//!
//! After an error of the disk SQLite rolls back by itself. sqlx counts transactions and does not learn of it: its
//! ROLLBACK fails, and the connection counts one transaction too many for ever. The writer could then never begin
//! again, and a reader would go on within a savepoint, in front of a snapshot that never moves. So transactions are
//! begun and ended here, in plain SQL; a connection nobody can vouch for is closed.

use std::ops::{Deref, DerefMut};

use crate::StoreError;
use crate::sql::{self, Connection, Engine, Pool};

/// A transaction on a connection of a pool. Dropped before its end, it takes the connection with it.
pub(crate) struct Transaction {
    connection: Option<Connection>,
}

impl Transaction {
    /// Begins to write; waits for no lock in the middle.
    pub(crate) async fn write(pool: &Pool) -> Result<Self, StoreError> {
        let begin = match pool.engine() {
            Engine::Sqlite => "begin immediate",
            // Each statement sees what is committed by then: the first of them locks what the others rely on. A server that falls
            // silent within a write keeps that lock for a few seconds only, and nobody waits for it for longer.
            Engine::Postgres => {
                "begin isolation level read committed; set local idle_in_transaction_session_timeout = 5000; \
                 set local lock_timeout = 5000"
            }
        };
        Self::begin(pool, begin).await
    }

    /// Begins to read one version of the database.
    pub(crate) async fn read(pool: &Pool) -> Result<Self, StoreError> {
        let begin = match pool.engine() {
            Engine::Sqlite => "begin",
            Engine::Postgres => "begin isolation level repeatable read read only",
        };
        Self::begin(pool, begin).await
    }

    async fn begin(pool: &Pool, begin: &'static str) -> Result<Self, StoreError> {
        let mut this = Self { connection: Some(pool.acquire().await?) };
        this.run_at_once(begin).await?;
        Ok(this)
    }

    /// Commits; after an error nothing of it counts.
    pub(crate) async fn commit(mut self) -> Result<(), StoreError> {
        match sql::query("commit").execute(&mut *self).await {
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
    pub(crate) async fn roll_back(mut self) {
        if self.engine() == Engine::Postgres {
            // The server does so when its connection ends. A new one is wanted in any case: this one may be silent, or lead to a
            // server that only reads by now.
            return;
        }
        let nothing_to_do = |error: &sqlx::Error| {
            error
                .as_database_error()
                .is_some_and(|error| error.message().contains("no transaction is active"))
        };
        match sql::query("rollback").execute(&mut *self).await {
            Ok(_) => self.connection = None,
            Err(error) if nothing_to_do(&error) => self.connection = None,
            Err(error) => tracing::warn!(%error, "a connection could not roll back; it is closed"),
        }
    }
}

impl Deref for Transaction {
    type Target = Connection;

    fn deref(&self) -> &Connection {
        self.connection.as_ref().unwrap_or_else(|| unreachable!("only its end takes the connection"))
    }
}

impl DerefMut for Transaction {
    fn deref_mut(&mut self) -> &mut Connection {
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

#[cfg(test)]
mod tests {
    use sqlx::sqlite::{SqliteConnectOptions, SqlitePoolOptions};

    use super::*;

    async fn one_connection(folder: &tempfile::TempDir) -> Pool {
        let options =
            SqliteConnectOptions::new().filename(folder.path().join("test.db")).create_if_missing(true);
        let options = options.journal_mode(sqlx::sqlite::SqliteJournalMode::Wal);
        SqlitePoolOptions::new().max_connections(1).connect_with(options).await.expect("a pool").into()
    }

    async fn count(pool: &Pool) -> i64 {
        let mut reading = Transaction::read(pool).await.expect("a transaction");
        let count = sql::query_scalar("select count(*) from t").fetch_one(&mut *reading).await;
        reading.commit().await.expect("its end");
        count.expect("a count")
    }

    async fn add(pool: &Pool) {
        let mut writing = Transaction::write(pool).await.expect("a transaction");
        sql::query("insert into t values (1)").execute(&mut *writing).await.expect("a row");
        writing.commit().await.expect("its end");
    }

    #[tokio::test]
    async fn a_connection_that_sqlite_rolled_back_by_itself_goes_on() {
        let folder = tempfile::tempdir().expect("a folder");
        let pool = one_connection(&folder).await;
        sql::query("create table t (a)").execute(&pool).await.expect("a table");
        for round in 0..3 {
            let mut failed = Transaction::write(&pool).await.expect("a transaction");
            sql::query("insert into t values (0)").execute(&mut *failed).await.expect("a row");
            // What SQLite does after an error of the disk.
            sql::query("rollback").execute(&mut *failed).await.expect("a rollback");
            assert!(failed.commit().await.is_err());
            add(&pool).await;
            assert_eq!(count(&pool).await, round + 1, "nothing of the failed one, and no old snapshot");
        }
    }

    #[tokio::test]
    async fn a_transaction_nobody_ended_leaves_nothing() {
        let folder = tempfile::tempdir().expect("a folder");
        let pool = one_connection(&folder).await;
        sql::query("create table t (a)").execute(&pool).await.expect("a table");
        let mut dropped = Transaction::write(&pool).await.expect("a transaction");
        sql::query("insert into t values (0)").execute(&mut *dropped).await.expect("a row");
        drop(dropped);
        add(&pool).await;
        assert_eq!(count(&pool).await, 1);
    }
}
