//! Signs that change, as rows: to the database and back.

use super::statement::run;
use crate::domain::change::{Change, MissedSign, MovedObservation};
use crate::domain::ids::{AnchorSeq, KeyframeSeq};
use crate::store::StoreError;
use crate::store::commit::job::MapKey;
use crate::store::sql::{self, Connection};

/// Has a detection feed another anchor.
pub(in crate::store) async fn move_observation(
    db: &mut Connection,
    map: MapKey,
    MovedObservation { keyframe, detection, to, .. }: &MovedObservation,
) -> Result<(), StoreError> {
    let update = "update detections set anchor = $4 where map_key = $1 and keyframe = $2 and detection = $3";
    run(db, sql::query(update).bind(map).bind(keyframe.0).bind(*detection).bind(to.0)).await
}

/// Adds a passage that missed a sign.
pub(in crate::store) async fn miss(
    db: &mut Connection,
    map: MapKey,
    MissedSign { anchor, keyframe, other }: &MissedSign,
) -> Result<(), StoreError> {
    let insert = "insert into missed_signs (map_key, anchor, keyframe, other) values ($1, $2, $3, $4)
        on conflict (map_key, anchor, keyframe) do update set other = excluded.other";
    let query = sql::query(insert).bind(map).bind(anchor.0).bind(keyframe.0);
    run(db, query.bind(other.map(|other| other.0))).await
}

/// Withdraws the passages that missed a sign.
pub(in crate::store) async fn withdraw_misses(
    db: &mut Connection,
    map: MapKey,
    anchor: AnchorSeq,
) -> Result<(), StoreError> {
    let delete = "delete from missed_signs where map_key = $1 and anchor = $2";
    run(db, sql::query(delete).bind(map).bind(anchor.0)).await
}

/// Retires a sign.
pub(in crate::store) async fn retire(
    db: &mut Connection,
    map: MapKey,
    anchor: AnchorSeq,
    other: Option<AnchorSeq>,
) -> Result<(), StoreError> {
    let insert = "insert into retired_signs (map_key, anchor, replaced_by) values ($1, $2, $3)
        on conflict (map_key, anchor) do update set replaced_by = excluded.replaced_by";
    run(db, sql::query(insert).bind(map).bind(anchor.0).bind(other.map(|other| other.0))).await
}

/// Takes a sign's retirement back.
pub(in crate::store) async fn restore(
    db: &mut Connection,
    map: MapKey,
    anchor: AnchorSeq,
) -> Result<(), StoreError> {
    let delete = "delete from retired_signs where map_key = $1 and anchor = $2";
    run(db, sql::query(delete).bind(map).bind(anchor.0)).await
}

/// Returns the signs of a map that passages missed, or that are retired.
pub(in crate::store) async fn all(db: &mut Connection, map: MapKey) -> Result<Vec<Change>, StoreError> {
    let select = "select anchor, keyframe, other from missed_signs where map_key = $1";
    let rows: Vec<(u32, u32, Option<u32>)> = sql::query_as(select).bind(map).fetch_all(&mut *db).await?;
    let missed = rows.into_iter().map(|(anchor, keyframe, other)| {
        let (anchor, keyframe, other) = (AnchorSeq(anchor), KeyframeSeq(keyframe), other.map(AnchorSeq));
        Change::SignMissed(MissedSign { anchor, keyframe, other })
    });
    let select = "select anchor, replaced_by from retired_signs where map_key = $1";
    let rows: Vec<(u32, Option<u32>)> = sql::query_as(select).bind(map).fetch_all(db).await?;
    let retired =
        rows.into_iter().map(|(anchor, other)| Change::SignRetired(AnchorSeq(anchor), other.map(AnchorSeq)));
    Ok(missed.chain(retired).collect())
}
