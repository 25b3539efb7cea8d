//! Jobs that ask verdicts again: their rows, and the questions that are left.

use super::decode;
use super::statement::run;
use crate::domain::ids::{JudgementId, KeyframeSeq, MapId};
use crate::domain::judgement::{
    Asks, Estimate, JobState, Judgement, JudgementProgress, PastQuestion, Tally, TextFunction, Workload,
};
use crate::store::commit::job::MapKey;
use crate::store::sql::{self, Connection, Row};
use crate::store::{Store, StoreError};

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
            let rows: Vec<(String, i64)> = query.fetch_all(&self.readers).await?;
            workload.crops = rows.into_iter().map(|(class, count)| (class, count as u64)).collect();
        }
        if let Some(fingerprint) = &of.texts {
            let select =
                "select operation, count(*), coalesce(cast(sum(length(a) + length(b)) as bigint), 0) from model_verdicts
                where map_key = $1 and fingerprint <> $2 group by operation order by operation";
            let query = sql::query_as(select).bind(map).bind(fingerprint);
            let rows: Vec<(String, i64, i64)> = query.fetch_all(&self.readers).await?;
            for (operation, count, chars) in rows {
                workload.texts.push((function(&operation)?, count as u64, chars as u64));
            }
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
            let query = query.bind(keyframe).bind(detection).bind(limit as i64);
            let rows: Vec<(u32, u16)> = query.fetch_all(&self.readers).await?;
            left.extend(rows.into_iter().map(|(keyframe, detection)| PastQuestion::Crop {
                keyframe: KeyframeSeq(keyframe),
                detection,
            }));
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
            let query = query.bind(operation).bind(class).bind(a).bind(b).bind((limit - left.len()) as i64);
            let rows: Vec<(String, String, String, String)> = query.fetch_all(&self.readers).await?;
            for (operation, class, a, b) in rows {
                let function = function(&operation)?;
                left.push(PastQuestion::Texts { function, class: class.into(), a: a.into(), b: b.into() });
            }
        }
        Ok(left)
    }

    /// Returns a job.
    pub async fn judgement(&self, map: MapKey, id: &JudgementId) -> Result<Option<Judgement>, StoreError> {
        let select = "select * from judgements where map_key = $1 and id = $2";
        let row = sql::query(select).bind(map).bind(id.as_str()).fetch_optional(&self.readers).await?;
        row.as_ref().map(read).transpose()
    }

    /// Returns the number that the next job of a map gets, and the job that is running, if there is one.
    pub async fn next_judgement(&self, map: MapKey) -> Result<(u64, Option<JudgementId>), StoreError> {
        let select = "select coalesce(max(number), 0) + 1 from judgements where map_key = $1";
        let number: i64 = sql::query_scalar(select).bind(map).fetch_one(&self.readers).await?;
        let select = "select id from judgements where map_key = $1 and state = 'running'";
        let running: Option<String> =
            sql::query_scalar(select).bind(map).fetch_optional(&self.readers).await?;
        Ok((number as u64, running.map(|id| decode::id(&id)).transpose()?))
    }

    /// Returns every job that is running.
    pub async fn running_judgements(&self) -> Result<Vec<(MapId, MapKey, JudgementId)>, StoreError> {
        let select = "select m.id, j.map_key, j.id from judgements j join maps m using (map_key)
            where j.state = 'running' and m.deleted = 0 order by j.map_key";
        let rows: Vec<(String, MapKey, String)> = sql::query_as(select).fetch_all(&self.readers).await?;
        rows.iter().map(|(map, key, id)| Ok((decode::id(map)?, *key, decode::id(id)?))).collect()
    }
}

/// Writes a job that begins. The map may be gone by now: then there is nothing to ask.
pub(in crate::store) async fn start(
    db: &mut Connection,
    map: MapKey,
    job: &Judgement,
) -> Result<(), StoreError> {
    let insert =
        "insert into judgements (map_key, id, number, asks, state, since_version, questions, calls_max,
            cost_max_microusd, changed, unchanged, gone, failed)
        select $1, $2, (select coalesce(max(number), 0) + 1 from judgements where map_key = $1),
            $3, $4, $5, $6, $7, $8, 0, 0, 0, 0
        where exists (select 1 from maps where map_key = $1 and deleted = 0)";
    let query = sql::query(insert).bind(map).bind(job.id.as_str()).bind(job.asks.as_str());
    let query = query.bind(job.state.as_str()).bind(job.since_version as i64).bind(job.questions as i64);
    run(db, query.bind(job.estimate.calls as i64).bind(job.estimate.microusd as i64)).await?;
    let sweep = "delete from judgements where map_key = $1 and state <> 'running'
        and number <= (select max(number) from judgements where map_key = $1) - $2";
    run(db, sql::query(sweep).bind(map).bind(JOBS_KEPT)).await
}

/// Stops a job, unless it has ended.
pub(in crate::store) async fn stop(
    db: &mut Connection,
    map: MapKey,
    id: &JudgementId,
) -> Result<(), StoreError> {
    let update =
        "update judgements set state = 'stopped' where map_key = $1 and id = $2 and state = 'running'";
    run(db, sql::query(update).bind(map).bind(id.as_str())).await
}

/// Writes how far a job is, in the transaction that writes the answers.
pub(in crate::store) async fn advance(
    db: &mut Connection,
    map: MapKey,
    progress: &JudgementProgress,
) -> Result<(), StoreError> {
    let Tally { changed, unchanged, gone, failed } = progress.tally;
    let update = "update judgements set changed = changed + $3, unchanged = unchanged + $4, gone = gone + $5,
            failed = failed + $6, state = case when $7 <> 0 and state = 'running' then 'done' else state end
        where map_key = $1 and id = $2";
    let query = sql::query(update).bind(map).bind(progress.id.as_str());
    let query = query.bind(changed as i64).bind(unchanged as i64).bind(gone as i64).bind(failed as i64);
    run(&mut *db, query.bind(progress.is_over)).await?;
    let Some(position) = &progress.position else { return Ok(()) };
    // Texts that were erased meanwhile are no position: it stays at the question before, and this one is not there to be asked.
    let (operation, crop, texts) = match position {
        PastQuestion::Crop { keyframe, detection } => (CROP, Some((keyframe.0, *detection)), None),
        PastQuestion::Texts { function, class, a, b } => (function.as_str(), None, Some((class, a, b))),
    };
    let update =
        "update judgements set at_operation = $3, at_keyframe = $4, at_detection = $5, at_class = $6,
            at_a = $7, at_b = $8
        where map_key = $1 and id = $2 and ($3 = 'crop' or exists (select 1 from model_verdicts
            where map_key = $1 and operation = $3 and class = $6 and a = $7 and b = $8))";
    let query = sql::query(update).bind(map).bind(progress.id.as_str()).bind(operation);
    let query = query.bind(crop.map(|(keyframe, _)| keyframe)).bind(crop.map(|(_, detection)| detection));
    let query = query.bind(texts.map(|(class, ..)| &**class)).bind(texts.map(|(_, a, _)| &**a));
    run(db, query.bind(texts.map(|(.., b)| &**b))).await
}

/// Has the running jobs of a map stand at a question that the map knows: the last one before theirs.
pub(in crate::store) async fn step_back(db: &mut Connection, map: MapKey) -> Result<(), StoreError> {
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
        let query = sql::query(update).bind(map).bind(row.try_get::<&str, _>("id")?).bind(operation);
        let query = query.bind(class).bind(a).bind(b).bind(past_crops).bind(past_crops.map(|_| u16::MAX));
        run(&mut *db, query).await?;
    }
    Ok(())
}

fn read(row: &Row) -> Result<Judgement, StoreError> {
    let count = |column: &str| -> Result<u64, StoreError> { Ok(row.try_get::<i64, _>(column)? as u64) };
    let (asks, state): (&str, &str) = (row.try_get("asks")?, row.try_get("state")?);
    Ok(Judgement {
        id: decode::id(row.try_get("id")?)?,
        asks: Asks::from_name(asks).ok_or_else(|| StoreError::corrupt(format!("a judgement of {asks}")))?,
        state: JobState::from_name(state)
            .ok_or_else(|| StoreError::corrupt(format!("a judgement in the state {state}")))?,
        since_version: count("since_version")?,
        questions: count("questions")?,
        estimate: Estimate { calls: count("calls_max")?, microusd: count("cost_max_microusd")? },
        tally: Tally {
            changed: count("changed")?,
            unchanged: count("unchanged")?,
            gone: count("gone")?,
            failed: count("failed")?,
        },
        position: position(row)?,
    })
}

fn position(row: &Row) -> Result<Option<PastQuestion>, StoreError> {
    let text = |column: &str| -> Result<Box<str>, StoreError> { Ok(row.try_get::<&str, _>(column)?.into()) };
    Ok(match row.try_get::<Option<&str>, _>("at_operation")? {
        None => None,
        Some(CROP) => Some(PastQuestion::Crop {
            keyframe: KeyframeSeq(row.try_get("at_keyframe")?),
            detection: row.try_get("at_detection")?,
        }),
        Some(operation) => Some(PastQuestion::Texts {
            function: function(operation)?,
            class: text("at_class")?,
            a: text("at_a")?,
            b: text("at_b")?,
        }),
    })
}

fn function(operation: &str) -> Result<TextFunction, StoreError> {
    TextFunction::from_name(operation).ok_or_else(|| StoreError::corrupt(format!("verdict {operation}")))
}
