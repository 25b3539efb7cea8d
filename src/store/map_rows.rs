//! A map's own rows: its properties and settings, to the database and back.

use sqlx::sqlite::SqliteRow;
use sqlx::{AssertSqlSafe, Row, SqliteConnection};

use super::StoreError;
use super::job::MapKey;
use super::write::run;
use crate::model::ids::MapId;
use crate::model::key::KeySeq;
use crate::model::map::MapProperties;
use crate::model::request::Digest;
use crate::model::settings::{SettingKind, SettingValue, Settings, WithoutAnchors};

/// A new map. Its events are numbered from above those of every map that was deleted, so that a client that resumes with a
/// number of a deleted map is recognised. The greatest number that a deleted map would have given next is SQLite's
/// `user_version`: it is part of the database file, of its transactions and of its backups.
pub(super) async fn create(
    db: &mut SqliteConnection,
    key: MapKey,
    id: &MapId,
    properties: &MapProperties,
    digest: &Digest,
    owner: Option<KeySeq>,
) -> Result<(), StoreError> {
    let insert = "insert into maps (map_key, id, description, metric, version, next_keyframe, next_anchor, next_event, digest, owner)
        select $1, $2, '', 0, 1, 0, 0, user_version + 1, $3, $4 from pragma_user_version";
    let query = sqlx::query(insert).bind(key).bind(id.as_str()).bind(&digest[..]);
    run(db, query.bind(owner.map(|owner| owner.0))).await?;
    set_properties(db, key, properties).await
}

/// Notes before a map is deleted that its events' numbers were given; a map without events gave none.
pub(super) async fn keep_event_numbers(db: &mut SqliteConnection, key: MapKey) -> Result<(), StoreError> {
    let select = "select next_event from maps, pragma_user_version
        where map_key = $1 and next_event > user_version and exists (select 1 from events where map_key = $1)";
    let higher: Option<i64> = sqlx::query_scalar(select).bind(key).fetch_optional(&mut *db).await?;
    if let Some(next_event) = higher {
        // SQLite keeps 32 bits of it.
        let next_event = i32::try_from(next_event).unwrap_or(i32::MAX);
        run(db, sqlx::query(AssertSqlSafe(format!("pragma user_version = {next_event}")))).await?;
    }
    Ok(())
}

/// A map's properties, in place of those it had.
pub(super) async fn set_properties(
    db: &mut SqliteConnection,
    map: MapKey,
    properties: &MapProperties,
) -> Result<(), StoreError> {
    let update = "update maps set description = $2, metric = $3 where map_key = $1";
    run(db, sqlx::query(update).bind(map).bind(&properties.description).bind(properties.metric)).await?;
    run(db, sqlx::query("delete from map_anchor_classes where map_key = $1").bind(map)).await?;
    for class in &properties.anchor_classes {
        let insert = "insert into map_anchor_classes (map_key, class) values ($1, $2)";
        run(db, sqlx::query(insert).bind(map).bind(class)).await?;
    }
    run(db, sqlx::query("delete from map_settings where map_key = $1").bind(map)).await?;
    let defaults = Settings::default();
    for row in Settings::TABLE {
        let (value, default) = (properties.settings.get(row.name), defaults.get(row.name));
        if let Some(value) = value.filter(|_| value != default) {
            let insert = "insert into map_settings (map_key, name, value) values ($1, $2, $3)";
            run(db, sqlx::query(insert).bind(map).bind(row.name).bind(setting_text(value))).await?;
        }
    }
    Ok(())
}

/// A setting as text; numbers in the shortest form that reads back to the same bits.
fn setting_text(value: SettingValue) -> String {
    match value {
        SettingValue::Number(number) => format!("{number:?}"),
        SettingValue::Count(count) => count.to_string(),
        SettingValue::Switch(switch) => switch.to_string(),
        SettingValue::Policy(policy) => policy.as_str().to_owned(),
    }
}

/// A map's properties, as its row and its settings say.
pub(super) async fn properties(
    db: &mut SqliteConnection,
    key: MapKey,
    row: &SqliteRow,
) -> Result<MapProperties, StoreError> {
    let classes = "select class from map_anchor_classes where map_key = $1 order by class";
    let mut settings = Settings::default();
    let stored: Vec<(String, String)> =
        sqlx::query_as("select name, value from map_settings where map_key = $1")
            .bind(key)
            .fetch_all(&mut *db)
            .await?;
    for (name, text) in stored {
        let value =
            setting(&name, &text).ok_or_else(|| StoreError::corrupt(format!("setting {name} = {text}")))?;
        settings
            .set(&name, value)
            .map_err(|error| StoreError::corrupt(format!("setting {name}: {error}")))?;
    }
    Ok(MapProperties {
        description: row.try_get("description")?,
        metric: row.try_get("metric")?,
        anchor_classes: sqlx::query_scalar(classes).bind(key).fetch_all(&mut *db).await?,
        settings,
    })
}

/// The inverse of [`setting_text`].
fn setting(name: &str, text: &str) -> Option<SettingValue> {
    let row = Settings::TABLE.iter().find(|row| row.name == name)?;
    Some(match row.kind {
        SettingKind::Number { .. } => SettingValue::Number(text.parse().ok()?),
        SettingKind::Count { .. } => SettingValue::Count(text.parse().ok()?),
        SettingKind::Switch { .. } => SettingValue::Switch(text.parse().ok()?),
        SettingKind::Policy { .. } => SettingValue::Policy(WithoutAnchors::from_name(text)?),
    })
}
