//! The schema's versions. A migration that was ever released is never edited, not even its comments:
//! its checksum is kept in every database.

use std::borrow::Cow;
use std::cmp::Ordering;

use sqlx::SqlSafeStr;
use sqlx::migrate::{MigrateError, Migration, MigrationType, Migrator};
use sqlx::sqlite::SqlitePool;

use crate::store::StoreError;
use crate::store::rows::point_blocks;
use crate::store::sql::{self, Connection, Pool};

/// A version, its name, and its statements.
type Step = (i64, &'static str, &'static str);

const MIGRATIONS: &[Step] = &[
    (1, "facts", include_str!("../../../migrations/sqlite/0001_facts.sql")),
    (2, "models", include_str!("../../../migrations/sqlite/0002_models.sql")),
    (3, "trust", include_str!("../../../migrations/sqlite/0003_trust.sql")),
    (5, "slices", include_str!("../../../migrations/sqlite/0005_slices.sql")),
    (6, "judgements", include_str!("../../../migrations/sqlite/0006_judgements.sql")),
    (7, "figures", include_str!("../../../migrations/sqlite/0007_figures.sql")),
    (8, "ranges", include_str!("../../../migrations/sqlite/0008_ranges.sql")),
    (9, "learned", include_str!("../../../migrations/sqlite/0009_learned.sql")),
    (10, "changed_signs", include_str!("../../../migrations/sqlite/0010_changed_signs.sql")),
    (11, "history", include_str!("../../../migrations/sqlite/0011_history.sql")),
    (12, "map_keys", include_str!("../../../migrations/sqlite/0012_map_keys.sql")),
    (POINT_BLOCKS, "compact", include_str!("../../../migrations/sqlite/0013_compact.sql")),
    (14, "no_point_rows", include_str!("../../../migrations/sqlite/0014_no_point_rows.sql")),
    (15, "globals", include_str!("../../../migrations/sqlite/0015_globals.sql")),
    (16, "prior_anchors", include_str!("../../../migrations/sqlite/0016_prior_anchors.sql")),
    (17, "observations", include_str!("../../../migrations/sqlite/0017_observations.sql")),
    (18, "session_merges", include_str!("../../../migrations/sqlite/0018_session_merges.sql")),
    (19, "frames", include_str!("../../../migrations/sqlite/0019_frames.sql")),
    (20, "releases", include_str!("../../../migrations/sqlite/0020_releases.sql")),
    (21, "erasures", include_str!("../../../migrations/sqlite/0021_erasures.sql")),
    (22, "event_numbers", include_str!("../../../migrations/sqlite/0022_event_numbers.sql")),
];

/// The schema that has map points in rows and in blocks.
const POINT_BLOCKS: i64 = 13;

/// Returns the newest schema that this program knows.
pub fn newest() -> i64 {
    MIGRATIONS.last().map_or(0, |(version, ..)| *version)
}

/// Returns the schema's version in a database; 0 in an empty one.
pub(in crate::store) async fn version(db: &mut Connection) -> Result<i64, StoreError> {
    let select = "select count(*) from sqlite_schema where name = '_sqlx_migrations'";
    let is_ours: i64 = sql::query_scalar(select).fetch_one(&mut *db).await?;
    if is_ours == 0 {
        let tables: i64 = sql::query_scalar("select count(*) from sqlite_schema").fetch_one(&mut *db).await?;
        return match tables {
            0 => Ok(0),
            _ => Err(StoreError::Database("another program's database".to_owned())),
        };
    }
    let select = "select coalesce(max(version), 0) from _sqlx_migrations where success";
    Ok(sql::query_scalar(select).fetch_one(db).await?)
}

/// Brings the database to this version's schema; each step is one transaction.
pub(in crate::store) async fn migrate(pool: &SqlitePool) -> Result<(), StoreError> {
    let found = version(&mut Connection::PooledSqlite(pool.acquire().await?)).await?;
    if found <= POINT_BLOCKS {
        let steps = MIGRATIONS.iter().take_while(|(version, ..)| *version <= POINT_BLOCKS).count();
        migrate_by(pool, &MIGRATIONS[..steps]).await?;
        point_blocks::move_rows(&Pool::Sqlite(pool.clone())).await?;
    }
    migrate_by(pool, MIGRATIONS).await
}

/// Whether it is this version's schema already.
pub(in crate::store) async fn expect_newest(pool: &SqlitePool) -> Result<(), StoreError> {
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

async fn migrate_by(pool: &SqlitePool, migrations: &[Step]) -> Result<(), StoreError> {
    let known = migrations.last().map_or(0, |(version, ..)| *version);
    let migrations = migrations.iter().map(|(version, name, sql)| {
        Migration::new(*version, Cow::Borrowed(*name), MigrationType::Simple, sql.into_sql_str(), false)
    });
    let found = version(&mut Connection::PooledSqlite(pool.acquire().await?)).await?;
    if found > known {
        return Err(StoreError::Newer { found, known });
    }
    Migrator::with_migrations(migrations.collect()).run(pool).await.map_err(|error| match error {
        MigrateError::VersionMissing(found) => StoreError::Newer { found, known },
        MigrateError::VersionMismatch(version) => StoreError::Database(format!(
            "migration {version} was edited after it was applied here: this build of revisit is not a release"
        )),
        error => StoreError::Database(format!("migration: {error}")),
    })?;
    if found > 0 && found < known {
        tracing::info!(from = found, to = known, "the database has a newer schema now");
    }
    Ok(())
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
        migrate_by(&pool, &MIGRATIONS[..1]).await.unwrap();
        let broken = "create table half (a integer) strict; insert into no_such_table values (1)";
        let failed = migrate_by(&pool, &[MIGRATIONS[0], (2, "broken", broken)]).await.unwrap_err();
        assert!(failed.to_string().contains("no_such_table"), "{failed}");
        let mut db = Connection::PooledSqlite(pool.acquire().await.unwrap());
        assert_eq!(version(&mut db).await.unwrap(), 1);
        let half = "select count(*) from sqlite_schema where name = 'half'";
        assert_eq!(sql::query_scalar::<i64>(half).fetch_one(&mut db).await.unwrap(), 0);
        drop(db);
        // And the right one can still be applied.
        migrate(&pool).await.unwrap();
        let mut db = Connection::PooledSqlite(pool.acquire().await.unwrap());
        assert_eq!(version(&mut db).await.unwrap(), newest());
    }
}
