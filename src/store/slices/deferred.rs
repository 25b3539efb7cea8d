//! Deferred changes: poses and points that are committed in the log, and reach their rows later, in slices.
//!
//! A correction of 100,000 poses would rewrite 100,000 rows in one transaction, and every other map's writes would wait
//! for it. Instead its parts are written to the log, where they may share groups with other jobs and count for nothing yet. One
//! small transaction with the map's new version then makes them facts. [`super::fold`] brings them into the rows; the map's row
//! says from which part on they wait, and a map is loaded with these on top of its rows.
//!
//! Later changes of the same kinds must not overtake them, so they are deferred too while a map has any. What is folded is a
//! plain assignment: folding a part twice changes nothing.

use std::borrow::Cow;

use sqlx::AssertSqlSafe;

use crate::domain::change::Change;
use crate::domain::ids::KeyframeSeq;
use crate::geometry::Point3;
use crate::store::StoreError;
use crate::store::commit::cost;
use crate::store::commit::job::{Batch, Job, MapKey};
use crate::store::log::entry::Entry;
use crate::store::log::log_rows::{self, COUNTS, FIRST_PART};
use crate::store::log::parts::{self, Kind, can_wait, is_ordered};
use crate::store::rows::statement::run;
use crate::store::rows::validate::Known;
use crate::store::sql::{self, Connection};

/// What a batch's changes of these kinds may cost if written at once, in microseconds; above it they are deferred.
const DIRECT_US: u64 = if cfg!(test) { 100 } else { 20_000 };

/// Returns the jobs that stage a batch's large changes, if it has any, and the one that commits it.
pub(in crate::store) fn staged(job: Job) -> Vec<Job> {
    let Job::Change(mut batch) = job else { return vec![job] };
    let cost: u64 = batch.changes.iter().filter(|change| can_wait(change)).map(cost::of_change).sum();
    if cost <= DIRECT_US {
        return vec![Job::Change(batch)];
    }
    let frees_space = Job::batch_frees_space(&batch);
    let (map, version) = (batch.map, batch.version);
    let former = std::mem::take(&mut batch.former);
    let (waiting, rest): (Vec<Change>, Vec<Change>) =
        std::mem::take(&mut batch.changes).into_iter().partition(can_wait);
    batch.changes = rest;
    let mut parts = parts::moved(waiting.into_iter().map(Cow::Owned), !former.is_empty());
    parts.extend(parts::replaced(former));
    // Who follows the map would be told a part of it only.
    batch.is_followed = false;
    let stage = |(number, part)| Job::Stage { map, version, number, part, frees_space };
    let mut jobs: Vec<Job> = (FIRST_PART + 1..).zip(parts).map(stage).collect();
    jobs.push(Job::ChangeStaged { batch, frees_space });
    jobs
}

/// Defers the ordered changes of a batch behind those that wait already.
pub(in crate::store) async fn defer(db: &mut Connection, batch: &Batch) -> Result<(), StoreError> {
    let ordered = batch.changes.iter().filter(|change| is_ordered(change)).map(Cow::Borrowed);
    for (number, part) in (FIRST_PART + 1..).zip(parts::moved(ordered, !batch.former.is_empty())) {
        log_rows::stage(db, (batch.map, batch.version), number, &part).await?;
    }
    Ok(())
}

/// Notes that the parts of a version wait for their rows, behind those that do already.
pub(in crate::store) async fn wait(
    db: &mut Connection,
    (map, version): (MapKey, u64),
) -> Result<(), StoreError> {
    let update =
        "update maps set waits_version = $2, waits_part = $3 where map_key = $1 and waits_version is null";
    run(db, sql::statement(update, (map, version, FIRST_PART + 1))).await
}

/// Whether changes of a map wait for their rows.
pub(in crate::store) async fn any(db: &mut Connection, map: MapKey) -> Result<bool, StoreError> {
    let select = "select waits_version is not null from maps where map_key = $1";
    Ok(sql::query_scalar(select).bind(map).fetch_optional(db).await?.unwrap_or(false))
}

/// Parts that are read at a time.
const PARTS_AT_ONCE: i64 = 64;

/// A part that waits for its rows.
pub(super) struct Waiting {
    pub at: (i64, i64),
    pub kind: String,
    pub entry: Entry<'static>,
}

/// Returns the first parts of a map that wait, after one; of every kind, or of one.
pub(super) async fn waiting_after(
    db: &mut Connection,
    map: MapKey,
    (version, part): (i64, i64),
    kind: Option<Kind>,
    limit: i64,
) -> Result<Vec<Waiting>, StoreError> {
    let select = format!(
        "select v.version, v.part, v.kind, v.body from versions v join maps m using (map_key)
        where v.map_key = $1 and (v.version, v.part) >= (m.waits_version, m.waits_part)
            and (v.version, v.part) > ($2, $3) and v.kind <> 'said' and v.part > 0 and v.kind = coalesce($4, v.kind)
            and {COUNTS} order by v.version, v.part limit $5"
    );
    let query = sql::query_as(AssertSqlSafe(select)).bind(map).bind(version).bind(part);
    let rows: Vec<(i64, i64, String, Vec<u8>)> =
        query.bind(kind.map(Kind::as_str)).bind(limit).fetch_all(db).await?;
    let waiting = |(version, part, kind, body): (i64, i64, String, Vec<u8>)| {
        Ok(Waiting { at: (version, part), kind, entry: Entry::of(&body)? })
    };
    rows.into_iter().map(waiting).collect()
}

/// Takes a map's deferred changes, of every kind or of one, in their order and some parts at a time: together they may be more than
/// memory holds.
pub(in crate::store) async fn for_each(
    db: &mut Connection,
    map: MapKey,
    kind: Option<Kind>,
    mut take: impl FnMut(Vec<Change>) + Send,
) -> Result<(), StoreError> {
    let mut last = (0, 0);
    loop {
        let parts = waiting_after(db, map, last, kind, PARTS_AT_ONCE).await?;
        let Some(part) = parts.last() else { return Ok(()) };
        last = part.at;
        for part in parts {
            take(part.entry.changes.into_iter().map(Cow::into_owned).collect());
        }
    }
}

/// Tells a map's deferred changes on top of its rows.
pub(in crate::store) async fn apply(
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
    for_each(db, map, None, take).await
}

/// Returns the deferred positions of a keyframe's detections, the latest last.
pub(in crate::store) async fn positions(
    db: &mut Connection,
    map: MapKey,
    keyframe: KeyframeSeq,
) -> Result<Vec<(u16, Point3)>, StoreError> {
    let mut found = Vec::new();
    if any(db, map).await? {
        let take = |changes: Vec<Change>| {
            found.extend(changes.into_iter().filter_map(|change| match change {
                Change::PositionSet(_, seen_by, detection, at) if seen_by == keyframe => {
                    Some((detection, at))
                }
                _ => None,
            }));
        };
        for_each(db, map, Some(Kind::Positions), take).await?;
    }
    Ok(found)
}
