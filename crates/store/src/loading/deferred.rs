//! Deferred changes: poses and points that are committed in the log, and reach their rows later, in slices.
//!
//! A correction of 100,000 poses would rewrite 100,000 rows in one transaction, and every other map's writes would wait
//! for it. Instead its parts are written to the log, where they may share groups with other jobs and count for nothing yet. One
//! small transaction with the map's new version then makes them facts. [`crate::slices::fold`] brings them into the rows; the map's row
//! says from which part on they wait, and a map is loaded with these on top of its rows.
//!
//! Later changes of the same kinds must not overtake them, so they are deferred too while a map has any. What is folded is a
//! plain assignment: folding a part twice changes nothing.

use std::borrow::Cow;

use revisit_core::domain::change::Change;
use sqlx::AssertSqlSafe;

use crate::StoreError;
use crate::jobs::job::Batch;
use crate::log::entry::Entry;
use crate::log::log_rows::{self, COUNTS, FIRST_PART};
use crate::log::parts::{self, is_ordered};
use crate::map_key::MapKey;
use crate::rows::validate::Known;
use crate::sql::run;
use crate::sql::{self, Connection};

/// Defers the ordered changes of a batch behind those that wait already.
pub(crate) async fn defer(db: &mut Connection, batch: &Batch) -> Result<(), StoreError> {
    let ordered = batch.changes.iter().filter(|change| is_ordered(change)).map(Cow::Borrowed);
    for (number, part) in (FIRST_PART + 1..).zip(parts::moved(ordered, !batch.former.is_empty())) {
        log_rows::stage(db, (batch.map, batch.version), number, &part).await?;
    }
    Ok(())
}

/// Notes that the parts of a version wait for their rows, behind those that do already.
pub(crate) async fn wait(db: &mut Connection, (map, version): (MapKey, u64)) -> Result<(), StoreError> {
    let update =
        "update maps set waits_version = $2, waits_part = $3 where map_key = $1 and waits_version is null";
    run(db, sql::statement(update, (map, version, FIRST_PART + 1))).await
}

/// Whether changes of a map wait for their rows.
pub(crate) async fn any(db: &mut Connection, map: MapKey) -> Result<bool, StoreError> {
    Ok(first(db, map).await?.is_some())
}

/// Returns the first part of a map that waits for its rows, by version and number.
async fn first(db: &mut Connection, map: MapKey) -> Result<Option<(i64, i64)>, StoreError> {
    let select =
        "select waits_version, waits_part from maps where map_key = $1 and waits_version is not null";
    Ok(sql::query_as(select).bind(map).fetch_optional(db).await?)
}

/// Parts that are read at a time.
const PARTS_AT_ONCE: i64 = 64;

/// A part that waits for its rows.
pub(crate) struct Waiting {
    pub at: (i64, i64),
    pub kind: String,
    pub entry: Entry<'static>,
}

/// Returns the first part of a map that waits, if any does.
pub(crate) async fn next(db: &mut Connection, map: MapKey) -> Result<Option<Waiting>, StoreError> {
    let Some(first) = first(db, map).await? else { return Ok(None) };
    Ok(from(db, map, first, 1).await?.pop())
}

/// Returns parts of a map that wait, from one on.
///
/// The place of the first one is asked before, by [`first`]: were it joined here, SQLite would search every page from there.
async fn from(
    db: &mut Connection,
    map: MapKey,
    (version, part): (i64, i64),
    limit: i64,
) -> Result<Vec<Waiting>, StoreError> {
    let select = format!(
        "select v.version, v.part, v.kind, v.body from versions v
        where v.map_key = $1 and (v.version, v.part) >= ($2, $3) and v.kind <> 'said' and v.part > 0
            and {COUNTS} order by v.version, v.part limit $4"
    );
    let query = sql::query_as(AssertSqlSafe(select)).bind(map).bind(version).bind(part);
    let rows: Vec<(i64, i64, String, Vec<u8>)> = query.bind(limit).fetch_all(db).await?;
    let waiting = |(version, part, kind, body): (i64, i64, String, Vec<u8>)| {
        Ok(Waiting { at: (version, part), kind, entry: Entry::of(&body)? })
    };
    rows.into_iter().map(waiting).collect()
}

/// Takes a map's deferred changes in their order and some parts at a time: together they may be more than memory holds.
pub(crate) async fn for_each(
    db: &mut Connection,
    map: MapKey,
    mut take: impl FnMut(Vec<Change>) + Send,
) -> Result<(), StoreError> {
    let mut start = first(db, map).await?;
    while let Some(at) = start {
        let parts = from(db, map, at, PARTS_AT_ONCE).await?;
        start = parts.last().map(|part| (part.at.0, part.at.1 + 1));
        for part in parts {
            take(part.entry.changes.into_iter().map(Cow::into_owned).collect());
        }
    }
    Ok(())
}

/// Tells a map's deferred changes on top of its rows.
pub(crate) async fn apply(
    db: &mut Connection,
    map: MapKey,
    known: &mut Known,
    take: &mut (impl FnMut(Vec<Change>) + Send),
) -> Result<(), StoreError> {
    let take = |mut changes: Vec<Change>| {
        changes.retain(|change| match change {
            // Of an anchor's versions the largest counts.
            Change::AnchorTouched(anchor, version) => known.anchors.get_mut(anchor).is_some_and(|anchor| {
                let is_newer = anchor.version < *version;
                anchor.version = anchor.version.max(*version);
                is_newer
            }),
            _ => true,
        });
        take(changes);
    };
    for_each(db, map, take).await
}
