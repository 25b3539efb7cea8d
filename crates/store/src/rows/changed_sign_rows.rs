//! Signs that change, as rows: to the database and back.

use revisit_core::domain::change::{Change, MissedSign, MovedObservation};
use revisit_core::domain::ids::AnchorSeq;

use crate::StoreError;
use crate::map_key::MapKey;
use crate::sql::{self, Connection, Query};

/// Has a detection feed another anchor.
pub(crate) fn move_observation(map: MapKey, moved: &MovedObservation) -> Query {
    let update = "update detections set anchor = $4 where map_key = $1 and keyframe = $2 and detection = $3";
    sql::statement(update, (map, moved.keyframe, moved.detection, moved.to))
}

/// Adds a passage that missed a sign.
pub(crate) fn miss(map: MapKey, missed: &MissedSign) -> Query {
    let insert = "insert into missed_signs (map_key, anchor, keyframe, other) values ($1, $2, $3, $4)
        on conflict (map_key, anchor, keyframe) do update set other = excluded.other";
    sql::statement(insert, (map, missed.anchor, missed.keyframe, missed.other))
}

/// Withdraws the passages that missed a sign.
pub(crate) fn withdraw_misses(map: MapKey, anchor: AnchorSeq) -> Query {
    sql::statement("delete from missed_signs where map_key = $1 and anchor = $2", (map, anchor))
}

/// Retires a sign.
pub(crate) fn retire(map: MapKey, anchor: AnchorSeq, other: Option<AnchorSeq>) -> Query {
    let insert = "insert into retired_signs (map_key, anchor, replaced_by) values ($1, $2, $3)
        on conflict (map_key, anchor) do update set replaced_by = excluded.replaced_by";
    sql::statement(insert, (map, anchor, other))
}

/// Takes a sign's retirement back.
pub(crate) fn restore(map: MapKey, anchor: AnchorSeq) -> Query {
    sql::statement("delete from retired_signs where map_key = $1 and anchor = $2", (map, anchor))
}

/// Returns the signs of a map that passages missed, or that are retired.
pub(crate) async fn all(db: &mut Connection, map: MapKey) -> Result<Vec<Change>, StoreError> {
    let select = "select anchor, keyframe, other from missed_signs where map_key = $1";
    let rows: Vec<(_, _, _)> = sql::query_as(select).bind(map).fetch_all(&mut *db).await?;
    let missed = |(anchor, keyframe, other)| Change::SignMissed(MissedSign { anchor, keyframe, other });
    let missed = rows.into_iter().map(missed);
    let select = "select anchor, replaced_by from retired_signs where map_key = $1";
    let rows: Vec<(_, _)> = sql::query_as(select).bind(map).fetch_all(db).await?;
    Ok(missed.chain(rows.into_iter().map(|(anchor, other)| Change::SignRetired(anchor, other))).collect())
}
