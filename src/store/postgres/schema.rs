//! The schema's versions for PostgreSQL. A migration that was ever released is never edited, not even its comments.
//!
//! It began when SQLite's schema was at 22: an older database comes over by `revisit copy`, which writes the newest rows.

use std::borrow::Cow;

use sqlx::SqlSafeStr;
use sqlx::migrate::{Migration, MigrationType, Migrator};
use sqlx::postgres::PgPool;

use crate::store::StoreError;

/// A version, its name, and its statements.
type Step = (i64, &'static str, &'static str);

const MIGRATIONS: &[Step] = &[(22, "facts", include_str!("../../../migrations/postgres/0022_facts.sql"))];

/// Brings the database to this version's schema; each step is one transaction.
pub(in crate::store) async fn migrate(pool: &PgPool) -> Result<(), StoreError> {
    let migration = |(version, name, statements): &Step| {
        Migration::new(
            *version,
            Cow::Borrowed(*name),
            MigrationType::Simple,
            statements.into_sql_str(),
            false,
        )
    };
    let mut migrator = Migrator::with_migrations(MIGRATIONS.iter().map(migration).collect());
    // It would lock by a session, which a pooler of connections does not keep; the tables' own locks order the steps.
    migrator.set_locking(false);
    migrator.run(pool).await.map_err(|error| StoreError::Database(error.to_string()))
}
