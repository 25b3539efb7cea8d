//! A map's own rows: its properties and settings, to the database and back.

use revisit_core::domain::ids::MapId;
use revisit_core::domain::key::KeySeq;
use revisit_core::domain::map::{Learned, MapFigures, MapProperties};
use revisit_core::domain::report::MapReport;
use revisit_core::domain::request::Digest;

use crate::columns::bulk_insert::write_rows;
use crate::columns::json;
use crate::jobs::job::Batch;
use crate::map_key::MapKey;
use crate::sql::run;
use crate::sql::{self, Connection, Query, Row};
use crate::{Store, StoreError};

/// The maps that a key made, counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MadeByKey {
    /// Maps that exist.
    pub maps: u64,
    /// Their bytes, with those of their releases.
    pub bytes: u64,
}

/// Adds a map, and returns its key, which no other map had or will have. Its events are numbered from above those of every map that was deleted, so that a client that resumes with a
/// number of a deleted map is recognised.
pub(crate) async fn create(
    db: &mut Connection,
    id: &MapId,
    properties: &MapProperties,
    digest: &Digest,
    owner: Option<KeySeq>,
) -> Result<MapKey, StoreError> {
    let give = "update counters set last = last + 1 where name = 'map' returning last";
    let key: MapKey = sql::query_scalar(give).fetch_one(&mut *db).await?;
    let insert = "insert into maps (map_key, id, description, metric, version, next_keyframe, next_anchor, next_event, digest, owner, learned)
        select $1, $2, '', 0, 1, 0, 0, last + 1, $3, $4, $5 from counters where name = 'event'";
    let learned = json::text(&Learned::default())?;
    run(db, sql::statement(insert, (key, id, digest, owner, learned))).await?;
    run(db, set_properties(key, properties)?).await?;
    Ok(key)
}

/// Notes before a map is deleted that its events' numbers were given; a map without events gave none.
pub(crate) async fn keep_event_numbers(db: &mut Connection, key: MapKey) -> Result<(), StoreError> {
    let update = "update counters set last = m.next_event from maps m
        where counters.name = 'event' and m.map_key = $1 and m.next_event > counters.last
            and (exists (select 1 from events where map_key = $1) or exists (select 1 from erasures where map_key = $1))";
    run(db, sql::statement(update, (key,))).await
}

/// Writes the number that [`keep_event_numbers`] keeps once more, and so a page of the database.
pub(crate) async fn rewrite_event_number(db: &mut Connection) -> Result<(), StoreError> {
    run(db, sql::query("update counters set last = last where name = 'event'")).await
}

/// Writes the versions of maps after a batch of each, with what follows from their facts: their figures.
pub(crate) async fn advance(
    db: &mut Connection,
    batches: impl Iterator<Item = &Batch>,
) -> Result<(), StoreError> {
    let head = "update maps set version = column2, next_keyframe = column3, next_anchor = column4,
        next_event = column5, keyframes = column6, anchors = column7, sessions = column8, loops = column9,
        bytes = column10, memory_bytes = column11, learned = column12 from (";
    let with_learned = batches.map(|batch| Ok((batch, json::text(&batch.learned)?)));
    let rows: Vec<(&Batch, String)> = with_learned.collect::<Result<_, StoreError>>()?;
    write_rows(db, head, ") as given where maps.map_key = column1", &rows, |row, (batch, learned)| {
        let MapFigures { keyframes, anchors, sessions, loops, bytes } = batch.figures;
        row.push_bind(batch.map).push_bind(batch.version);
        row.push_bind(batch.next_keyframe).push_bind(batch.next_anchor).push_bind(batch.next_event);
        row.push_bind(keyframes).push_bind(anchors).push_bind(sessions);
        row.push_bind(loops).push_bind(bytes).push_bind(batch.memory_bytes).push_bind(learned.clone());
    })
    .await
}

/// A map as its row shows it, without its index.
#[derive(Clone, Debug, PartialEq)]
pub struct MapRow {
    /// What a reader is shown.
    pub report: MapReport,
    /// The digest of the body that made it.
    pub digest: Digest,
}

impl Store {
    /// Returns the rows of these maps by name; those that are not there are left out.
    pub async fn map_rows(&self, ids: &[MapId]) -> Result<Vec<MapRow>, StoreError> {
        let select = "select * from maps where id in (select value from json_each($1)) order by id";
        let ids: Vec<&str> = ids.iter().map(MapId::as_str).collect();
        let ids = serde_json::to_string(&ids).map_err(|error| StoreError::Database(error.to_string()))?;
        let rows = sql::query(select).bind(ids).fetch_all(&self.readers).await?;
        rows.iter().map(map_row).collect()
    }

    /// Counts the maps that a key made, and their bytes with those of their releases and of copies that are under way.
    pub async fn made_by(&self, key: KeySeq) -> Result<MadeByKey, StoreError> {
        let select = "select count(case when deleted = 0 and id not like '%/%' then 1 end), cast(coalesce(sum(bytes), 0) as bigint)
            from maps where owner = $1 and deleted <> 1";
        let (maps, bytes) = sql::query_as(select).bind(key).fetch_one(&self.readers).await?;
        Ok(MadeByKey { maps, bytes })
    }

    /// Returns the key of the map that has this name.
    pub async fn map_key(&self, id: &MapId) -> Result<Option<MapKey>, StoreError> {
        let select = "select map_key from maps where id = $1";
        Ok(sql::query_scalar(select).bind(id).fetch_optional(&self.readers).await?)
    }

    /// Returns the version of a map that is on disk; `None` if there is no such map.
    pub async fn version(&self, id: &MapId) -> Result<Option<u64>, StoreError> {
        let select = "select version from maps where id = $1";
        Ok(sql::query_scalar(select).bind(id).fetch_optional(&self.readers).await?)
    }

    /// Returns what a map's index took in memory when it was last written to, in bytes; `None` if there is no such map.
    pub async fn map_memory(&self, id: &MapId) -> Result<Option<u64>, StoreError> {
        let select = "select memory_bytes from maps where id = $1";
        Ok(sql::query_scalar(select).bind(id).fetch_optional(&self.readers).await?)
    }
}

fn map_row(row: &Row) -> Result<MapRow, StoreError> {
    let MapFigures { keyframes, anchors, sessions, loops, bytes } = figures(row)?;
    let report = MapReport {
        id: row.try_get("id")?,
        properties: properties(row)?,
        vocabulary: row.try_get("vocabulary")?,
        version: row.try_get("version")?,
        keyframes: keyframes as usize,
        anchors: anchors as usize,
        sessions: sessions as usize,
        loops: loops as usize,
        bytes,
        learned: learned(row)?,
    };
    Ok(MapRow { report, digest: row.try_get("digest")? })
}

/// Returns the figures that a map's row shows.
pub(crate) fn figures(row: &Row) -> Result<MapFigures, StoreError> {
    Ok(MapFigures {
        keyframes: row.try_get("keyframes")?,
        anchors: row.try_get("anchors")?,
        sessions: row.try_get("sessions")?,
        loops: row.try_get("loops")?,
        bytes: row.try_get("bytes")?,
    })
}

/// Returns what a map's row says that it has learned.
pub(crate) fn learned(row: &Row) -> Result<Learned, StoreError> {
    json::value(row.try_get("learned")?)
}

/// Gives a map these properties, in place of those it had.
pub(crate) fn set_properties(map: MapKey, properties: &MapProperties) -> Result<Query, StoreError> {
    let MapProperties { description, metric, gravity, anchor_classes, code_classes, settings } = properties;
    let update =
        "update maps set description = $2, metric = $3, gravity = $4, anchor_classes = $5, code_classes = $6,
        settings = $7 where map_key = $1";
    let [anchors, codes] = [json::text(anchor_classes)?, json::text(code_classes)?];
    let values = (map, description, *metric, *gravity, anchors, codes, json::text(settings)?);
    Ok(sql::statement(update, values))
}

/// Returns a map's properties.
pub(crate) fn properties(row: &Row) -> Result<MapProperties, StoreError> {
    Ok(MapProperties {
        description: row.try_get("description")?,
        metric: row.try_get("metric")?,
        gravity: row.try_get("gravity")?,
        anchor_classes: json::value(row.try_get("anchor_classes")?)?,
        code_classes: json::value(row.try_get("code_classes")?)?,
        settings: json::value(row.try_get("settings")?)?,
    })
}
