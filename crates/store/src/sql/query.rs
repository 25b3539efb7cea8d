//! Statements with their values.

use std::marker::PhantomData;

use futures_util::stream::{BoxStream, StreamExt as _, TryStreamExt as _};
use sqlx::postgres::{PgArguments, PgPool, PgRow, Postgres};
use sqlx::sqlite::{Sqlite, SqliteArguments};
use sqlx::{Either, Error, Executor as _, PgConnection, SqlSafeStr, SqlStr};

use super::connection::{Alone, Connection, Statements, Target, limited};
use super::row::{FromRow, FromValue, Row};
use super::value::{ToValue, Value, Values};
use crate::StoreError;

/// A statement with its values.
#[derive(Debug)]
pub(crate) struct Query {
    sql: SqlStr,
    values: Vec<Value>,
}

/// A statement whose rows are read into `T`.
pub(crate) struct QueryAs<T> {
    query: Query,
    read: fn(&Row) -> Result<T, Error>,
    rows: PhantomData<fn() -> T>,
}

/// The answer of a server to a statement.
#[derive(Default)]
struct Answer {
    /// The number of rows that it changed.
    changed: u64,
    rows: Vec<PgRow>,
}

/// Returns a statement.
pub(crate) fn query(sql: impl SqlSafeStr) -> Query {
    Query { sql: sql.into_sql_str(), values: Vec::new() }
}

/// Returns a statement with these values.
pub(crate) fn statement(sql: impl SqlSafeStr, values: impl Values) -> Query {
    Query { sql: sql.into_sql_str(), values: values.to_values() }
}

/// Returns a statement whose rows are tuples.
pub(crate) fn query_as<T: FromRow>(sql: impl SqlSafeStr) -> QueryAs<T> {
    QueryAs { query: query(sql), read: T::from_row, rows: PhantomData }
}

/// Returns a statement of whose rows the first column counts.
pub(crate) fn query_scalar<T: for<'r> FromValue<'r>>(sql: impl SqlSafeStr) -> QueryAs<T> {
    QueryAs { query: query(sql), read: |row| row.try_get(0), rows: PhantomData }
}

impl Query {
    /// Gives the next parameter its value.
    pub(crate) fn bind(mut self, value: impl ToValue) -> Self {
        self.values.push(value.to_value());
        self
    }

    /// Gives the next parameters their values.
    pub(crate) fn bind_all(mut self, values: Vec<Value>) -> Self {
        self.values.extend(values);
        self
    }

    /// Executes it, and returns the number of rows that it changed.
    pub(crate) async fn execute<'c>(self, to: impl Into<Target<'c>>) -> Result<u64, Error> {
        Ok(match to.into() {
            Target::Sqlite(db) => self.for_sqlite()?.execute(db).await?.rows_affected(),
            Target::SqlitePool(pool) => self.for_sqlite()?.execute(pool).await?.rows_affected(),
            Target::Postgres(db, how) => self.send(db, how).await?.changed,
            Target::PostgresPool(pool, how) => self.send_alone(pool, how).await?.changed,
        })
    }

    pub(crate) async fn fetch_all<'c>(self, from: impl Into<Target<'c>>) -> Result<Vec<Row>, Error> {
        let sqlite = |rows: Vec<_>| rows.into_iter().map(Row::Sqlite).collect();
        let postgres = |rows: Vec<_>| rows.into_iter().map(Row::Postgres).collect();
        Ok(match from.into() {
            Target::Sqlite(db) => sqlite(self.for_sqlite()?.fetch_all(db).await?),
            Target::SqlitePool(pool) => sqlite(self.for_sqlite()?.fetch_all(pool).await?),
            Target::Postgres(db, how) => postgres(self.send(db, how).await?.rows),
            Target::PostgresPool(pool, how) => postgres(self.send_alone(pool, how).await?.rows),
        })
    }

    pub(crate) async fn fetch_optional<'c>(self, from: impl Into<Target<'c>>) -> Result<Option<Row>, Error> {
        let first = |rows: Vec<PgRow>| rows.into_iter().next().map(Row::Postgres);
        Ok(match from.into() {
            Target::Sqlite(db) => self.for_sqlite()?.fetch_optional(db).await?.map(Row::Sqlite),
            Target::SqlitePool(pool) => self.for_sqlite()?.fetch_optional(pool).await?.map(Row::Sqlite),
            Target::Postgres(db, how) => first(self.send(db, how).await?.rows),
            Target::PostgresPool(pool, how) => first(self.send_alone(pool, how).await?.rows),
        })
    }

    pub(crate) async fn fetch_one<'c>(self, from: impl Into<Target<'c>>) -> Result<Row, Error> {
        self.fetch_optional(from).await?.ok_or(Error::RowNotFound)
    }

    /// Returns its rows one by one, as they arrive.
    pub(crate) fn fetch(self, from: &mut Connection) -> BoxStream<'_, Result<Row, Error>> {
        let failed = |error| futures_util::stream::once(async move { Err(error) }).boxed();
        match from.into() {
            Target::Sqlite(db) => match self.for_sqlite() {
                Ok(query) => query.fetch(db).map_ok(Row::Sqlite).boxed(),
                Err(error) => failed(error),
            },
            Target::Postgres(db, how) => match self.for_postgres(how) {
                Ok(query) => query.fetch(db).map_ok(Row::Postgres).boxed(),
                Err(error) => failed(error),
            },
            Target::SqlitePool(_) | Target::PostgresPool(..) => unreachable!("a connection is no pool"),
        }
    }

    fn for_sqlite(self) -> Result<sqlx::query::Query<'static, Sqlite, SqliteArguments>, Error> {
        let mut arguments = SqliteArguments::default();
        let mut values = self.values.into_iter();
        values.try_for_each(|value| value.add_to_sqlite(&mut arguments)).map_err(Error::Encode)?;
        Ok(sqlx::query_with(self.sql, arguments))
    }

    /// Sends it on a connection of a server.
    async fn send(self, db: &mut PgConnection, how: Statements) -> Result<Answer, Error> {
        let query = self.for_postgres(how)?;
        let (mut answer, mut parts) = (Answer::default(), db.fetch_many(query));
        while let Some(part) = limited(parts.try_next()).await? {
            match part {
                Either::Left(result) => answer.changed += result.rows_affected(),
                Either::Right(row) => answer.rows.push(row),
            }
        }
        drop(parts);
        Ok(answer)
    }

    /// Sends it on a connection of its own.
    async fn send_alone(self, pool: &PgPool, how: Statements) -> Result<Answer, Error> {
        let mut alone = Alone::begin(pool, how).await?;
        let answer = self.send(alone.connection(), how).await;
        alone.end(answer).await
    }

    fn for_postgres(
        self,
        how: Statements,
    ) -> Result<sqlx::query::Query<'static, Postgres, PgArguments>, Error> {
        let mut arguments = PgArguments::default();
        let mut values = self.values.into_iter();
        values.try_for_each(|value| value.add_to_postgres(&mut arguments)).map_err(Error::Encode)?;
        Ok(sqlx::query_with(self.sql, arguments).persistent(how == Statements::Named))
    }
}

impl<T> QueryAs<T> {
    /// Gives the next parameter its value.
    pub(crate) fn bind(mut self, value: impl ToValue) -> Self {
        self.query = self.query.bind(value);
        self
    }

    pub(crate) async fn fetch_all<'c>(self, from: impl Into<Target<'c>>) -> Result<Vec<T>, Error> {
        self.query.fetch_all(from).await?.iter().map(self.read).collect()
    }

    pub(crate) async fn fetch_optional<'c>(self, from: impl Into<Target<'c>>) -> Result<Option<T>, Error> {
        self.query.fetch_optional(from).await?.as_ref().map(self.read).transpose()
    }

    pub(crate) async fn fetch_one<'c>(self, from: impl Into<Target<'c>>) -> Result<T, Error> {
        (self.read)(&self.query.fetch_one(from).await?)
    }
}

/// Executes a statement that returns no rows.
pub(crate) async fn run(db: &mut Connection, query: Query) -> Result<(), StoreError> {
    query.execute(db).await?;
    Ok(())
}
