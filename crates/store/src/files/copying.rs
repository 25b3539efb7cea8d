//! Copying: the whole database into another file, as one read transaction sees it.

use sqlx::ConnectOptions as _;
use sqlx::sqlite::SqliteConnectOptions;

use super::paths::DatabaseFiles;
use super::{log, schema};
use crate::StoreError;
use crate::sql::{self, Connection};

/// Copies a database into an empty file, and returns its schema's version. A running server continues: the copy takes a
/// connection of its own, and what is written meanwhile stays in the write-ahead log until it ends.
pub async fn copy(source: &DatabaseFiles, into: &str) -> Result<i64, StoreError> {
    vacuum(source.read_only(), into).await
}

/// Copies a database that this process does not have open. Returns its schema's version, and the faults of its log.
pub async fn copy_from_outside(source: &DatabaseFiles, into: &str) -> Result<(i64, Vec<String>), StoreError> {
    let log = log::look(source)?;
    let schema = vacuum(source.untouched(!log.faults.is_empty()), into).await?;
    Ok((schema, log.faults))
}

async fn vacuum(source: SqliteConnectOptions, into: &str) -> Result<i64, StoreError> {
    let db = source.connect().await?;
    let mut db = Connection::Sqlite(db);
    let schema = schema::version(&mut db).await?;
    sql::query("vacuum into $1").bind(into).execute(&mut db).await?;
    db.close().await?;
    Ok(schema)
}
