//! The log's rows, to the database and back.

use sqlx::AssertSqlSafe;

use super::entry::Entry;
use super::parts::{Kind, Part};
use crate::StoreError;
use crate::map_key::MapKey;
use crate::sql::run;
use crate::sql::{self, Connection};

/// The part that makes the others of its version count.
pub(crate) const FIRST_PART: i64 = 0;

/// The number of what models said before: it is no part of what the version says.
const UNSAID: i64 = -1;

/// Whether the version of a row of `versions v` counts.
pub(crate) const COUNTS: &str = "exists (select 1 from versions o
    where o.map_key = v.map_key and o.version = v.version and o.part = 0)";

/// A row of the log.
#[derive(Debug)]
pub(crate) struct Logged {
    pub version: u64,
    pub part: i64,
    pub body: Vec<u8>,
}

/// Adds a part of a version.
pub(crate) async fn add(
    db: &mut Connection,
    (map, version): (MapKey, u64),
    number: i64,
    part: &Part<'_>,
) -> Result<(), StoreError> {
    let number = if part.kind == Kind::Unsaid { UNSAID } else { number };
    let insert = "insert into versions (map_key, version, part, kind, body) values ($1, $2, $3, $4, $5)";
    let values = (map, version, number, part.kind.as_str(), part.entry.to_bytes()?);
    run(db, sql::statement(insert, values)).await
}

/// Adds a part that counts for nothing until its version's first part is there.
pub(crate) async fn stage(
    db: &mut Connection,
    (map, version): (MapKey, u64),
    number: i64,
    part: &Part<'_>,
) -> Result<(), StoreError> {
    if number == FIRST_PART + 1 {
        // An earlier attempt at this version may have failed halfway.
        let leftover = "delete from versions where map_key = $1 and version >= $2";
        run(db, sql::statement(leftover, (map, version))).await?;
    }
    add(db, (map, version), number, part).await
}

/// Returns what the next version after one said, if there is one.
pub(crate) async fn after(
    db: &mut Connection,
    map: MapKey,
    version: u64,
) -> Result<Option<(u64, Vec<Entry<'static>>)>, StoreError> {
    let select = format!(
        "select min(version) from versions v where map_key = $1 and version > $2 and kind in ('said', 'moved') and {COUNTS}"
    );
    let next = sql::query_scalar(AssertSqlSafe(select)).bind(map).bind(version);
    let Some(next): Option<u64> = next.fetch_one(&mut *db).await? else { return Ok(None) };
    Ok(Some((next, of_version(db, map, next).await?)))
}

/// Returns what a version said.
pub(crate) async fn of_version(
    db: &mut Connection,
    map: MapKey,
    version: u64,
) -> Result<Vec<Entry<'static>>, StoreError> {
    let select = "select body from versions
        where map_key = $1 and version = $2 and kind in ('said', 'moved') order by part";
    let rows: Vec<Vec<u8>> = sql::query_scalar(select).bind(map).bind(version).fetch_all(db).await?;
    rows.iter().map(|body| Entry::of(body)).collect()
}

/// Returns a row after one, of whatever kind: a map's log may be more than memory holds.
pub(crate) async fn row_after(
    db: &mut Connection,
    map: MapKey,
    (version, part): (u64, i64),
) -> Result<Option<Logged>, StoreError> {
    let select = "select version, part, body from versions
        where map_key = $1 and (version, part) > ($2, $3) order by version, part limit 1";
    let found = sql::query_as(select).bind(map).bind(version).bind(part).fetch_optional(db).await?;
    Ok(found.map(|(version, part, body)| Logged { version, part, body }))
}

/// Writes another body into a row, or removes the row where there is none.
pub(crate) async fn replace(
    db: &mut Connection,
    map: MapKey,
    row: &Logged,
    body: Option<Vec<u8>>,
) -> Result<(), StoreError> {
    let update = "update versions set body = $4 where map_key = $1 and version = $2 and part = $3";
    let delete = "delete from versions where map_key = $1 and version = $2 and part = $3";
    let query = match body {
        Some(body) => sql::statement(update, (map, row.version, row.part, body)),
        None => sql::statement(delete, (map, row.version, row.part)),
    };
    run(db, query).await
}

/// Removes the parts that a process staged and did not commit.
pub(crate) async fn remove_uncommitted(db: &mut Connection) -> Result<(), StoreError> {
    let delete = "delete from versions where (map_key, version, part) in (
        select v.map_key, v.version, v.part from maps m
        join versions v on v.map_key = m.map_key and v.version > m.version)";
    run(db, sql::query(delete)).await
}

/// Removes the parts of a map that a server staged and did not commit.
pub(crate) async fn remove_uncommitted_of(db: &mut Connection, map: MapKey) -> Result<(), StoreError> {
    let delete = "delete from versions where map_key = $1
        and version > (select version from maps where map_key = $1)";
    run(db, sql::statement(delete, (map,))).await
}
