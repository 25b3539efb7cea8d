//! A map's own rows: its properties and settings, to the database and back.

use std::collections::BTreeMap;

use super::blob::gravity_blob;
use super::bulk_insert::write_rows;
use super::decode::{self, digest};
use super::json;
use super::statement::run;
use crate::domain::ids::MapId;
use crate::domain::key::KeySeq;
use crate::domain::map::{Learned, MapFigures, MapProperties};
use crate::domain::method::Method;
use crate::domain::report::MapReport;
use crate::domain::request::Digest;
use crate::domain::settings::{SettingKind, SettingValue, Settings};
use crate::semantics::Patterns;
use crate::store::commit::job::{Batch, MapKey};
use crate::store::sql::{self, Connection, Row};
use crate::store::{Store, StoreError};

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
pub(in crate::store) async fn create(
    db: &mut Connection,
    id: &MapId,
    properties: &MapProperties,
    digest: &Digest,
    owner: Option<KeySeq>,
) -> Result<MapKey, StoreError> {
    let give = "update map_keys set last = last + 1 returning last";
    let key: MapKey = sql::query_scalar(give).fetch_one(&mut *db).await?;
    let insert = "insert into maps (map_key, id, description, metric, version, next_keyframe, next_anchor, next_event, digest, owner, learned)
        select $1, $2, '', 0, 1, 0, 0, last + 1, $3, $4, $5 from event_numbers";
    let query = sql::query(insert).bind(key).bind(id.as_str()).bind(&digest[..]);
    run(db, query.bind(owner.map(|owner| owner.0)).bind(json::text(&Learned::default())?)).await?;
    set_properties(db, key, properties).await?;
    Ok(key)
}

/// Notes before a map is deleted that its events' numbers were given; a map without events gave none.
pub(in crate::store) async fn keep_event_numbers(db: &mut Connection, key: MapKey) -> Result<(), StoreError> {
    let update = "update event_numbers set last = m.next_event from maps m
        where m.map_key = $1 and m.next_event > event_numbers.last
            and (exists (select 1 from events where map_key = $1) or exists (select 1 from erasures where map_key = $1))";
    run(db, sql::query(update).bind(key)).await
}

/// Writes the number that [`keep_event_numbers`] keeps once more, and so a page of the database.
pub(in crate::store) async fn rewrite_event_number(db: &mut Connection) -> Result<(), StoreError> {
    run(db, sql::query("update event_numbers set last = last")).await
}

/// Writes the versions of maps after a batch of each, with what follows from their facts: their figures.
pub(in crate::store) async fn advance(
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
        row.push_bind(batch.map).push_bind(batch.version as i64);
        row.push_bind(batch.next_keyframe.0)
            .push_bind(batch.next_anchor.0)
            .push_bind(batch.next_event as i64);
        row.push_bind(keyframes as i64).push_bind(anchors as i64).push_bind(sessions as i64);
        row.push_bind(loops as i64).push_bind(bytes as i64).push_bind(batch.memory_bytes as i64);
        row.push_bind(learned.clone());
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

/// The lists of a map's classes: those of which anchors are made, and those whose texts are codes.
const ANCHOR: &str = "anchor";
const CODE: &str = "code";

impl Store {
    /// Returns the rows of these maps by name; those that are not there are left out. One query, of the row of each map and
    /// the few settings and classes beside it.
    pub async fn map_rows(&self, ids: &[MapId]) -> Result<Vec<MapRow>, StoreError> {
        let select = "select m.*,
                (select json_group_object(s.name, s.value) from map_settings s where s.map_key = m.map_key) as chosen,
                (select json_group_array(c.class) from map_classes c where c.map_key = m.map_key and c.list = 'anchor')
                    as anchor_classes,
                (select json_group_array(c.class) from map_classes c where c.map_key = m.map_key and c.list = 'code')
                    as code_classes
            from maps m where m.id in (select value from json_each($1)) order by m.id";
        let ids: Vec<&str> = ids.iter().map(MapId::as_str).collect();
        let ids = serde_json::to_string(&ids).map_err(|error| StoreError::Database(error.to_string()))?;
        let rows = sql::query(select).bind(ids).fetch_all(&self.readers).await?;
        rows.iter().map(map_row).collect()
    }

    /// Counts the maps that a key made, and their bytes with those of their releases and of copies that are under way.
    pub async fn made_by(&self, key: KeySeq) -> Result<MadeByKey, StoreError> {
        let select = "select count(case when deleted = 0 and id not like '%/%' then 1 end), cast(coalesce(sum(bytes), 0) as bigint)
            from maps where owner = $1 and deleted <> 1";
        let (maps, bytes): (i64, i64) = sql::query_as(select).bind(key.0).fetch_one(&self.readers).await?;
        Ok(MadeByKey { maps: maps.unsigned_abs(), bytes: bytes.unsigned_abs() })
    }

    /// Returns the key of the map that has this name.
    pub async fn map_key(&self, id: &MapId) -> Result<Option<MapKey>, StoreError> {
        let select = "select map_key from maps where id = $1";
        Ok(sql::query_scalar(select).bind(id.as_str()).fetch_optional(&self.readers).await?)
    }

    /// Returns the version of a map that is on disk; `None` if there is no such map.
    pub async fn version(&self, id: &MapId) -> Result<Option<u64>, StoreError> {
        let select = "select version from maps where id = $1";
        let found: Option<i64> =
            sql::query_scalar(select).bind(id.as_str()).fetch_optional(&self.readers).await?;
        Ok(found.map(i64::unsigned_abs))
    }

    /// Returns what a map's index took in memory when it was last written to, in bytes; `None` if there is no such map.
    pub async fn map_memory(&self, id: &MapId) -> Result<Option<u64>, StoreError> {
        let select = "select memory_bytes from maps where id = $1";
        let found: Option<i64> =
            sql::query_scalar(select).bind(id.as_str()).fetch_optional(&self.readers).await?;
        Ok(found.map(i64::unsigned_abs))
    }
}

fn map_row(row: &Row) -> Result<MapRow, StoreError> {
    let unread = |error: serde_json::Error| StoreError::corrupt(error.to_string());
    let chosen: BTreeMap<String, String> = serde_json::from_str(row.try_get("chosen")?).map_err(unread)?;
    let classes = |list: &str| {
        let mut classes: Vec<String> = serde_json::from_str(row.try_get(list)?).map_err(unread)?;
        classes.sort_unstable();
        Ok::<_, StoreError>(classes)
    };
    let MapFigures { keyframes, anchors, sessions, loops, bytes } = figures(row)?;
    let report = MapReport {
        id: decode::id(row.try_get::<&str, _>("id")?)?,
        properties: MapProperties {
            description: row.try_get("description")?,
            metric: row.try_get("metric")?,
            gravity: decode::gravity(row)?,
            anchor_classes: classes("anchor_classes")?,
            code_classes: classes("code_classes")?,
            settings: settings(chosen)?,
        },
        vocabulary: row.try_get("vocabulary")?,
        version: row.try_get::<i64, _>("version")? as u64,
        keyframes: keyframes as usize,
        anchors: anchors as usize,
        sessions: sessions as usize,
        loops: loops as usize,
        bytes,
        learned: learned(row)?,
    };
    Ok(MapRow { report, digest: digest(row)? })
}

/// Returns the figures that a map's row shows.
pub(in crate::store) fn figures(row: &Row) -> Result<MapFigures, StoreError> {
    let figure = |name: &str| Ok::<_, StoreError>(row.try_get::<i64, _>(name)? as u64);
    Ok(MapFigures {
        keyframes: figure("keyframes")?,
        anchors: figure("anchors")?,
        sessions: figure("sessions")?,
        loops: figure("loops")?,
        bytes: figure("bytes")?,
    })
}

/// Returns what a map's row says that it has learned.
pub(in crate::store) fn learned(row: &Row) -> Result<Learned, StoreError> {
    json::value(row.try_get("learned")?)
}

/// Returns a map's properties, in place of those it had.
pub(in crate::store) async fn set_properties(
    db: &mut Connection,
    map: MapKey,
    properties: &MapProperties,
) -> Result<(), StoreError> {
    let update = "update maps set description = $2, metric = $3, gravity = $4 where map_key = $1";
    let query = sql::query(update).bind(map).bind(&properties.description).bind(properties.metric);
    run(db, query.bind(properties.gravity.map(gravity_blob))).await?;
    run(db, sql::query("delete from map_classes where map_key = $1").bind(map)).await?;
    let anchored = properties.anchor_classes.iter().map(|class| (ANCHOR, class));
    for (list, class) in anchored.chain(properties.code_classes.iter().map(|class| (CODE, class))) {
        let insert = "insert into map_classes (map_key, list, class) values ($1, $2, $3)";
        run(db, sql::query(insert).bind(map).bind(list).bind(class)).await?;
    }
    run(db, sql::query("delete from map_settings where map_key = $1").bind(map)).await?;
    for (name, value) in chosen(&properties.settings) {
        let insert = "insert into map_settings (map_key, name, value) values ($1, $2, $3)";
        run(db, sql::query(insert).bind(map).bind(name).bind(value)).await?;
    }
    Ok(())
}

/// Returns the settings that differ from their defaults, as text.
pub(in crate::store) fn chosen(settings: &Settings) -> impl Iterator<Item = (&'static str, String)> {
    settings.changed().map(|(name, value)| (name, setting_text(value)))
}

/// Returns a setting as text; numbers in the shortest form that reads back to the same bits.
fn setting_text(value: SettingValue) -> String {
    match value {
        SettingValue::Number(number) => format!("{number:?}"),
        SettingValue::Count(count) => count.to_string(),
        SettingValue::Switch(switch) => switch.to_string(),
        SettingValue::Choice(name) => name.to_owned(),
        SettingValue::Patterns(patterns) => serde_json::json!(patterns.texts()).to_string(),
    }
}

/// Returns a map's properties, as its row and its settings say.
pub(in crate::store) async fn properties(
    db: &mut Connection,
    key: MapKey,
    row: &Row,
) -> Result<MapProperties, StoreError> {
    let stored: Vec<(String, String)> =
        sql::query_as("select name, value from map_settings where map_key = $1")
            .bind(key)
            .fetch_all(&mut *db)
            .await?;
    Ok(MapProperties {
        description: row.try_get("description")?,
        metric: row.try_get("metric")?,
        gravity: decode::gravity(row)?,
        anchor_classes: classes(db, key, ANCHOR).await?,
        code_classes: classes(db, key, CODE).await?,
        settings: settings(stored)?,
    })
}

/// Returns a list of a map's classes, sorted.
async fn classes(db: &mut Connection, key: MapKey, list: &str) -> Result<Vec<String>, StoreError> {
    let select = "select class from map_classes where map_key = $1 and list = $2 order by class";
    Ok(sql::query_scalar(select).bind(key).bind(list).fetch_all(db).await?)
}

/// Settings of earlier versions, which decide nothing any more: rows of them are passed over.
const FORMER_SETTINGS: [&str; 19] = [
    "aligned_anchors",
    "anchor_map_min_distance_m",
    "company",
    "contradiction_veto",
    "covisibility_max_gap_s",
    "distinctive_weights",
    "geometry_alone_min_inliers",
    "geometry_resection",
    "global_channel",
    "near_miss_neighbours",
    "neighbours_vouch",
    "odometry_slack_m",
    "one_to_one",
    "returns_close_once",
    "rival_min_ratio",
    "single_text_needs_witness",
    "tracked_loops_need_geometry",
    "twin_guard",
    "undecided_min_score_ratio",
];

/// Returns the settings in force where these were chosen.
pub(in crate::store) fn settings(
    chosen: impl IntoIterator<Item = (String, String)>,
) -> Result<Settings, StoreError> {
    let mut settings = Settings::default();
    for (name, text) in chosen {
        // Before methods were stored, this switch told the paper's.
        if (name.as_str(), text.as_str()) == ("one_to_one", "false") {
            settings.method = Method::Paper;
        }
        if FORMER_SETTINGS.contains(&name.as_str()) {
            continue;
        }
        let value =
            setting(&name, &text).ok_or_else(|| StoreError::corrupt(format!("setting {name} = {text}")))?;
        settings
            .set(&name, value)
            .map_err(|error| StoreError::corrupt(format!("setting {name}: {error}")))?;
    }
    Ok(settings)
}

/// Returns the inverse of [`setting_text`].
fn setting(name: &str, text: &str) -> Option<SettingValue> {
    let row = Settings::TABLE.iter().find(|row| row.name == name)?;
    Some(match row.kind {
        SettingKind::Number { .. } => SettingValue::Number(text.parse().ok()?),
        SettingKind::Count { .. } => SettingValue::Count(text.parse().ok()?),
        SettingKind::Switch { .. } => SettingValue::Switch(text.parse().ok()?),
        SettingKind::Choice { names, .. } => {
            SettingValue::Choice(names.iter().copied().find(|name| *name == text)?)
        }
        SettingKind::Patterns { .. } => {
            SettingValue::Patterns(Patterns::new(serde_json::from_str(text).ok()?).ok()?)
        }
    })
}
