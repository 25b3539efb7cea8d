//! Holdings: how much a database has in it.

use sqlx::ConnectOptions as _;

use super::StoreError;
use super::files::paths::DatabaseFiles;
use super::files::schema;
use crate::sql::{self, Connection};

/// The contents of a database, counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Holdings {
    /// The schema's version.
    pub schema: i64,
    /// Maps.
    pub maps: u64,
    /// Keyframes of all maps and their releases.
    pub keyframes: u64,
    /// Anchors of all maps and their releases, merged ones too.
    pub anchors: u64,
}

impl Holdings {
    /// Counts what a file holds that no process changes.
    pub async fn of_file(file: &DatabaseFiles) -> Result<Self, StoreError> {
        holdings(&mut Connection::Sqlite(file.read_only().immutable(true).connect().await?)).await
    }
}

/// Counts what a database holds.
pub(super) async fn holdings(db: &mut Connection) -> Result<Holdings, StoreError> {
    let schema = schema::version(&mut *db).await?;
    // What a deleted map still has is no map's any more.
    let count = "select (select count(*) from maps where deleted = 0 and id not like '%/%'),
        (select count(*) from keyframes where map_key in (select map_key from maps where deleted = 0)),
        (select count(*) from anchors where map_key in (select map_key from maps where deleted = 0))";
    let (maps, keyframes, anchors) = sql::query_as(count).fetch_one(&mut *db).await?;
    Ok(Holdings { schema, maps, keyframes, anchors })
}
