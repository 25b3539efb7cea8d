//! Connections and pools of either engine.

use sqlx::pool::PoolConnection;
use sqlx::postgres::PgPool;
use sqlx::sqlite::SqlitePool;
use sqlx::{Connection as _, Error, PgConnection, Postgres, Sqlite, SqliteConnection};

/// Which engine keeps the facts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Engine {
    /// A file of this machine.
    Sqlite,
    /// A server that others share.
    Postgres,
}

/// Connections that are kept open.
#[derive(Clone, Debug)]
pub(in crate::store) enum Pool {
    Sqlite(SqlitePool),
    Postgres(PgPool),
}

/// A connection.
#[derive(Debug)]
pub(in crate::store) enum Connection {
    Sqlite(SqliteConnection),
    PooledSqlite(PoolConnection<Sqlite>),
    Postgres(PoolConnection<Postgres>),
}

/// The connection that a statement goes to, or any of a pool.
pub(in crate::store) enum Target<'c> {
    Sqlite(&'c mut SqliteConnection),
    Postgres(&'c mut PgConnection),
    SqlitePool(&'c SqlitePool),
    PostgresPool(&'c PgPool),
}

impl Pool {
    pub(in crate::store) async fn acquire(&self) -> Result<Connection, Error> {
        Ok(match self {
            Self::Sqlite(pool) => Connection::PooledSqlite(pool.acquire().await?),
            Self::Postgres(pool) => Connection::Postgres(pool.acquire().await?),
        })
    }

    pub(in crate::store) async fn close(&self) {
        match self {
            Self::Sqlite(pool) => pool.close().await,
            Self::Postgres(pool) => pool.close().await,
        }
    }

    pub(in crate::store) fn is_closed(&self) -> bool {
        match self {
            Self::Sqlite(pool) => pool.is_closed(),
            Self::Postgres(pool) => pool.is_closed(),
        }
    }

    pub(in crate::store) fn engine(&self) -> Engine {
        match self {
            Self::Sqlite(_) => Engine::Sqlite,
            Self::Postgres(_) => Engine::Postgres,
        }
    }
}

impl Connection {
    pub(in crate::store) fn engine(&self) -> Engine {
        match self {
            Self::Sqlite(_) | Self::PooledSqlite(_) => Engine::Sqlite,
            Self::Postgres(_) => Engine::Postgres,
        }
    }

    /// Executes statements without values, all of them in one round trip.
    pub(in crate::store) async fn run_at_once(&mut self, statements: &'static str) -> Result<(), Error> {
        match self {
            Self::Sqlite(db) => sqlx::raw_sql(statements).execute(db).await.map(drop),
            Self::PooledSqlite(db) => sqlx::raw_sql(statements).execute(&mut **db).await.map(drop),
            Self::Postgres(db) => sqlx::raw_sql(statements).execute(&mut **db).await.map(drop),
        }
    }

    /// Closes it.
    pub(in crate::store) async fn close(self) -> Result<(), Error> {
        match self {
            Self::Sqlite(db) => db.close().await,
            Self::PooledSqlite(db) => db.close().await,
            Self::Postgres(db) => db.close().await,
        }
    }

    /// Has it closed where it would go back to its pool.
    pub(in crate::store) fn close_on_drop(&mut self) {
        match self {
            Self::Sqlite(_) => {}
            Self::PooledSqlite(db) => db.close_on_drop(),
            Self::Postgres(db) => db.close_on_drop(),
        }
    }
}

impl From<SqlitePool> for Pool {
    fn from(pool: SqlitePool) -> Self {
        Self::Sqlite(pool)
    }
}

impl<'c> From<&'c mut Connection> for Target<'c> {
    fn from(connection: &'c mut Connection) -> Self {
        match connection {
            Connection::Sqlite(db) => Self::Sqlite(db),
            Connection::PooledSqlite(db) => Self::Sqlite(db),
            Connection::Postgres(db) => Self::Postgres(db),
        }
    }
}

impl<'c> From<&'c Pool> for Target<'c> {
    fn from(pool: &'c Pool) -> Self {
        match pool {
            Pool::Sqlite(pool) => Self::SqlitePool(pool),
            Pool::Postgres(pool) => Self::PostgresPool(pool),
        }
    }
}
