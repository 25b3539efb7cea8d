//! From changes to rows.

use std::collections::HashMap;
use std::sync::Arc;

use sqlx::{Sqlite, SqliteConnection};

use super::StoreError;
use super::blob::pack;
use super::key_rows::{self, NewKeyRow};
use super::keyframe_rows::{add_detections, add_keyframe, pose_blob, set_points};
use super::model_rows::{self, Spent};
use crate::model::anchor::Outcome;
use crate::model::change::{Change, Loop, Merge, MergeCause};
use crate::model::event::Event;
use crate::model::ids::{AnchorSeq, KeyframeId, KeyframeSeq, LoopId, MapId};
use crate::model::key::KeySeq;
use crate::model::keyframe::NewKeyframe;
use crate::model::map::MapProperties;
use crate::model::request::Digest;
use crate::model::settings::{SettingValue, Settings};

/// A map's key in the database.
pub type MapKey = i64;

/// Events of a map are kept up to this number, oldest out first.
const EVENTS_KEPT: u64 = 100_000;

/// How often old events are taken out.
const EVENTS_SWEPT_EVERY: u64 = 256;

/// Loop queries of a map are kept up to this number, oldest out first.
const QUERIES_KEPT: i64 = 1_000;

/// What one request changes in one map: committed as a whole.
#[derive(Debug)]
pub struct Batch {
    /// The map.
    pub map: MapKey,
    /// The map's version after it.
    pub version: u64,
    /// The dense numbers given next after it.
    pub next_keyframe: KeyframeSeq,
    /// The dense numbers given next after it.
    pub next_anchor: AnchorSeq,
    /// The number of the next event after it.
    pub next_event: u64,
    /// The changes, in their order.
    pub changes: Vec<Change>,
    /// The heavy parts of the keyframe that arrived, if one did.
    pub new_keyframe: Option<NewKeyframeRows>,
    /// What happened, numbered.
    pub events: Vec<Event>,
}

/// The parts of a new keyframe that the index does not keep.
#[derive(Debug)]
pub struct NewKeyframeRows {
    /// The keyframe as sent.
    pub keyframe: Arc<NewKeyframe>,
    /// The digest of the body it was sent in.
    pub digest: Digest,
}

/// What the writer is asked to do in one piece.
#[derive(Debug)]
pub enum Job {
    /// A new map.
    CreateMap {
        /// Its key.
        key: MapKey,
        /// Its name.
        id: MapId,
        /// Its properties.
        properties: Box<MapProperties>,
        /// The digest of the body that made it.
        digest: Digest,
        /// The key that made it.
        owner: Option<KeySeq>,
    },
    /// A map goes, with everything in it.
    DeleteMap(MapKey),
    /// A request's changes.
    Change(Box<Batch>),
    /// Events that belong to no change.
    Tell(MapKey, u64, Vec<Event>),
    /// A loop query's verdict is kept for reading back.
    KeepQuery {
        /// The map.
        map: MapKey,
        /// The query's id.
        id: String,
        /// Its number in the map, by age.
        kept: i64,
        /// The answer, as sent.
        body: bytes::Bytes,
    },
    /// A model's answer is kept by the hash of all that it depends on.
    KeepAnswer {
        /// The hash.
        key: [u8; 32],
        /// What was asked for.
        operation: &'static str,
        /// Who answered.
        model: Arc<str>,
        /// The answer, as received.
        answer: Arc<str>,
    },
    /// No map waits for a model any more; those that did have another version now.
    ForgetAway,
    /// Calls of models, and what they cost or may cost.
    Spend(Spent),
    /// A new API key.
    CreateKey(Box<NewKeyRow>),
    /// An API key is good no longer, from this second on.
    RevokeKey(KeySeq, i64),
}

impl Job {
    /// Does it leave more room than it found? It is tried on a full disk, too.
    pub(super) fn frees_space(&self) -> bool {
        match self {
            // A key must be revocable whatever the disk holds, and takes no space.
            Self::DeleteMap(_) | Self::RevokeKey(..) => true,
            Self::Change(batch) => batch.new_keyframe.is_none() && frees_space(&batch.changes),
            _ => false,
        }
    }

    /// Do later jobs of its map rest on it? A verdict that is not kept, or an event not told, is missed by none of them.
    pub(super) fn is_planned_upon(&self) -> bool {
        !matches!(self, Self::KeepQuery { .. } | Self::Tell(..))
    }
}

/// Do these changes take something away?
fn frees_space(changes: &[Change]) -> bool {
    let takes_away = |change: &Change| {
        matches!(change, Change::KeyframeRemoved(..) | Change::AnchorRemoved(_) | Change::LoopRemoved(_))
    };
    changes.iter().any(takes_away)
}

/// Does a job, within the transaction of its group.
pub(super) async fn execute(db: &mut SqliteConnection, job: &Job) -> Result<(), StoreError> {
    match job {
        Job::CreateMap { key, id, properties, digest, owner } => {
            create_map(db, *key, id, properties, digest, *owner).await
        }
        Job::DeleteMap(map) => {
            run(db, sqlx::query("delete from detections where map_key = $1").bind(map)).await?;
            run(db, sqlx::query("delete from maps where map_key = $1").bind(map)).await
        }
        Job::Change(batch) => change_map(db, batch).await,
        Job::Tell(map, next_event, events) => {
            run(
                db,
                sqlx::query("update maps set next_event = $2 where map_key = $1")
                    .bind(map)
                    .bind(*next_event as i64),
            )
            .await?;
            tell(db, *map, events).await
        }
        Job::KeepAnswer { key, operation, model, answer } => {
            model_rows::keep_answer(db, key, operation, model, answer).await
        }
        Job::ForgetAway => model_rows::forget_away(db).await,
        Job::Spend(spent) => model_rows::spend(db, spent).await,
        Job::CreateKey(key) => key_rows::create(db, key).await,
        Job::RevokeKey(key, at) => key_rows::revoke(db, *key, *at).await,
        Job::KeepQuery { map, id, kept, body } => keep_query(db, *map, id, *kept, body).await,
    }
}

pub(super) type Query<'q> = sqlx::query::Query<'q, Sqlite, sqlx::sqlite::SqliteArguments>;

pub(super) async fn run(db: &mut SqliteConnection, query: Query<'_>) -> Result<(), StoreError> {
    query.execute(db).await?;
    Ok(())
}

async fn create_map(
    db: &mut SqliteConnection,
    key: MapKey,
    id: &MapId,
    properties: &MapProperties,
    digest: &Digest,
    owner: Option<KeySeq>,
) -> Result<(), StoreError> {
    let insert = "insert into maps (map_key, id, description, metric, version, next_keyframe, next_anchor, next_event, digest, owner)
        values ($1, $2, '', 0, 1, 0, 0, 1, $3, $4)";
    let query = sqlx::query(insert).bind(key).bind(id.as_str()).bind(&digest[..]);
    run(db, query.bind(owner.map(|owner| owner.0))).await?;
    set_properties(db, key, properties).await
}

async fn change_map(db: &mut SqliteConnection, batch: &Batch) -> Result<(), StoreError> {
    let map = batch.map;
    let update = "update maps set version = $2, next_keyframe = $3, next_anchor = $4, next_event = $5 where map_key = $1";
    let query = sqlx::query(update)
        .bind(map)
        .bind(batch.version as i64)
        .bind(batch.next_keyframe.0)
        .bind(batch.next_anchor.0)
        .bind(batch.next_event as i64);
    run(db, query).await?;
    let outcomes: HashMap<(KeyframeSeq, u16), Outcome> = batch
        .changes
        .iter()
        .filter_map(|change| match change {
            Change::OutcomeSet(keyframe, detection, outcome) => Some(((*keyframe, *detection), *outcome)),
            _ => None,
        })
        .collect();
    let mut points = Vec::new();
    let mut arrived = None;
    for change in &batch.changes {
        match change {
            Change::PointSet(session, id, position) => points.push((*session, *id, *position)),
            Change::KeyframeAdded(keyframe, bow) => {
                let rows = batch
                    .new_keyframe
                    .as_ref()
                    .ok_or_else(|| StoreError::corrupt("a keyframe without its rows"))?;
                add_keyframe(db, map, keyframe, bow, rows).await?;
                arrived = Some((keyframe.seq, rows));
            }
            other => apply(db, map, other).await?,
        }
    }
    // After the anchors they name.
    if let Some((keyframe, rows)) = arrived {
        add_detections(db, map, keyframe, &rows.keyframe, &outcomes).await?;
    }
    set_points(db, map, &points).await?;
    tell(db, map, &batch.events).await
}

async fn apply(db: &mut SqliteConnection, map: MapKey, change: &Change) -> Result<(), StoreError> {
    match change {
        Change::MapSet(properties) => set_properties(db, map, properties).await,
        Change::VocabularySet(name) => {
            let update = "update maps set vocabulary = $2 where map_key = $1";
            run(db, sqlx::query(update).bind(map).bind(&**name)).await
        }
        Change::SessionAdded(seq, id) => {
            let insert = "insert into sessions (map_key, session, id) values ($1, $2, $3)";
            run(db, sqlx::query(insert).bind(map).bind(seq.0).bind(id.as_str())).await
        }
        Change::KeyframeRemoved(seq, _) => {
            let delete = "delete from keyframes where map_key = $1 and keyframe = $2";
            run(db, sqlx::query(delete).bind(map).bind(seq.0)).await
        }
        Change::PoseSet(seq, pose) => {
            let update = "update keyframes set pose = $3 where map_key = $1 and keyframe = $2";
            run(db, sqlx::query(update).bind(map).bind(seq.0).bind(pose_blob(pose))).await
        }
        Change::AnchorAdded(seq, class) => {
            let insert = "insert into anchors (map_key, anchor, class, version) values ($1, $2, $3, 1)";
            run(db, sqlx::query(insert).bind(map).bind(seq.0).bind(&**class)).await
        }
        Change::AnchorRemoved(seq) => {
            let orphan = "update detections set anchor = null, outcome = 'anchor_deleted' where map_key = $1 and anchor = $2";
            run(db, sqlx::query(orphan).bind(map).bind(seq.0)).await?;
            let delete = "delete from anchors where map_key = $1 and anchor = $2";
            run(db, sqlx::query(delete).bind(map).bind(seq.0)).await
        }
        Change::PositionSet(_, keyframe, detection, at) => {
            let update =
                "update detections set position = $4 where map_key = $1 and keyframe = $2 and detection = $3";
            let position = pack([at.x, at.y, at.z]);
            run(db, sqlx::query(update).bind(map).bind(keyframe.0).bind(*detection).bind(position)).await
        }
        Change::DescriptionSet(seq, text) => {
            let update = "update anchors set description_by_hand = $3 where map_key = $1 and anchor = $2";
            run(db, sqlx::query(update).bind(map).bind(seq.0).bind(text.as_deref())).await
        }
        Change::AnchorTouched(seq, version) => {
            let update = "update anchors set version = $3 where map_key = $1 and anchor = $2";
            run(db, sqlx::query(update).bind(map).bind(seq.0).bind(*version as i64)).await
        }
        Change::Merged(merge) => add_merge(db, map, merge).await,
        Change::LoopAdded(closed) => add_loop(db, map, closed).await,
        Change::CropRead(read) => model_rows::add_reading(db, map, read).await,
        Change::Judged(verdict) => model_rows::add_verdict(db, map, verdict).await,
        Change::ModelAway(away) => model_rows::set_away(db, map, *away).await,
        Change::LoopRemoved(id) => {
            let merges = "delete from anchor_merges where map_key = $1 and loop_id = $2";
            run(db, sqlx::query(merges).bind(map).bind(id.as_str())).await?;
            let delete = "delete from loops where map_key = $1 and id = $2";
            run(db, sqlx::query(delete).bind(map).bind(id.as_str())).await
        }
        // Written with the keyframe's rows, or by the caller.
        Change::KeyframeAdded(..) | Change::PointSet(..) | Change::Observed(..) | Change::OutcomeSet(..) => {
            Ok(())
        }
    }
}

async fn set_properties(
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

async fn add_merge(db: &mut SqliteConnection, map: MapKey, merge: &Merge) -> Result<(), StoreError> {
    let by = match &merge.cause {
        MergeCause::Covisible => "",
        MergeCause::Loop(id) => id.as_str(),
    };
    let insert =
        "insert into anchor_merges (map_key, into_anchor, from_anchor, loop_id) values ($1, $2, $3, $4)
        on conflict do nothing";
    run(db, sqlx::query(insert).bind(map).bind(merge.into.0).bind(merge.from.0).bind(by)).await
}

async fn add_loop(db: &mut SqliteConnection, map: MapKey, closed: &Loop) -> Result<(), StoreError> {
    let insert = "insert into loops (map_key, id, keyframe, candidate, keyframe_id, candidate_id, query)
        values ($1, $2, $3, $4, $5, $6, $7)";
    let query = sqlx::query(insert)
        .bind(map)
        .bind(closed.id.as_str())
        .bind(closed.keyframe.0)
        .bind(closed.candidate.0)
        .bind(closed.keyframe_id.as_str())
        .bind(closed.candidate_id.as_str())
        .bind(&closed.query);
    run(db, query).await
}

async fn tell(db: &mut SqliteConnection, map: MapKey, events: &[Event]) -> Result<(), StoreError> {
    for event in events {
        let insert = "insert into events (map_key, seq, kind, map_version, anchor, other, keyframe, candidate, loop_id, query, detail)
            values ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11)";
        let query = sqlx::query(insert)
            .bind(map)
            .bind(event.seq as i64)
            .bind(event.kind.as_str())
            .bind(event.map_version as i64)
            .bind(event.anchor.map(|anchor| anchor.0))
            .bind(event.other.map(|anchor| anchor.0))
            .bind(event.keyframe.as_ref().map(KeyframeId::as_str))
            .bind(event.candidate.as_ref().map(KeyframeId::as_str))
            .bind(event.loop_id.as_ref().map(LoopId::as_str))
            .bind(&event.query)
            .bind(&event.detail);
        run(db, query).await?;
        if event.seq.is_multiple_of(EVENTS_SWEPT_EVERY) {
            let sweep = "delete from events where map_key = $1 and seq <= $2";
            run(db, sqlx::query(sweep).bind(map).bind(event.seq.saturating_sub(EVENTS_KEPT) as i64)).await?;
        }
    }
    Ok(())
}

async fn keep_query(
    db: &mut SqliteConnection,
    map: MapKey,
    id: &str,
    kept: i64,
    body: &bytes::Bytes,
) -> Result<(), StoreError> {
    // The map may be gone by now: then there is nothing to keep.
    let insert = "insert into loop_queries (map_key, id, kept, body)
        select $1, $2, $3, $4 where exists (select 1 from maps where map_key = $1)
        on conflict (map_key, id) do update set kept = excluded.kept, body = excluded.body";
    run(db, sqlx::query(insert).bind(map).bind(id).bind(kept).bind(&body[..])).await?;
    let sweep = "delete from loop_queries where map_key = $1 and kept <= $2";
    run(db, sqlx::query(sweep).bind(map).bind(kept - QUERIES_KEPT)).await
}
