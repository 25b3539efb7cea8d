//! Verdicts that newer ones replaced: kept with the version that replaced them, so that older answers stay explained.

use super::statement::run;
use crate::domain::ids::KeyframeSeq;
use crate::domain::judged::ModelVerdict;
use crate::domain::judgement::Replaced;
use crate::store::commit::job::MapKey;
use crate::store::sql::{self, Connection};
use crate::store::{Store, StoreError};

/// Of texts: version, operation, class, both texts, what stood and by whom, what stands and by whom.
type OfTexts = (i64, String, String, String, String, String, String, String, String);

/// Of a crop: version, class, keyframe, detection, what stood and by whom, what stands and by whom.
type OfCrops = (i64, String, String, u16, String, String, String, String);

/// Keeps the verdict that a new one is about to replace, if there is one.
pub(in crate::store) async fn keep_verdict(
    db: &mut Connection,
    (map, version): (MapKey, u64),
    operation: &str,
    verdict: &ModelVerdict,
) -> Result<(), StoreError> {
    let insert = "insert into replaced_verdicts
            (map_key, map_version, operation, class, a, b, level, text, source, reason, fingerprint)
        select map_key, $2, operation, class, a, b, level, text, source, reason, fingerprint from model_verdicts
        where map_key = $1 and operation = $3 and class = $4 and a = $5 and b = $6
        on conflict do nothing";
    let query = sql::query(insert).bind(map).bind(version as i64).bind(operation);
    run(db, query.bind(&*verdict.class).bind(&*verdict.a).bind(&*verdict.b)).await
}

/// Keeps the reading that a new one is about to replace, with its dialogue, if there is one.
pub(in crate::store) async fn keep_reading(
    db: &mut Connection,
    (map, version): (MapKey, u64),
    keyframe: KeyframeSeq,
    detection: u16,
) -> Result<(), StoreError> {
    let reading = "insert into replaced_readings
            (map_key, map_version, keyframe, detection, text, source, described, degraded, fingerprint)
        select map_key, $2, keyframe, detection, text, source, described, degraded, fingerprint from model_readings
        where map_key = $1 and keyframe = $3 and detection = $4
        on conflict do nothing";
    let transcript = "insert into replaced_transcripts
            (map_key, map_version, keyframe, detection, step, speaker, question, answer)
        select map_key, $2, keyframe, detection, step, speaker, question, answer from transcripts
        where map_key = $1 and keyframe = $3 and detection = $4
        on conflict do nothing";
    for insert in [reading, transcript] {
        let query = sql::query(insert).bind(map).bind(version as i64);
        run(&mut *db, query.bind(keyframe.0).bind(detection)).await?;
    }
    Ok(())
}

impl Store {
    /// Returns the verdicts that were replaced by others after a version of the map, the newest first, at most `limit`
    /// of each kind.
    pub async fn replaced(
        &self,
        map: MapKey,
        since_version: u64,
        limit: usize,
    ) -> Result<Vec<Replaced>, StoreError> {
        let since = since_version as i64;
        let select = "select r.map_version, r.operation, r.class, r.a, r.b,
                coalesce(r.text, cast(r.level as text)), r.source, coalesce(v.text, cast(v.level as text)), v.source
            from replaced_verdicts r join model_verdicts v using (map_key, operation, class, a, b)
            where map_key = $1 and r.map_version > $2 and (r.level is distinct from v.level or r.text is distinct from v.text)
            order by r.map_version desc, operation, class, a, b limit $3";
        let query = sql::query_as(select).bind(map).bind(since).bind(limit as i64);
        let of_texts: Vec<OfTexts> = query.fetch_all(&self.readers).await?;
        let select = "select r.map_version, d.class, k.id, r.detection, r.text, r.source, n.text, n.source
            from replaced_readings r
            join model_readings n using (map_key, keyframe, detection)
            join detections d using (map_key, keyframe, detection)
            join keyframes k using (map_key, keyframe)
            where map_key = $1 and r.map_version > $2 and r.text <> n.text
            order by r.map_version desc, keyframe, detection limit $3";
        let query = sql::query_as(select).bind(map).bind(since).bind(limit as i64);
        let of_crops: Vec<OfCrops> = query.fetch_all(&self.readers).await?;
        let of_texts =
            of_texts.into_iter().map(|(version, operation, class, a, b, was, by, is, now_by)| Replaced {
                map_version: version as u64,
                operation,
                class,
                texts: [a, b].into_iter().filter(|text| !text.is_empty()).collect(),
                crop: None,
                before: (was, by),
                after: (is, now_by),
            });
        let of_crops =
            of_crops.into_iter().map(|(version, class, keyframe, detection, was, by, is, now_by)| Replaced {
                map_version: version as u64,
                operation: "describe".to_owned(),
                class,
                texts: Vec::new(),
                crop: Some((keyframe, detection)),
                before: (was, by),
                after: (is, now_by),
            });
        let mut replaced: Vec<Replaced> = of_crops.chain(of_texts).collect();
        replaced.sort_by_key(|verdict| std::cmp::Reverse(verdict.map_version));
        replaced.truncate(limit);
        Ok(replaced)
    }
}
