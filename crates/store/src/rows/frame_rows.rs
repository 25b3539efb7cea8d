//! Frames of a map's sessions, as a row. Sessions go by their numbers, which are given once.

use revisit_core::domain::fleet_frames::FleetFrames;

use crate::StoreError;
use crate::columns::json;
use crate::map_key::MapKey;
use crate::sql::run;
use crate::sql::{self, Connection};

/// Keeps the frames of a map, in place of those of before.
pub(crate) async fn keep(
    db: &mut Connection,
    map: MapKey,
    version: u64,
    frames: &FleetFrames,
) -> Result<(), StoreError> {
    // A map that was deleted meanwhile has none.
    let insert = "insert into fleet_frames (map_key, version, body) select map_key, $2, $3 from maps where map_key = $1
        on conflict (map_key) do update set version = excluded.version, body = excluded.body";
    run(db, sql::statement(insert, (map, version, json::text(frames)?))).await
}

/// Returns the frames of a map and the version that they were computed at, if any were.
pub(crate) async fn kept(db: &mut Connection, map: MapKey) -> Result<Option<(u64, FleetFrames)>, StoreError> {
    let select = "select version, body from fleet_frames where map_key = $1";
    let found: Option<(u64, String)> = sql::query_as(select).bind(map).fetch_optional(db).await?;
    found.map(|(version, body)| Ok((version, json::value(&body)?))).transpose()
}
