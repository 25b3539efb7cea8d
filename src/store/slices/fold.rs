//! Folding: deferred changes are brought into the rows that they change, in slices.
//!
//! Each step writes some entries and notes how far it has come, in the transaction of its slice.

use super::deferred::unpacked;
use super::parts::Kind;
use crate::domain::change::Change;
use crate::store::StoreError;
use crate::store::commit::job::MapKey;
use crate::store::rows::blob::pack;
use crate::store::rows::former_value_rows;
use crate::store::rows::keyframe_rows::pose_blob;
use crate::store::rows::point_blocks;
use crate::store::rows::statement::run;
use crate::store::sql::{self, Connection};

/// What a part costs beside its entries, as so many of them.
const PART_ENTRIES: u32 = 4;

/// More versions than this are folded as fast as clients write.
const VERSIONS_BEHIND: i64 = 500;

/// The next entries to be folded.
#[derive(Clone, Copy)]
struct Next {
    map_key: MapKey,
    version: i64,
    parts: u32,
    part: u32,
    entries_done: u32,
}

/// Returns the first of these maps that has deferred changes.
pub(in crate::store) async fn next_map(
    db: &mut Connection,
    of: &[MapKey],
) -> Result<Option<MapKey>, StoreError> {
    let select = "select map_key from deferred_changes
        where map_key in (select cast(value as bigint) from json_each($1)) order by map_key limit 1";
    Ok(sql::query_scalar(select).bind(serde_json::json!(of).to_string()).fetch_optional(db).await?)
}

/// Folds about this many entries of a map, or of any, in the caller's transaction. Returns whether there were any.
pub(in crate::store) async fn fold_entries(
    db: &mut Connection,
    of: Option<MapKey>,
    entries: u32,
) -> Result<bool, StoreError> {
    let mut left = entries;
    while left > 0 {
        let Some(next) = next(db, of).await? else { break };
        left = left.saturating_sub(fold_part(db, next, left).await?.max(PART_ENTRIES));
    }
    Ok(left < entries)
}

/// Whether so many versions wait that slices fall behind the clients that add them.
pub(in crate::store) async fn is_behind(db: &mut Connection) -> Result<bool, StoreError> {
    let count: i64 = sql::query_scalar("select count(*) from deferred_changes").fetch_one(db).await?;
    Ok(count > VERSIONS_BEHIND)
}

/// Returns the oldest entries of a map that is whole.
async fn next(db: &mut Connection, of: Option<MapKey>) -> Result<Option<Next>, StoreError> {
    let select = "select map_key, version, parts, part, entries_done from deferred_changes
        where map_key not in (select map_key from maps where deleted <> 0) order by map_key, version limit 1";
    let of_map = "select map_key, version, parts, part, entries_done from deferred_changes
        where map_key = $1 and map_key not in (select map_key from maps where deleted <> 0) order by version limit 1";
    let query = match of {
        Some(map) => sql::query_as(of_map).bind(map),
        None => sql::query_as(select),
    };
    let found: Option<(MapKey, i64, u32, u32, u32)> = query.fetch_optional(db).await?;
    let next =
        |(map_key, version, parts, part, entries_done)| Next { map_key, version, parts, part, entries_done };
    Ok(found.map(next))
}

/// Folds entries of one part, at most this many. Returns how many.
async fn fold_part(db: &mut Connection, next: Next, entries: u32) -> Result<u32, StoreError> {
    if next.part >= next.parts {
        finish_version(db, next).await?;
        return Ok(0);
    }
    let select = "select kind, entries from deferred_parts where map_key = $1 and version = $2 and part = $3";
    let query = sql::query_as(select).bind(next.map_key).bind(next.version).bind(next.part);
    let (kind, bytes): (String, Vec<u8>) = query.fetch_one(&mut *db).await?;
    let kind = Kind::from_name(&kind)?;
    if kind.is_former() {
        former_value_rows::keep_part(db, next.map_key, (next.version, next.part)).await?;
        end_part(db, next).await?;
        return Ok(1);
    }
    let width = kind.width();
    let from = (next.entries_done as usize * width).min(bytes.len());
    let to = from.saturating_add(entries as usize * width).min(bytes.len());
    write(db, next.map_key, unpacked(kind, &bytes[from..to])?).await?;
    let folded = ((to - from) / width) as u32;
    if to < bytes.len() {
        let update = "update deferred_changes set entries_done = $3 where map_key = $1 and version = $2";
        let done = next.entries_done + folded;
        run(db, sql::query(update).bind(next.map_key).bind(next.version).bind(done)).await?;
        return Ok(folded);
    }
    end_part(db, next).await?;
    Ok(folded)
}

async fn end_part(db: &mut Connection, next: Next) -> Result<(), StoreError> {
    let delete = "delete from deferred_parts where map_key = $1 and version = $2 and part = $3";
    run(db, sql::query(delete).bind(next.map_key).bind(next.version).bind(next.part)).await?;
    if next.part + 1 == next.parts {
        return finish_version(db, next).await;
    }
    let update =
        "update deferred_changes set part = part + 1, entries_done = 0 where map_key = $1 and version = $2";
    run(db, sql::query(update).bind(next.map_key).bind(next.version)).await
}

async fn finish_version(db: &mut Connection, next: Next) -> Result<(), StoreError> {
    let delete = "delete from deferred_changes where map_key = $1 and version = $2";
    run(db, sql::query(delete).bind(next.map_key).bind(next.version)).await
}

/// Writes changes of one kind to their rows. What they change may be gone meanwhile.
async fn write(db: &mut Connection, map: MapKey, changes: Vec<Change>) -> Result<(), StoreError> {
    let (mut points, mut forgotten) = (Vec::new(), Vec::new());
    for change in changes {
        match change {
            Change::PoseSet(keyframe, pose) => {
                let update = "update keyframes set pose = $3 where map_key = $1 and keyframe = $2";
                run(db, sql::query(update).bind(map).bind(keyframe.0).bind(pose_blob(&pose))).await?;
            }
            Change::PositionSet(_, keyframe, detection, at) => {
                let update = "update detections set position = $4
                    where map_key = $1 and keyframe = $2 and detection = $3";
                let query = sql::query(update).bind(map).bind(keyframe.0).bind(detection);
                run(db, query.bind(pack([at.x, at.y, at.z]))).await?;
            }
            Change::AnchorTouched(anchor, version) => {
                let update = "update anchors set version = $3
                    where map_key = $1 and anchor = $2 and version < $3";
                run(db, sql::query(update).bind(map).bind(anchor.0).bind(version as i64)).await?;
            }
            Change::PointSet(session, id, at) => points.push((session, id, at)),
            Change::PointsForgotten(session, ids) => forgotten.extend(ids.iter().map(|id| (session, *id))),
            _ => {}
        }
    }
    let set = points.into_iter().map(|(session, id, at)| (session, id, Some(at)));
    let removed = forgotten.into_iter().map(|(session, id)| (session, id, None));
    point_blocks::change(db, map, set.chain(removed)).await
}
