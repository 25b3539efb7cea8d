//! The log's rows, to the database and back.

use sqlx::AssertSqlSafe;

use super::entry::Entry;
use super::parts::{Kind, Part};
use crate::store::StoreError;
use crate::store::commit::job::MapKey;
use crate::store::rows::statement::run;
use crate::store::sql::{self, Connection};

/// The part that makes the others of its version count.
pub(in crate::store) const FIRST_PART: i64 = 0;

/// The number of what models said before: it is no part of what the version says.
const UNSAID: i64 = -1;

/// Whether the version of a row of `versions v` counts.
pub(in crate::store) const COUNTS: &str = "exists (select 1 from versions o
    where o.map_key = v.map_key and o.version = v.version and o.part = 0)";

/// A row of the log.
#[derive(Debug)]
pub(in crate::store) struct Logged {
    pub version: u64,
    pub part: i64,
    pub body: Vec<u8>,
}

/// Adds a part of a version.
pub(in crate::store) async fn add(
    db: &mut Connection,
    (map, version): (MapKey, u64),
    number: i64,
    part: &Part<'_>,
) -> Result<(), StoreError> {
    let number = if part.kind == Kind::Unsaid { UNSAID } else { number };
    let insert = "insert into versions (map_key, version, part, kind, body) values ($1, $2, $3, $4, $5)";
    let query = sql::query(insert).bind(map).bind(version as i64).bind(number);
    run(db, query.bind(part.kind.as_str()).bind(part.entry.to_bytes()?)).await
}

/// Adds a part that counts for nothing until its version's first part is there.
pub(in crate::store) async fn stage(
    db: &mut Connection,
    (map, version): (MapKey, u64),
    number: i64,
    part: &Part<'_>,
) -> Result<(), StoreError> {
    if number == FIRST_PART + 1 {
        // An earlier attempt at this version may have failed halfway.
        let leftover = "delete from versions where map_key = $1 and version >= $2";
        run(db, sql::query(leftover).bind(map).bind(version as i64)).await?;
    }
    add(db, (map, version), number, part).await
}

/// Returns what the next version after one said, if there is one.
pub(in crate::store) async fn after(
    db: &mut Connection,
    map: MapKey,
    version: u64,
) -> Result<Option<(u64, Vec<Entry<'static>>)>, StoreError> {
    let select = format!(
        "select min(version) from versions v where map_key = $1 and version > $2 and kind in ('said', 'moved') and {COUNTS}"
    );
    let next = sql::query_scalar(AssertSqlSafe(select)).bind(map).bind(version as i64);
    let Some(next): Option<i64> = next.fetch_one(&mut *db).await? else { return Ok(None) };
    Ok(Some((next as u64, of_version(db, map, next).await?)))
}

/// Returns what a version said.
pub(in crate::store) async fn of_version(
    db: &mut Connection,
    map: MapKey,
    version: i64,
) -> Result<Vec<Entry<'static>>, StoreError> {
    let select = "select body from versions
        where map_key = $1 and version = $2 and kind in ('said', 'moved') order by part";
    let rows: Vec<Vec<u8>> = sql::query_scalar(select).bind(map).bind(version).fetch_all(db).await?;
    rows.iter().map(|body| Entry::of(body)).collect()
}

/// Returns a row after one, of whatever kind: a map's log may be more than memory holds.
pub(in crate::store) async fn row_after(
    db: &mut Connection,
    map: MapKey,
    (version, part): (u64, i64),
) -> Result<Option<Logged>, StoreError> {
    let select = "select version, part, body from versions
        where map_key = $1 and (version, part) > ($2, $3) order by version, part limit 1";
    let query = sql::query_as(select).bind(map).bind(version as i64).bind(part);
    let found: Option<(i64, i64, Vec<u8>)> = query.fetch_optional(db).await?;
    Ok(found.map(|(version, part, body)| Logged { version: version as u64, part, body }))
}

/// Writes another body into a row, or removes the row where there is none.
pub(in crate::store) async fn replace(
    db: &mut Connection,
    map: MapKey,
    row: &Logged,
    body: Option<Vec<u8>>,
) -> Result<(), StoreError> {
    let (change, body) = match body {
        Some(body) => {
            ("update versions set body = $4 where map_key = $1 and version = $2 and part = $3", Some(body))
        }
        None => ("delete from versions where map_key = $1 and version = $2 and part = $3", None),
    };
    let query = sql::query(change).bind(map).bind(row.version as i64).bind(row.part);
    run(db, if let Some(body) = body { query.bind(body) } else { query }).await
}

/// Removes the parts that a process staged and did not commit.
pub(in crate::store) async fn remove_uncommitted(db: &mut Connection) -> Result<(), StoreError> {
    let delete = "delete from versions where (map_key, version, part) in (
        select v.map_key, v.version, v.part from maps m
        join versions v on v.map_key = m.map_key and v.version > m.version)";
    run(db, sql::query(delete)).await
}

/// Removes the parts of a map that a server staged and did not commit.
pub(in crate::store) async fn remove_uncommitted_of(
    db: &mut Connection,
    map: MapKey,
) -> Result<(), StoreError> {
    let delete = "delete from versions where map_key = $1
        and version > (select version from maps where map_key = $1)";
    run(db, sql::query(delete).bind(map)).await
}
