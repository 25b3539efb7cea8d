//! Rows that a map's settings let go of.

use revisit_core::domain::change::ForgottenParts;
use revisit_core::domain::ids::{AnchorSeq, KeyframeSeq};

use crate::map_key::MapKey;
use crate::sql::run;
use crate::sql::{self, Connection};
use crate::{Store, StoreError};

/// Keyframes that one look finds.
const FOUND_AT_ONCE: i64 = 256;

/// Deletes parts of a keyframe.
pub(crate) async fn forget_parts(
    db: &mut Connection,
    map: MapKey,
    parts: &ForgottenParts,
) -> Result<(), StoreError> {
    let keyframe = parts.keyframe;
    if parts.features {
        let delete = "delete from keyframe_features where map_key = $1 and keyframe = $2";
        run(db, sql::statement(delete, (map, keyframe))).await?;
    }
    if parts.global_descriptor {
        let update =
            "update keyframes set global_model = null, global_encoding = null, global_descriptor = null
            where map_key = $1 and keyframe = $2";
        run(db, sql::statement(update, (map, keyframe))).await?;
    }
    for (detection, _) in &parts.crops {
        let delete = "delete from crops where map_key = $1 and keyframe = $2 and detection = $3";
        run(db, sql::statement(delete, (map, keyframe, *detection))).await?;
    }
    for table in ["keyframes", "keyframe_points"] {
        let update = format!(
            "update {table} set bytes = case when bytes > $3 then bytes - $3 else 0 end where map_key = $1 and keyframe = $2"
        );
        run(db, sql::statement(sqlx::AssertSqlSafe(update), (map, keyframe, parts.bytes))).await?;
    }
    Ok(())
}

/// Deletes the record of what models said and what others replaced since.
pub(crate) async fn forget_dialogues(db: &mut Connection, map: MapKey) -> Result<(), StoreError> {
    let update = "update model_readings set dialogue = null where map_key = $1 and dialogue is not null";
    run(db, sql::statement(update, (map,))).await?;
    run(db, sql::statement("delete from versions where map_key = $1 and part < 0", (map,))).await
}

impl Store {
    /// Returns keyframes that were stored before this second and still have features or a global descriptor, with what these take in
    /// bytes, as `keyframes.bytes` counts it.
    pub async fn old_descriptors(
        &self,
        map: MapKey,
        before_sec: i64,
    ) -> Result<Vec<ForgottenParts>, StoreError> {
        /// u, v and angle, the octave, and the map point.
        const KEYPOINT: i64 = 4 * 8 + 1;
        let select = "select k.keyframe, f.keyframe is not null, k.global_descriptor is not null,
                coalesce(length(f.descriptors) + length(f.descriptors) / f.descriptor_bytes * $3, 0),
                coalesce(length(k.global_descriptor) + length(k.global_model) + length(k.global_encoding), 0)
            from keyframes k left join keyframe_features f using (map_key, keyframe)
            where k.map_key = $1 and k.stored_sec < $2
                and (f.keyframe is not null or k.global_descriptor is not null)
            order by k.keyframe limit $4";
        let query = sql::query_as(select).bind(map).bind(before_sec).bind(KEYPOINT).bind(FOUND_AT_ONCE);
        let rows: Vec<(_, _, _, u64, u64)> = query.fetch_all(&self.readers).await?;
        let parts = |(keyframe, features, global_descriptor, of_features, of_global)| {
            let bytes = of_features + of_global;
            ForgottenParts { keyframe, features, global_descriptor, crops: Vec::new(), bytes }
        };
        Ok(rows.into_iter().map(parts).collect())
    }

    /// Returns crops that nobody will read: those that were read, that came with a text, or all where no model reads crops.
    pub async fn read_crops(
        &self,
        map: MapKey,
        no_model_reads: bool,
    ) -> Result<Vec<ForgottenParts>, StoreError> {
        let select = "select c.keyframe, c.detection, d.anchor, length(c.bytes)
            from crops c join detections d using (map_key, keyframe, detection)
            where c.map_key = $1 and ($2 <> 0 or d.anchor is null or d.text is not null or d.description is not null
                or exists (select 1 from model_readings r where r.map_key = c.map_key
                    and r.keyframe = c.keyframe and r.detection = c.detection and r.degraded = 0))
            order by c.keyframe, c.detection limit $3";
        let query = sql::query_as(select).bind(map).bind(no_model_reads).bind(FOUND_AT_ONCE);
        let rows: Vec<(KeyframeSeq, u16, Option<AnchorSeq>, u64)> = query.fetch_all(&self.readers).await?;
        let mut found: Vec<ForgottenParts> = Vec::new();
        for (keyframe, detection, anchor, bytes) in rows {
            if found.last().is_none_or(|parts| parts.keyframe != keyframe) {
                let (features, global_descriptor) = (false, false);
                let crops = Vec::new();
                found.push(ForgottenParts { keyframe, features, global_descriptor, crops, bytes: 0 });
            }
            if let Some(parts) = found.last_mut() {
                parts.crops.push((detection, anchor));
                parts.bytes += bytes;
            }
        }
        Ok(found)
    }

    /// Whether anything is on record of what models said beside what is in force.
    pub async fn has_dialogues(&self, map: MapKey) -> Result<bool, StoreError> {
        let select =
            "select exists (select 1 from model_readings where map_key = $1 and dialogue is not null)
            or exists (select 1 from versions where map_key = $1 and part < 0)";
        Ok(sql::query_scalar(select).bind(map).fetch_one(&self.readers).await?)
    }

    /// Returns which of these keyframes were stored before this second.
    pub async fn stored_before(
        &self,
        map: MapKey,
        before_sec: i64,
        from: KeyframeSeq,
    ) -> Result<Vec<KeyframeSeq>, StoreError> {
        let select = "select keyframe from keyframes
            where map_key = $1 and keyframe >= $2 and stored_sec < $3 order by keyframe limit 10000";
        let query = sql::query_scalar(select).bind(map).bind(from).bind(before_sec);
        Ok(query.fetch_all(&self.readers).await?)
    }
}
