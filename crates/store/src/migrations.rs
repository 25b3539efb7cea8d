//! Migrations: the steps of a schema, and whether they made a database.

use std::borrow::Cow;

use sqlx::SqlSafeStr as _;
use sqlx::migrate::{Migration, MigrationType, Migrator};

use super::StoreError;

/// A version, its name, and its statements.
pub(super) type Step = (i64, &'static str, &'static str);

/// Returns what does these steps.
pub(super) fn migrator(steps: impl IntoIterator<Item = Step>) -> Migrator {
    let migration = |(version, name, sql): Step| {
        Migration::new(version, Cow::Borrowed(name), MigrationType::Simple, sql.into_sql_str(), false)
    };
    Migrator::with_migrations(steps.into_iter().map(migration).collect())
}

/// Returns the version of a database that these migrations made, by number and checksum, the oldest first. Rejects one in which others
/// stand in the place of those that are known here.
pub(super) fn version_by(applied: &[(i64, Vec<u8>)], known: &Migrator) -> Result<i64, StoreError> {
    let is_known = |(known, (version, checksum)): (&Migration, &(i64, Vec<u8>))| {
        known.version == *version && *known.checksum == **checksum
    };
    if known.iter().zip(applied).all(is_known) {
        Ok(applied.last().map_or(0, |(version, _)| *version))
    } else {
        Err(StoreError::UnknownForm)
    }
}
