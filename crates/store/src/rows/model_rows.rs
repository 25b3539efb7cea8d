//! What models said of a map, every answer that was paid for, and what was spent.

use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

use revisit_core::domain::change::Change;
use revisit_core::domain::ids::{KeyframeSeq, MapId};
use revisit_core::domain::judged::{CropRead, CropReading, Finding, ModelVerdict, TranscriptStep};
use revisit_core::domain::judgement::TextFunction;
use revisit_core::domain::recorded::{NamedDetection, Recorded};

use crate::columns::json;
use crate::jobs::job::Spent;
use crate::map_key::MapKey;
use crate::sql::run;
use crate::sql::{self, Connection, Query, Row};
use crate::{Store, StoreError};

/// Answers are kept up to this number, oldest out first.
const ANSWERS_KEPT: i64 = 1_000_000;

/// Sums of calls.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Totals {
    /// Calls, including failed ones.
    pub calls: i64,
    /// Tokens sent.
    pub input_tokens: i64,
    /// Tokens received.
    pub output_tokens: i64,
    /// Millionths of a US dollar.
    pub cost_microusd: i64,
    /// Questions answered without a call.
    pub cache_hits: i64,
}

impl Totals {
    /// Adds what was spent, or given back.
    pub fn add(&mut self, spent: &Spent) {
        self.calls += spent.calls;
        self.input_tokens += spent.input_tokens;
        self.output_tokens += spent.output_tokens;
        self.cost_microusd += spent.cost_microusd;
    }
}

impl Store {
    /// Returns an answer that was paid for.
    pub async fn answer(&self, key: &[u8; 32]) -> Result<Option<String>, StoreError> {
        let select = "select answer from model_answers where key = $1";
        Ok(sql::query_scalar(select).bind(&key[..]).fetch_optional(&self.readers).await?)
    }

    /// Returns what was spent from this day on, by operation and model.
    pub async fn usage_since(&self, day: i64) -> Result<BTreeMap<(String, String), Totals>, StoreError> {
        let select = "select operation, model, cast(sum(calls) as bigint) as calls, cast(sum(input_tokens) as bigint) as input_tokens,
            cast(sum(output_tokens) as bigint) as output_tokens, cast(sum(cost_microusd) as bigint) as cost_microusd, cast(sum(cache_hits) as bigint) as cache_hits
            from model_usage where day >= $1 group by operation, model order by operation, model";
        let rows = sql::query(select).bind(day).fetch_all(&self.readers).await?;
        let totals = |row: &Row| -> Result<_, StoreError> {
            let totals = Totals {
                calls: row.try_get("calls")?,
                input_tokens: row.try_get("input_tokens")?,
                output_tokens: row.try_get("output_tokens")?,
                cost_microusd: row.try_get("cost_microusd")?,
                cache_hits: row.try_get("cache_hits")?,
            };
            Ok(((row.try_get("operation")?, row.try_get("model")?), totals))
        };
        rows.iter().map(totals).collect()
    }

    /// Returns what was spent on one day for each key: calls, and millionths of a US dollar.
    pub async fn usage_of_keys(&self, day: i64) -> Result<Vec<(i64, i64, i64)>, StoreError> {
        let select = "select key, calls, cost_microusd from key_usage where day = $1 order by key";
        Ok(sql::query_as(select).bind(day).fetch_all(&self.readers).await?)
    }

    /// Returns the maps that hold crops: after a start, a model may have to read some of them. Releases stay as they are.
    pub async fn maps_with_crops(&self) -> Result<Vec<MapId>, StoreError> {
        let select = "select id from maps where deleted = 0 and id not like '%/%'
            and exists (select 1 from crops where crops.map_key = maps.map_key) order by id";
        Ok(sql::query_scalar(select).fetch_all(&self.readers).await?)
    }

    /// Returns the dialogue that led to the reading of a detection's crop.
    pub async fn transcript(
        &self,
        map: MapKey,
        keyframe: KeyframeSeq,
        detection: u16,
    ) -> Result<Vec<TranscriptStep>, StoreError> {
        dialogue(&mut self.readers.acquire().await?, map, (keyframe, detection)).await
    }
}

/// Returns the dialogue that led to the reading of a crop.
pub(crate) async fn dialogue(
    db: &mut Connection,
    map: MapKey,
    (keyframe, detection): (KeyframeSeq, u16),
) -> Result<Vec<TranscriptStep>, StoreError> {
    let select = "select dialogue from model_readings
        where map_key = $1 and keyframe = $2 and detection = $3 and dialogue is not null";
    let query = sql::query_scalar(select).bind(map).bind(keyframe).bind(detection);
    let found: Option<String> = query.fetch_optional(db).await?;
    found.map_or(Ok(Vec::new()), |dialogue| json::value(&dialogue))
}

/// Returns the reading of a crop, with the fingerprint of what made it.
pub(crate) async fn reading_of(
    db: &mut Connection,
    map: MapKey,
    (keyframe, detection): (KeyframeSeq, u16),
) -> Result<Option<(CropReading, Arc<str>)>, StoreError> {
    let select = "select text, source, described, degraded, fingerprint from model_readings
        where map_key = $1 and keyframe = $2 and detection = $3";
    let query = sql::query_as(select).bind(map).bind(keyframe).bind(detection);
    let found: Option<(_, _, _, _, _)> = query.fetch_optional(db).await?;
    Ok(found.map(|(text, source, described, degraded, fingerprint)| {
        (CropReading { text, source, described, degraded }, fingerprint)
    }))
}

/// Returns the verdict that stands in the place of this one: about the same texts.
pub(crate) async fn verdict_about(
    db: &mut Connection,
    map: MapKey,
    ModelVerdict { class, a, b, finding, .. }: &ModelVerdict,
) -> Result<Option<ModelVerdict>, StoreError> {
    let select = "select * from model_verdicts
        where map_key = $1 and operation = $2 and class = $3 and a = $4 and b = $5";
    let query = sql::query(select).bind(map).bind(finding.operation()).bind(&**class).bind(&**a).bind(&**b);
    query.fetch_optional(db).await?.as_ref().map(verdict).transpose()
}

/// Adds the reading of a crop, in the place of the one before.
pub(crate) fn add_reading((map, version): (MapKey, u64), read: &CropRead) -> Result<Query, StoreError> {
    let CropReading { text, source, described, degraded } = &read.reading;
    let dialogue = if read.transcript.is_empty() { None } else { Some(json::text(&read.transcript)?) };
    // What is read anew stays in the place of its first reading.
    let insert = "insert into model_readings
            (map_key, keyframe, detection, text, source, described, degraded, fingerprint, dialogue, version)
        values ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10)
        on conflict (map_key, keyframe, detection) do update
        set text = excluded.text, source = excluded.source, described = excluded.described,
            degraded = excluded.degraded, fingerprint = excluded.fingerprint, dialogue = excluded.dialogue";
    let (keyframe, detection) = (read.keyframe, read.detection);
    let values =
        (map, keyframe, detection, text, source, *described, *degraded, &read.fingerprint, dialogue, version);
    Ok(sql::statement(insert, values))
}

/// Adds a verdict about texts, in the place of the one before.
pub(crate) fn add_verdict((map, version): (MapKey, u64), verdict: &ModelVerdict) -> Query {
    let ModelVerdict { class, a, b, finding, source, reason, fingerprint } = verdict;
    let (level, text) = match finding {
        Finding::Similarity(level) | Finding::Information(level) => (Some(*level), None),
        Finding::Merge(text) => (None, Some(&**text)),
    };
    let insert = "insert into model_verdicts
            (map_key, operation, class, a, b, level, text, source, reason, fingerprint, version)
        values ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11)
        on conflict (map_key, operation, class, a, b) do update
        set level = excluded.level, text = excluded.text, source = excluded.source, reason = excluded.reason,
            fingerprint = excluded.fingerprint";
    let operation = finding.operation();
    sql::statement(insert, (map, operation, class, a, b, level, text, source, reason, fingerprint, version))
}

/// Has no map wait for a model. Releases stay as they are.
pub(crate) async fn forget_away(db: &mut Connection) -> Result<(), StoreError> {
    let update = "update maps set version = version + 1, models_away = 0
        where models_away <> 0 and id not like '%/%'";
    run(db, sql::query(update)).await
}

/// The number of erasures that were ever asked for: those of deleted maps are forgotten.
const ERASURES: &str = "(select cast(coalesce(sum(last), 0) as bigint)
    from (select max(number) as last from erasures group by map_key) as of_maps)";

impl Store {
    /// Returns the erasures so far, for an answer that is asked for now; `None` while one is under way: its map may still hold
    /// the text, and the answer repeat it.
    pub async fn erasures_so_far(&self) -> Result<Option<i64>, StoreError> {
        let select = format!(
            "select case when exists (select 1 from erasures where state = 'removing') then null else {ERASURES} end"
        );
        Ok(sql::query_scalar(sqlx::AssertSqlSafe(select)).fetch_one(&self.readers).await?)
    }
}

/// Keeps a model's answer, unless something was erased since it was asked for: that may be what it speaks of.
pub(crate) async fn keep_answer(
    db: &mut Connection,
    key: &[u8; 32],
    (operation, model): (&str, &str),
    answer: &str,
    erasures: i64,
) -> Result<(), StoreError> {
    let insert = format!(
        "insert into model_answers (key, operation, model, answer) select $1, $2, $3, $4 where {ERASURES} = $5
        on conflict (key) do update set answer = excluded.answer"
    );
    run(db, sql::statement(sqlx::AssertSqlSafe(insert), (key, operation, model, answer, erasures))).await?;
    let sweep = "delete from model_answers where kept <= (select max(kept) from model_answers) - $1";
    run(db, sql::statement(sweep, (ANSWERS_KEPT,))).await
}

pub(crate) async fn spend(db: &mut Connection, spent: &Spent) -> Result<(), StoreError> {
    let Spent { day, operation, model, calls, input_tokens, output_tokens, cost_microusd, cache_hits, key } =
        spent;
    let insert = "insert into model_usage
            (day, operation, model, calls, input_tokens, output_tokens, cost_microusd, cache_hits)
        values ($1, $2, $3, $4, $5, $6, $7, $8)
        on conflict (day, operation, model) do update set
            calls = model_usage.calls + excluded.calls, input_tokens = model_usage.input_tokens + excluded.input_tokens,
            output_tokens = model_usage.output_tokens + excluded.output_tokens,
            cost_microusd = model_usage.cost_microusd + excluded.cost_microusd, cache_hits = model_usage.cache_hits + excluded.cache_hits";
    let values = (day, *operation, model, calls, input_tokens, output_tokens, cost_microusd, cache_hits);
    run(db, sql::statement(insert, values)).await?;
    let Some(key) = *key else { return Ok(()) };
    let insert = "insert into key_usage (day, key, calls, cost_microusd) values ($1, $2, $3, $4)
        on conflict (day, key) do update set
            calls = key_usage.calls + excluded.calls, cost_microusd = key_usage.cost_microusd + excluded.cost_microusd";
    run(db, sql::statement(insert, (day, key, calls, cost_microusd))).await
}

/// Returns what models said of a map, by the version that first brought it.
pub(crate) async fn by_version(db: &mut Connection, map: MapKey) -> Result<Vec<(u64, Recorded)>, StoreError> {
    let mut said = Vec::new();
    let select = "select r.version, k.id, r.detection, r.text, r.source, r.described, r.degraded
        from model_readings r join keyframes k on k.map_key = r.map_key and k.keyframe = r.keyframe
        where r.map_key = $1 order by r.keyframe, r.detection";
    let rows: Vec<(_, _, _, _, _, _, _)> = sql::query_as(select).bind(map).fetch_all(&mut *db).await?;
    for (version, keyframe, number, text, source, described, degraded) in rows {
        let detection = NamedDetection { keyframe, number };
        let reading = CropReading { text, source, described, degraded };
        said.push((version, Recorded::CropRead { detection, reading }));
    }
    let select = "select * from model_verdicts where map_key = $1 order by operation, class, a, b";
    for row in sql::query(select).bind(map).fetch_all(&mut *db).await? {
        said.push((row.try_get("version")?, Recorded::Judged(verdict(&row)?)));
    }
    said.sort_by_key(|(version, _)| *version);
    Ok(said)
}

/// Returns the verdicts about a map's texts, and whether it waits for a model.
pub(crate) async fn verdicts(db: &mut Connection, map: MapKey) -> Result<Vec<Change>, StoreError> {
    let mut changes = Vec::new();
    let select = "select operation, class, a, b, level, text, source, reason, fingerprint from model_verdicts
        where map_key = $1";
    for row in sql::query(select).bind(map).fetch_all(&mut *db).await? {
        changes.push(Change::Judged(Box::new(verdict(&row)?)));
    }
    let select = "select models_away <> 0 from maps where map_key = $1";
    if sql::query_scalar(select).bind(map).fetch_one(&mut *db).await? {
        changes.push(Change::ModelAway(true));
    }
    Ok(changes)
}

fn verdict(row: &Row) -> Result<ModelVerdict, StoreError> {
    let finding = match row.try_get("operation")? {
        TextFunction::Similarity => Finding::Similarity(row.try_get("level")?),
        TextFunction::Information => Finding::Information(row.try_get("level")?),
        TextFunction::Merge => Finding::Merge(row.try_get("text")?),
    };
    Ok(ModelVerdict {
        class: row.try_get("class")?,
        a: row.try_get("a")?,
        b: row.try_get("b")?,
        finding,
        source: row.try_get("source")?,
        reason: row.try_get("reason")?,
        fingerprint: row.try_get("fingerprint")?,
    })
}

/// Returns what models made of a map's crops.
pub(crate) async fn readings(
    db: &mut Connection,
    map: MapKey,
) -> Result<HashMap<(u32, u16), CropReading>, StoreError> {
    let select = "select keyframe, detection, text, source, described, degraded from model_readings
        where map_key = $1";
    let rows: Vec<(_, _, _, _, _, _)> = sql::query_as(select).bind(map).fetch_all(db).await?;
    let reading = |(keyframe, detection, text, source, described, degraded)| {
        ((keyframe, detection), CropReading { text, source, described, degraded })
    };
    Ok(rows.into_iter().map(reading).collect())
}
