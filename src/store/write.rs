//! From changes to rows.

use std::collections::HashMap;

use sqlx::{Sqlite, SqliteConnection};

use super::blob::pack;
use super::job::{Batch, Job, MapKey};
use super::keyframe_rows::{add_detections, add_keyframe, forget_points, pose_blob, set_points};
use super::{StoreError, deferred, deletion, judgement_rows, key_rows, map_rows, model_rows};
use crate::model::anchor::Outcome;
use crate::model::change::{Change, Loop, Merge, MergeCause};
use crate::model::event::Event;
use crate::model::ids::KeyframeSeq;

/// Events of a map are kept up to this number, oldest out first.
const EVENTS_KEPT: u64 = 100_000;

/// How often old events are taken out.
const EVENTS_SWEPT_EVERY: u64 = 256;

/// Rows of events in a statement: not many, because a connection keeps a statement for each number of them.
const EVENTS_PER_STATEMENT: usize = 16;

/// Loop queries of a map are kept up to this number, oldest out first.
const QUERIES_KEPT: i64 = 1_000;

/// How many are taken out at a time.
const QUERIES_SWEPT: i64 = 16;

/// Does a job, within the transaction of its group.
pub(super) async fn execute(db: &mut SqliteConnection, job: &Job) -> Result<(), StoreError> {
    match job {
        Job::CreateMap { key, id, properties, digest, owner } => {
            map_rows::create(db, *key, id, properties, digest, *owner).await
        }
        Job::DeleteMap(map) => {
            map_rows::keep_event_numbers(db, *map).await?;
            deletion::mark_deleted(db, *map).await
        }
        Job::Change(batch) => change_map(db, batch).await,
        Job::Stage { map, version, number, part, .. } => {
            deferred::stage(db, *map, *version, *number, part).await
        }
        Job::ChangeStaged { batch, parts, .. } => {
            deferred::commit_staged(db, batch.map, batch.version, *parts).await?;
            change_map(db, batch).await
        }
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
        Job::StartJudgement(map, judgement) => judgement_rows::start(db, *map, judgement).await,
        Job::StopJudgement(map, id) => judgement_rows::stop(db, *map, id).await,
        Job::KeepQuery { map, id, kept, body } => keep_query(db, *map, id, *kept, body).await,
    }
}

pub(super) type Query<'q> = sqlx::query::Query<'q, Sqlite, sqlx::sqlite::SqliteArguments>;

pub(super) async fn run(db: &mut SqliteConnection, query: Query<'_>) -> Result<(), StoreError> {
    query.execute(db).await?;
    Ok(())
}

async fn change_map(db: &mut SqliteConnection, batch: &Batch) -> Result<(), StoreError> {
    let map = batch.map;
    map_rows::advance(db, batch).await?;
    let outcomes: HashMap<(KeyframeSeq, u16), Outcome> = batch
        .changes
        .iter()
        .filter_map(|change| match change {
            Change::OutcomeSet(keyframe, detection, outcome) => Some(((*keyframe, *detection), *outcome)),
            _ => None,
        })
        .collect();
    // What must not overtake deferred changes is deferred behind them.
    let defers = batch.changes.iter().any(deferred::is_ordered) && deferred::any(db, map).await?;
    if defers {
        deferred::defer(db, batch).await?;
    }
    let mut points = Vec::new();
    let mut arrived = None;
    for change in &batch.changes {
        match change {
            change if defers && deferred::is_ordered(change) => {}
            Change::PointSet(session, id, position) => points.push((*session, *id, *position)),
            Change::KeyframeAdded(keyframe, bow) => {
                let rows = batch
                    .new_keyframe
                    .as_ref()
                    .ok_or_else(|| StoreError::corrupt("a keyframe without its rows"))?;
                add_keyframe(db, map, keyframe, bow, rows).await?;
                arrived = Some((keyframe.seq, rows));
            }
            other => apply(db, (map, batch.version), other).await?,
        }
    }
    // After the anchors they name.
    if let Some((keyframe, rows)) = arrived {
        add_detections(db, map, keyframe, &rows.keyframe, &outcomes).await?;
    }
    set_points(db, map, &points).await?;
    tell(db, map, &batch.events).await
}

async fn apply(
    db: &mut SqliteConnection,
    (map, version): (MapKey, u64),
    change: &Change,
) -> Result<(), StoreError> {
    match change {
        Change::MapSet(properties) => map_rows::set_properties(db, map, properties).await,
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
        Change::PointsForgotten(session, ids) => forget_points(db, map, *session, ids).await,
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
        Change::CropRead(read) => model_rows::add_reading(db, (map, version), read).await,
        Change::Judged(verdict) => model_rows::add_verdict(db, (map, version), verdict).await,
        Change::JudgementAdvanced(progress) => judgement_rows::advance(db, map, progress).await,
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
    // An arrival may tell of every anchor that it matches: row by row, each would be a way to the database and back.
    for chunk in events.chunks(EVENTS_PER_STATEMENT) {
        let mut insert = sqlx::QueryBuilder::<Sqlite>::new(
            "insert into events (map_key, seq, kind, map_version, anchor, other, keyframe, candidate, loop_id, query, detail) ",
        );
        insert.push_values(chunk, |mut row, event| {
            row.push_bind(map).push_bind(event.seq as i64).push_bind(event.kind.as_str());
            row.push_bind(event.map_version as i64);
            row.push_bind(event.anchor.map(|anchor| anchor.0)).push_bind(event.other.map(|anchor| anchor.0));
            row.push_bind(event.keyframe.as_ref().map(|id| id.as_str().to_owned()));
            row.push_bind(event.candidate.as_ref().map(|id| id.as_str().to_owned()));
            row.push_bind(event.loop_id.as_ref().map(|id| id.as_str().to_owned()));
            row.push_bind(event.query.clone()).push_bind(event.detail.clone());
        });
        // One statement for each number of rows, of which there are few.
        insert.build().execute(&mut *db).await?;
    }
    for swept in events.iter().filter(|event| event.seq.is_multiple_of(EVENTS_SWEPT_EVERY)) {
        let sweep = "delete from events where map_key = $1 and seq <= $2";
        run(db, sqlx::query(sweep).bind(map).bind(swept.seq.saturating_sub(EVENTS_KEPT) as i64)).await?;
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
        select $1, $2, $3, $4 where exists (select 1 from maps where map_key = $1 and deleted = 0)
        on conflict (map_key, id) do update set kept = excluded.kept, body = excluded.body";
    run(db, sqlx::query(insert).bind(map).bind(id).bind(kept).bind(&body[..])).await?;
    if kept % QUERIES_SWEPT != 0 {
        return Ok(());
    }
    let sweep = "delete from loop_queries where map_key = $1 and kept <= $2";
    run(db, sqlx::query(sweep).bind(map).bind(kept - QUERIES_KEPT + QUERIES_SWEPT)).await
}
