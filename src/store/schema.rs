//! The schema's versions. A migration that was ever released is never edited, not even its comments:
//! its checksum is kept in every database.

use std::borrow::Cow;

use sqlx::SqlSafeStr;
use sqlx::migrate::{Migration, MigrationType, Migrator};
use sqlx::sqlite::SqlitePool;

use super::StoreError;

const MIGRATIONS: &[(i64, &str, &str)] = &[
    (1, "facts", include_str!("../../migrations/sqlite/0001_facts.sql")),
    (2, "models", include_str!("../../migrations/sqlite/0002_models.sql")),
    (3, "trust", include_str!("../../migrations/sqlite/0003_trust.sql")),
];

/// Brings the database to this version's schema; each step is one transaction.
pub(super) async fn migrate(pool: &SqlitePool) -> Result<(), StoreError> {
    let migrations = MIGRATIONS.iter().map(|(version, name, sql)| {
        Migration::new(*version, Cow::Borrowed(*name), MigrationType::Simple, sql.into_sql_str(), false)
    });
    Migrator::with_migrations(migrations.collect())
        .run(pool)
        .await
        .map_err(|error| StoreError::Database(format!("migration: {error}")))
}
