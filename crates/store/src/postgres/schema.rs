//! The schema's versions for PostgreSQL. A migration that was ever released is never edited, not even its comments.
//!
//! Servers of two versions may run side by side while a fleet is upgraded: each version says which older programs can work with it.

use std::time::Duration;

use sqlx::migrate::{MigrateError, Migrator};
use sqlx::postgres::{PgConnection, PgPool};
use tokio::time::sleep;

use crate::StoreError;
use crate::migrations::{migrator, version_by};
use crate::sql::Statements;

/// A version of the schema.
#[derive(Clone, Copy, Debug)]
struct Step {
    version: i64,
    name: &'static str,
    statements: &'static str,
    /// The oldest version that a program may know to work with it.
    oldest: i64,
}

const MIGRATIONS: &[Step] = &[Step {
    version: 1,
    name: "facts",
    statements: include_str!("../../migrations/postgres/0001_facts.sql"),
    oldest: 1,
}];

/// Maximum tries of a migration: servers that start together on an empty database are in each other's way.
const TRIES: u32 = 10;

/// The time between two tries.
const TRIED_AGAIN_AFTER: Duration = Duration::from_millis(300);

/// The schema of a database, as it says itself.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct Found {
    /// Its version; 0 of an empty database.
    version: i64,
    /// The oldest version that a program may know to work with it.
    oldest: i64,
    /// The versions that the servers know which are there.
    known_to_servers: Vec<i64>,
}

/// Returns the newest version that this program knows.
pub(super) fn newest() -> i64 {
    MIGRATIONS.last().map_or(0, |step| step.version)
}

/// Forgets the statements that a session has prepared, this one's or another server's, which give them the same names.
const FORGET: &str = "deallocate all";

/// Brings the database to this version's schema, in one transaction. A newer one stays as it is, if this program can work with it.
pub(crate) async fn migrate(pool: &PgPool, how: Statements) -> Result<(), StoreError> {
    let mut tries = 0;
    loop {
        tries += 1;
        match try_to_migrate(pool, how).await {
            // Two servers that start on an empty database make the same tables, and one of them waits and fails.
            Err(StoreError::Database(error)) if tries < TRIES => {
                tracing::debug!(error, "the schema is tried again");
                sleep(TRIED_AGAIN_AFTER).await;
            }
            done => return done,
        }
    }
}

async fn try_to_migrate(pool: &PgPool, how: Statements) -> Result<(), StoreError> {
    let mut db = pool.begin().await?;
    if how == Statements::Unnamed {
        sqlx::raw_sql(FORGET).execute(&mut *db).await?;
    }
    if let Some(oldest) = to_be_migrated(&found(&mut db).await?, MIGRATIONS)? {
        run(&mut db).await.map_err(|error| StoreError::Database(error.to_string()))?;
        let update = "update schema_reach set oldest = $1 where oldest < $1";
        sqlx::query(update).bind(oldest).execute(&mut *db).await?;
    }
    if how == Statements::Unnamed {
        sqlx::raw_sql(FORGET).execute(&mut *db).await?;
    }
    Ok(db.commit().await?)
}

fn steps() -> Migrator {
    migrator(MIGRATIONS.iter().map(|step| (step.version, step.name, step.statements)))
}

async fn run(db: &mut PgConnection) -> Result<(), MigrateError> {
    let mut migrator = steps();
    // It would lock by a session, which a pooler of connections does not keep; the tables' own locks order the steps.
    migrator.set_locking(false);
    migrator.run(db).await
}

async fn found(db: &mut PgConnection) -> Result<Found, StoreError> {
    let are_there = "select to_regclass('_sqlx_migrations') is not null, to_regclass('maps') is not null";
    match sqlx::query_as(are_there).fetch_one(&mut *db).await? {
        (false, false) => return Ok(Found::default()),
        (false, true) => return Err(StoreError::UnknownForm),
        (true, _) => {}
    }
    let applied = "select version, checksum from _sqlx_migrations where success order by version";
    let applied: Vec<(i64, Vec<u8>)> = sqlx::query_as(applied).fetch_all(&mut *db).await?;
    let version = version_by(&applied, &steps())?;
    let oldest = sqlx::query_scalar("select oldest from schema_reach");
    let known =
        sqlx::query_scalar("select schema from nodes where expires > clock_timestamp() order by schema");
    Ok(Found {
        version,
        oldest: oldest.fetch_one(&mut *db).await?,
        known_to_servers: known.fetch_all(&mut *db).await?,
    })
}

/// Returns the oldest version that a program may know once the steps are done that are missing; `None` if there is nothing to do.
fn to_be_migrated(found: &Found, steps: &[Step]) -> Result<Option<i64>, StoreError> {
    let newest = steps.last().map_or(0, |step| step.version);
    if found.version > newest && found.oldest > newest {
        return Err(StoreError::Newer { found: found.version, known: newest });
    }
    let missing = steps.iter().filter(|step| step.version > found.version);
    let Some(oldest) = missing.map(|step| step.oldest).max() else { return Ok(None) };
    match found.known_to_servers.iter().find(|known| **known < oldest) {
        Some(known) => Err(StoreError::OldServers { known: *known, oldest }),
        None => Ok(Some(oldest)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_version_is_reached_only_where_every_server_that_is_there_can_work_with_it() {
        let step = |version, oldest| Step { version, name: "", statements: "", oldest };
        // 23 adds a column that 22 does not need; 24 takes one away that 22 reads.
        let steps = [step(22, 22), step(23, 22), step(24, 23)];
        let reached = |version, oldest, servers: &[i64], known: usize| {
            let found = Found { version, oldest, known_to_servers: servers.to_vec() };
            to_be_migrated(&found, &steps[..known]).map_err(|error| match error {
                StoreError::Newer { .. } => "newer",
                StoreError::OldServers { .. } => "old servers",
                other => panic!("{other}"),
            })
        };
        assert_eq!(reached(0, 0, &[], 3), Ok(Some(23)));
        assert_eq!(reached(22, 22, &[22, 22], 2), Ok(Some(22)), "side by side");
        assert_eq!(reached(23, 22, &[22, 23], 2), Ok(None));
        assert_eq!(reached(23, 22, &[23], 1), Ok(None), "the older program still starts");
        assert_eq!(reached(23, 22, &[22, 23], 3), Err("old servers"));
        assert_eq!(reached(23, 22, &[23], 3), Ok(Some(23)));
        assert_eq!(reached(24, 23, &[24], 1), Err("newer"));
    }
}
