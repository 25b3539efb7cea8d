//! The schema's versions. A migration that was ever released is never edited, not even its comments:
//! its checksum is kept in every database. Until the first release, what changes is changed in place.

use std::cmp::Ordering;

use sqlx::migrate::Migrator;
use sqlx::sqlite::SqlitePool;

use crate::StoreError;
use crate::migrations::{Step, migrator, version_by};
use crate::sql::{self, Connection};

const MIGRATIONS: &[Step] = &[(1, "facts", include_str!("../../migrations/sqlite/0001_facts.sql"))];

/// Returns the newest schema that this program knows.
pub fn newest() -> i64 {
    MIGRATIONS.last().map_or(0, |(version, ..)| *version)
}

/// Returns the schema's version in a database; 0 in an empty one. Rejects one that was not made by this program's migrations.
pub(crate) async fn version(db: &mut Connection) -> Result<i64, StoreError> {
    let select = "select count(*) from sqlite_schema where name = '_sqlx_migrations'";
    let is_ours: i64 = sql::query_scalar(select).fetch_one(&mut *db).await?;
    if is_ours == 0 {
        let tables: i64 = sql::query_scalar("select count(*) from sqlite_schema").fetch_one(&mut *db).await?;
        return if tables == 0 { Ok(0) } else { Err(StoreError::UnknownForm) };
    }
    let select = "select version, checksum from _sqlx_migrations where success order by version";
    let applied: Vec<(i64, Vec<u8>)> = sql::query_as(select).fetch_all(db).await?;
    version_by(&applied, &migrator(MIGRATIONS.iter().copied()))
}

/// Brings the database to this version's schema; each step is one transaction.
pub(crate) async fn migrate(pool: &SqlitePool) -> Result<(), StoreError> {
    let (found, known) = (version(&mut Connection::PooledSqlite(pool.acquire().await?)).await?, newest());
    if found > known {
        return Err(StoreError::Newer { found, known });
    }
    run(&migrator(MIGRATIONS.iter().copied()), pool).await
}

async fn run(migrator: &Migrator, pool: &SqlitePool) -> Result<(), StoreError> {
    migrator.run(pool).await.map_err(|error| StoreError::Database(format!("migration: {error}")))
}

/// Whether it is this version's schema already.
pub(crate) async fn expect_newest(pool: &SqlitePool) -> Result<(), StoreError> {
    let (found, known) = (version(&mut Connection::PooledSqlite(pool.acquire().await?)).await?, newest());
    match found.cmp(&known) {
        Ordering::Equal => Ok(()),
        Ordering::Greater => Err(StoreError::Newer { found, known }),
        Ordering::Less => Err(StoreError::InUse(format!(
            "the database has schema {found}, and this program's is {known}: use the version of the server that has it open, or, \
             if none has, open it once with `revisit serve` of this one"
        ))),
    }
}

#[cfg(test)]
mod tests {
    use sqlx::sqlite::{SqliteConnectOptions, SqlitePoolOptions};

    use super::*;

    #[tokio::test]
    async fn a_migration_that_fails_halfway_leaves_nothing_of_itself() {
        let folder = tempfile::tempdir().unwrap();
        let options =
            SqliteConnectOptions::new().filename(folder.path().join("a.db")).create_if_missing(true);
        let pool = SqlitePoolOptions::new().max_connections(1).connect_with(options).await.unwrap();
        migrate(&pool).await.unwrap();
        let broken = "create table half (a integer) strict; insert into no_such_table values (1)";
        let steps = MIGRATIONS.iter().copied().chain([(newest() + 1, "broken", broken)]);
        let failed = run(&migrator(steps), &pool).await.unwrap_err();
        assert!(failed.to_string().contains("no_such_table"), "{failed}");
        let mut db = Connection::PooledSqlite(pool.acquire().await.unwrap());
        assert_eq!(version(&mut db).await.unwrap(), newest());
        let half = "select count(*) from sqlite_schema where name = 'half'";
        assert_eq!(sql::query_scalar::<i64>(half).fetch_one(&mut db).await.unwrap(), 0);
        drop(db);
        // And the right one can still be applied.
        let right = "create table whole (a integer) strict";
        let steps = MIGRATIONS.iter().copied().chain([(newest() + 1, "right", right)]);
        run(&migrator(steps), &pool).await.unwrap();
        let mut db = Connection::PooledSqlite(pool.acquire().await.unwrap());
        assert_eq!(version(&mut db).await.unwrap(), newest() + 1);
    }
}
