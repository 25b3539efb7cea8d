//! Connections and pools of either engine.

use std::future::Future;
use std::io;
use std::time::Duration;

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

/// The longest wait for an answer of a server. A machine that lost its power, or an address that moved to another one, ends no
/// connection: whoever waits for it waits for ever, and with the one writer every map of this server.
const ANSWER_TIMEOUT: Duration = Duration::from_secs(30);

/// The manner in which statements reach a PostgreSQL server.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Statements {
    /// Each connection prepares a statement once, under a name.
    Named,
    /// Each is prepared anew, without a name, and always within a transaction. A pooler that gives each transaction to any
    /// session, and does not know of prepared statements, keeps no more than that together.
    Unnamed,
}

/// Connections that are kept open.
#[derive(Clone, Debug)]
pub(crate) enum Pool {
    Sqlite(SqlitePool),
    Postgres(PgPool, Statements),
}

/// A connection.
#[derive(Debug)]
pub(crate) enum Connection {
    Sqlite(SqliteConnection),
    PooledSqlite(PoolConnection<Sqlite>),
    Postgres(PoolConnection<Postgres>, Statements),
}

/// The connection that a statement goes to, or any of a pool.
pub(crate) enum Target<'c> {
    Sqlite(&'c mut SqliteConnection),
    Postgres(&'c mut PgConnection, Statements),
    SqlitePool(&'c SqlitePool),
    PostgresPool(&'c PgPool, Statements),
}

/// A connection of a pool for one statement. Dropped before its end, it is closed.
pub(super) struct Alone {
    connection: Option<PoolConnection<Postgres>>,
    how: Statements,
}

impl Pool {
    pub(crate) async fn acquire(&self) -> Result<Connection, Error> {
        Ok(match self {
            Self::Sqlite(pool) => Connection::PooledSqlite(pool.acquire().await?),
            Self::Postgres(pool, statements) => Connection::Postgres(pool.acquire().await?, *statements),
        })
    }

    pub(crate) async fn close(&self) {
        match self {
            Self::Sqlite(pool) => pool.close().await,
            Self::Postgres(pool, _) => pool.close().await,
        }
    }

    pub(crate) fn is_closed(&self) -> bool {
        match self {
            Self::Sqlite(pool) => pool.is_closed(),
            Self::Postgres(pool, _) => pool.is_closed(),
        }
    }

    pub(crate) fn engine(&self) -> Engine {
        match self {
            Self::Sqlite(_) => Engine::Sqlite,
            Self::Postgres(..) => Engine::Postgres,
        }
    }
}

impl Connection {
    pub(crate) fn engine(&self) -> Engine {
        match self {
            Self::Sqlite(_) | Self::PooledSqlite(_) => Engine::Sqlite,
            Self::Postgres(..) => Engine::Postgres,
        }
    }

    /// Executes statements without values, all of them in one round trip.
    pub(crate) async fn run_at_once(&mut self, statements: &'static str) -> Result<(), Error> {
        match self {
            Self::Sqlite(db) => sqlx::raw_sql(statements).execute(db).await.map(drop),
            Self::PooledSqlite(db) => sqlx::raw_sql(statements).execute(&mut **db).await.map(drop),
            Self::Postgres(db, _) => limited(sqlx::raw_sql(statements).execute(&mut **db)).await.map(drop),
        }
    }

    /// Closes it.
    pub(crate) async fn close(self) -> Result<(), Error> {
        match self {
            Self::Sqlite(db) => db.close().await,
            Self::PooledSqlite(db) => db.close().await,
            Self::Postgres(db, _) => db.close().await,
        }
    }

    /// Has it closed where it would go back to its pool.
    pub(crate) fn close_on_drop(&mut self) {
        match self {
            Self::Sqlite(_) => {}
            Self::PooledSqlite(db) => db.close_on_drop(),
            Self::Postgres(db, _) => db.close_on_drop(),
        }
    }
}

impl Alone {
    pub(super) async fn begin(pool: &PgPool, how: Statements) -> Result<Self, Error> {
        let mut this = Self { connection: Some(pool.acquire().await?), how };
        if how == Statements::Unnamed {
            limited(sqlx::raw_sql("begin").execute(this.connection())).await?;
        }
        Ok(this)
    }

    pub(super) fn connection(&mut self) -> &mut PgConnection {
        self.connection.as_mut().unwrap_or_else(|| unreachable!("only its end takes the connection"))
    }

    /// Returns the statement's answer once it counts.
    pub(super) async fn end<T>(mut self, answer: Result<T, Error>) -> Result<T, Error> {
        let is_usable = match (&answer, self.how) {
            (Ok(_), Statements::Unnamed) => {
                limited(sqlx::raw_sql("commit").execute(self.connection())).await?;
                true
            }
            (Ok(_) | Err(Error::Database(_)), Statements::Named) => true,
            (Err(_), _) => false,
        };
        if is_usable {
            self.connection = None;
        }
        answer
    }
}

/// Waits for an answer, but not for ever. Its connection is to be closed if none comes.
pub(crate) async fn limited<T>(answer: impl Future<Output = Result<T, Error>>) -> Result<T, Error> {
    let timed_out = |_| Err(Error::Io(io::Error::new(io::ErrorKind::TimedOut, "no answer")));
    tokio::time::timeout(ANSWER_TIMEOUT, answer).await.unwrap_or_else(timed_out)
}

impl Drop for Alone {
    fn drop(&mut self) {
        if let Some(connection) = &mut self.connection {
            connection.close_on_drop();
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
            Connection::Postgres(db, statements) => Self::Postgres(db, *statements),
        }
    }
}

impl<'c> From<&'c Pool> for Target<'c> {
    fn from(pool: &'c Pool) -> Self {
        match pool {
            Pool::Sqlite(pool) => Self::SqlitePool(pool),
            Pool::Postgres(pool, statements) => Self::PostgresPool(pool, *statements),
        }
    }
}
