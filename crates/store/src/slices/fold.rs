//! Folding: deferred changes are brought into the rows that they change, in slices.
//!
//! Each step writes a part and notes in the map's row how far it has come, in the transaction of its slice.

use revisit_core::domain::change::Change;

use crate::StoreError;
use crate::loading::deferred::{self, Waiting};
use crate::log::log_rows::COUNTS;
use crate::log::parts::Kind;
use crate::map_key::MapKey;
use crate::rows::{keyframe_rows, point_blocks};
use crate::sql::run;
use crate::sql::{self, Connection};

/// The cost of a part beside its changes, as so many of them.
const PART_CHANGES: usize = 4;

/// More versions than this are folded as fast as clients write.
const VERSIONS_BEHIND: i64 = 500;

/// Returns the first of these maps that has deferred changes.
pub(crate) async fn next_map(db: &mut Connection, of: &[MapKey]) -> Result<Option<MapKey>, StoreError> {
    let select = "select map_key from maps where waits_version is not null and deleted = 0
        and map_key in (select cast(value as bigint) from json_each($1)) order by map_key limit 1";
    Ok(sql::query_scalar(select).bind(serde_json::json!(of).to_string()).fetch_optional(db).await?)
}

/// Folds about this many changes of a map, or of any, in the caller's transaction. Returns whether there were any.
pub(crate) async fn fold(
    db: &mut Connection,
    of: Option<MapKey>,
    changes: usize,
) -> Result<bool, StoreError> {
    let mut left = changes;
    while left > 0 {
        let map = match of {
            Some(map) => Some(map),
            None => first_map(db).await?,
        };
        let Some(map) = map else { break };
        let Some(waiting) = deferred::next(db, map).await? else { break };
        left = left.saturating_sub(waiting.entry.changes.len() + PART_CHANGES);
        fold_part(db, map, waiting).await?;
    }
    Ok(left < changes)
}

/// Returns a map that is whole and has deferred changes.
async fn first_map(db: &mut Connection) -> Result<Option<MapKey>, StoreError> {
    let select =
        "select map_key from maps where waits_version is not null and deleted = 0 order by map_key limit 1";
    Ok(sql::query_scalar(select).fetch_optional(db).await?)
}

/// Whether so many versions wait that slices fall behind the clients that add them.
pub(crate) async fn is_behind(db: &mut Connection) -> Result<bool, StoreError> {
    let select = "select count(*) from (select 1 from maps m join versions v using (map_key)
        where m.waits_version is not null and v.version >= m.waits_version and v.part = 0 limit $1) as waiting";
    let count: i64 = sql::query_scalar(select).bind(VERSIONS_BEHIND + 1).fetch_one(db).await?;
    Ok(count > VERSIONS_BEHIND)
}

/// Folds a part, and notes which one is next.
async fn fold_part(db: &mut Connection, map: MapKey, part: Waiting) -> Result<(), StoreError> {
    let (version, number) = part.at;
    write(db, map, part.entry.changes.into_iter().map(std::borrow::Cow::into_owned)).await?;
    if part.kind != Kind::Moved.as_str() {
        let delete = "delete from versions where map_key = $1 and version = $2 and part = $3";
        run(db, sql::statement(delete, (map, version, number))).await?;
    }
    let select = format!(
        "select version, part from versions v where map_key = $1 and (version, part) > ($2, $3)
            and part > 0 and {COUNTS} order by version, part limit 1"
    );
    let next = sql::query_as(sqlx::AssertSqlSafe(select)).bind(map).bind(version).bind(number);
    let next: Option<(i64, i64)> = next.fetch_optional(&mut *db).await?;
    if next.is_none_or(|(of, _)| of != version) {
        // It made the others count, and said nothing itself.
        let delete =
            "delete from versions where map_key = $1 and version = $2 and part = 0 and kind = 'passing'
            and not exists (select 1 from versions o where o.map_key = $1 and o.version = $2 and o.part > 0)";
        run(db, sql::statement(delete, (map, version))).await?;
    }
    let update = "update maps set waits_version = $2, waits_part = $3 where map_key = $1";
    let (next_version, next_part) = next.unzip();
    run(db, sql::statement(update, (map, next_version, next_part))).await
}

/// Writes changes of one kind to their rows. What they change may be gone meanwhile.
async fn write(
    db: &mut Connection,
    map: MapKey,
    changes: impl Iterator<Item = Change>,
) -> Result<(), StoreError> {
    let (mut points, mut forgotten) = (Vec::new(), Vec::new());
    for change in changes {
        match change {
            Change::PoseSet(keyframe, pose) => {
                run(db, keyframe_rows::set_pose(map, keyframe, &pose)).await?;
            }
            Change::AnchorTouched(anchor, version) => {
                let update = "update anchors set version = $3
                    where map_key = $1 and anchor = $2 and version < $3";
                run(db, sql::statement(update, (map, anchor, version))).await?;
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
