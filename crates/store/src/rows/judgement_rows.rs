//! Jobs that ask verdicts again: their rows, and the questions that are left.

use revisit_core::domain::ids::{JudgementId, MapId};
use revisit_core::domain::judgement::{
    Asks, Estimate, Judgement, JudgementProgress, PastQuestion, Tally, Workload,
};

use crate::map_key::MapKey;
use crate::sql::run;
use crate::sql::{self, Connection, Row};
use crate::{Store, StoreError};

/// Ended jobs of a map are kept up to this number, oldest out first.
const JOBS_KEPT: i64 = 100;

/// The operation of a crop in a job's position.
const CROP: &str = "crop";

/// The fingerprints of the models at hand: what another one answered is asked again. `None` where no model answers.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Fingerprints {
    /// Of those who read crops.
    pub crops: Option<String>,
    /// Of the judge of texts.
    pub texts: Option<String>,
}

impl Fingerprints {
    /// Returns those of the models that a job concerns.
    pub fn concerned(self, asks: Asks) -> Self {
        Self { crops: self.crops.filter(|_| asks.crops()), texts: self.texts.filter(|_| asks.texts()) }
    }
}

/// Readings that a model could give anew: of crops that can be decoded, and that nobody is about to read anyway.
const OUTDATED_READINGS: &str = "from model_readings r join detections d using (map_key, keyframe, detection)
    where r.map_key = $1 and r.fingerprint <> $2 and r.degraded = 0 and r.source <> 'revisit'
        and d.anchor is not null
        and exists (select 1 from crops c
            where c.map_key = r.map_key and c.keyframe = r.keyframe and c.detection = r.detection)";

impl Store {
    /// Counts the questions that other models or prompts answered than those at hand.
    pub async fn workload(&self, map: MapKey, of: &Fingerprints) -> Result<Workload, StoreError> {
        let mut workload = Workload::default();
        if let Some(fingerprint) = &of.crops {
            let select =
                format!("select d.class, count(*) {OUTDATED_READINGS} group by d.class order by d.class");
            let query = sql::query_as(sqlx::AssertSqlSafe(select)).bind(map).bind(fingerprint);
            workload.crops = query.fetch_all(&self.readers).await?;
        }
        if let Some(fingerprint) = &of.texts {
            let select =
                "select operation, count(*), coalesce(cast(sum(length(a) + length(b)) as bigint), 0) from model_verdicts
                where map_key = $1 and fingerprint <> $2 group by operation order by operation";
            let query = sql::query_as(select).bind(map).bind(fingerprint);
            workload.texts = query.fetch_all(&self.readers).await?;
        }
        Ok(workload)
    }

    /// Returns at most `limit` of the questions that are left after a position: crops first, then texts.
    pub async fn questions_left(
        &self,
        map: MapKey,
        of: &Fingerprints,
        after: Option<&PastQuestion>,
        limit: usize,
    ) -> Result<Vec<PastQuestion>, StoreError> {
        let mut left = Vec::new();
        if let (Some(fingerprint), None | Some(PastQuestion::Crop { .. })) = (&of.crops, after) {
            let (keyframe, detection) = match after {
                Some(PastQuestion::Crop { keyframe, detection }) => {
                    (i64::from(keyframe.0), i64::from(*detection))
                }
                _ => (-1, -1),
            };
            let select = format!(
                "select r.keyframe, r.detection {OUTDATED_READINGS} and (r.keyframe, r.detection) > ($3, $4)
                order by r.keyframe, r.detection limit $5"
            );
            let query = sql::query_as(sqlx::AssertSqlSafe(select)).bind(map).bind(fingerprint);
            let query = query.bind(keyframe).bind(detection).bind(limit);
            let rows: Vec<(_, _)> = query.fetch_all(&self.readers).await?;
            let crop = |(keyframe, detection)| PastQuestion::Crop { keyframe, detection };
            left.extend(rows.into_iter().map(crop));
        }
        if let Some(fingerprint) = &of.texts
            && left.len() < limit
        {
            let (operation, class, a, b) = match after {
                Some(PastQuestion::Texts { function, class, a, b }) => {
                    (function.as_str(), &**class, &**a, &**b)
                }
                _ => ("", "", "", ""),
            };
            let select = "select operation, class, a, b from model_verdicts
                where map_key = $1 and fingerprint <> $2 and (operation, class, a, b) > ($3, $4, $5, $6)
                order by operation, class, a, b limit $7";
            let query = sql::query_as(select).bind(map).bind(fingerprint);
            let query = query.bind(operation).bind(class).bind(a).bind(b).bind(limit - left.len());
            let rows: Vec<(_, _, _, _)> = query.fetch_all(&self.readers).await?;
            let texts = |(function, class, a, b)| PastQuestion::Texts { function, class, a, b };
            left.extend(rows.into_iter().map(texts));
        }
        Ok(left)
    }

    /// Returns a job.
    pub async fn judgement(&self, map: MapKey, id: &JudgementId) -> Result<Option<Judgement>, StoreError> {
        let select = "select * from judgements where map_key = $1 and id = $2";
        let row = sql::query(select).bind(map).bind(id).fetch_optional(&self.readers).await?;
        row.as_ref().map(read).transpose()
    }

    /// Returns the number that the next job of a map gets, and the job that is running, if there is one.
    pub async fn next_judgement(&self, map: MapKey) -> Result<(u64, Option<JudgementId>), StoreError> {
        let select = "select coalesce(max(number), 0) + 1 from judgements where map_key = $1";
        let number = sql::query_scalar(select).bind(map).fetch_one(&self.readers).await?;
        let select = "select id from judgements where map_key = $1 and state = 'running'";
        Ok((number, sql::query_scalar(select).bind(map).fetch_optional(&self.readers).await?))
    }

    /// Returns every job that is running.
    pub async fn running_judgements(&self) -> Result<Vec<(MapId, MapKey, JudgementId)>, StoreError> {
        let select = "select m.id, j.map_key, j.id from judgements j join maps m using (map_key)
            where j.state = 'running' and m.deleted = 0 order by j.map_key";
        Ok(sql::query_as(select).fetch_all(&self.readers).await?)
    }
}

/// Writes a job that begins. The map may be gone by now: then there is nothing to ask.
pub(crate) async fn start(db: &mut Connection, map: MapKey, job: &Judgement) -> Result<(), StoreError> {
    let insert =
        "insert into judgements (map_key, id, number, asks, state, since_version, questions, calls_max,
            cost_max_microusd, changed, unchanged, gone, failed)
        select $1, $2, (select coalesce(max(number), 0) + 1 from judgements where map_key = $1),
            $3, $4, $5, $6, $7, $8, 0, 0, 0, 0
        where exists (select 1 from maps where map_key = $1 and deleted = 0)";
    let Judgement { id, asks, state, since_version, questions, estimate, .. } = job;
    let Estimate { calls, microusd } = *estimate;
    let values = (map, id, *asks, *state, *since_version, *questions, calls, microusd);
    run(db, sql::statement(insert, values)).await?;
    let sweep = "delete from judgements where map_key = $1 and state <> 'running'
        and number <= (select max(number) from judgements where map_key = $1) - $2";
    run(db, sql::statement(sweep, (map, JOBS_KEPT))).await
}

/// Stops a job, unless it has ended.
pub(crate) async fn stop(db: &mut Connection, map: MapKey, id: &JudgementId) -> Result<(), StoreError> {
    let update =
        "update judgements set state = 'stopped' where map_key = $1 and id = $2 and state = 'running'";
    run(db, sql::statement(update, (map, id))).await
}

/// Writes how far a job is, in the transaction that writes the answers.
pub(crate) async fn advance(
    db: &mut Connection,
    map: MapKey,
    progress: &JudgementProgress,
) -> Result<(), StoreError> {
    let Tally { changed, unchanged, gone, failed } = progress.tally;
    let update = "update judgements set changed = changed + $3, unchanged = unchanged + $4, gone = gone + $5,
            failed = failed + $6, state = case when $7 <> 0 and state = 'running' then 'done' else state end
        where map_key = $1 and id = $2";
    let values = (map, &progress.id, changed, unchanged, gone, failed, progress.is_over);
    run(&mut *db, sql::statement(update, values)).await?;
    let Some(position) = &progress.position else { return Ok(()) };
    // Texts that were erased meanwhile are no position: it stays at the question before, and this one is not there to be asked.
    let (operation, crop, texts) = match position {
        PastQuestion::Crop { keyframe, detection } => (CROP, Some((*keyframe, *detection)), None),
        PastQuestion::Texts { function, class, a, b } => (function.as_str(), None, Some((class, a, b))),
    };
    let update =
        "update judgements set at_operation = $3, at_keyframe = $4, at_detection = $5, at_class = $6,
            at_a = $7, at_b = $8
        where map_key = $1 and id = $2 and ($3 = 'crop' or exists (select 1 from model_verdicts
            where map_key = $1 and operation = $3 and class = $6 and a = $7 and b = $8))";
    let (keyframe, detection) = crop.unzip();
    let (class, a, b) = (texts.map(|(class, ..)| class), texts.map(|(_, a, _)| a), texts.map(|(.., b)| b));
    run(db, sql::statement(update, (map, &progress.id, operation, keyframe, detection, class, a, b))).await
}

/// Has the running jobs of a map stand at a question that the map knows: the last one before theirs.
pub(crate) async fn step_back(db: &mut Connection, map: MapKey) -> Result<(), StoreError> {
    let select = "select * from judgements j where map_key = $1 and state = 'running' and at_a is not null
        and not exists (select 1 from model_verdicts v where v.map_key = j.map_key and v.operation = j.at_operation
            and v.class = j.at_class and v.a = j.at_a and v.b = j.at_b)";
    for row in sql::query(select).bind(map).fetch_all(&mut *db).await? {
        let before = "select operation, class, a, b from model_verdicts where map_key = $1
            and (operation, class, a, b) < ($2, $3, $4, $5) order by operation desc, class desc, a desc, b desc limit 1";
        let query = sql::query_as(before).bind(map);
        let query =
            query.bind(row.try_get::<&str, _>("at_operation")?).bind(row.try_get::<&str, _>("at_class")?);
        let query = query.bind(row.try_get::<&str, _>("at_a")?).bind(row.try_get::<&str, _>("at_b")?);
        let found: Option<(String, String, String, String)> = query.fetch_optional(&mut *db).await?;
        let past_crops = found.is_none().then_some(i64::from(u32::MAX));
        let (operation, class, a, b) = match found {
            Some((operation, class, a, b)) => (operation, Some(class), Some(a), Some(b)),
            // All crops are past.
            None => (CROP.to_owned(), None, None, None),
        };
        let update = "update judgements set at_operation = $3, at_class = $4, at_a = $5, at_b = $6,
                at_keyframe = $7, at_detection = $8
            where map_key = $1 and id = $2";
        let id: &str = row.try_get("id")?;
        let values = (map, id, operation, class, a, b, past_crops, past_crops.map(|_| u16::MAX));
        run(&mut *db, sql::statement(update, values)).await?;
    }
    Ok(())
}

fn read(row: &Row) -> Result<Judgement, StoreError> {
    Ok(Judgement {
        id: row.try_get("id")?,
        asks: row.try_get("asks")?,
        state: row.try_get("state")?,
        since_version: row.try_get("since_version")?,
        questions: row.try_get("questions")?,
        estimate: Estimate { calls: row.try_get("calls_max")?, microusd: row.try_get("cost_max_microusd")? },
        tally: Tally {
            changed: row.try_get("changed")?,
            unchanged: row.try_get("unchanged")?,
            gone: row.try_get("gone")?,
            failed: row.try_get("failed")?,
        },
        position: position(row)?,
    })
}

fn position(row: &Row) -> Result<Option<PastQuestion>, StoreError> {
    Ok(match row.try_get::<Option<&str>, _>("at_operation")? {
        None => None,
        Some(CROP) => Some(PastQuestion::Crop {
            keyframe: row.try_get("at_keyframe")?,
            detection: row.try_get("at_detection")?,
        }),
        Some(_) => Some(PastQuestion::Texts {
            function: row.try_get("at_operation")?,
            class: row.try_get("at_class")?,
            a: row.try_get("at_a")?,
            b: row.try_get("at_b")?,
        }),
    })
}
