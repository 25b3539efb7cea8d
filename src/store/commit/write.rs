//! From changes to rows.

use std::borrow::Cow;

use super::additions::Additions;
use super::job::{Batch, ErasureStep, Job, MapKey};
use crate::domain::change::{Change, Loop, Merge, MergeCause};
use crate::store::StoreError;
use crate::store::log::entry::Entry;
use crate::store::log::log_rows::{self, FIRST_PART};
use crate::store::log::parts::{Kind, Part, is_ordered};
use crate::store::log::said::said;
use crate::store::postgres::change_log;
use crate::store::rows::blob::pack;
use crate::store::rows::keyframe_rows::{Arrived, detections, pose_blob};
use crate::store::rows::statement::run;
use crate::store::rows::verdict_rows::KeptQuery;
use crate::store::rows::{
    changed_sign_rows, copied_rows, erasure_rows, frame_rows, judgement_rows, key_rows, map_rows, model_rows,
    observation_rows, point_blocks, prior_rows, release_rows, retention_rows, session_merge_rows, traces,
    transferred_rows, twin_rows, unsaid,
};
use crate::store::slices::{deferred, deletion};
use crate::store::sql::{self, Connection, Engine};

/// The version of a map that was just made.
const FIRST_VERSION: u64 = 1;

/// The rows of a group's jobs: those that only add to others are gathered, and written before anything else is done.
struct Rows<'c, 'j> {
    connection: &'c mut Connection,
    gathered: Additions<'j>,
}

impl Rows<'_, '_> {
    /// Returns the connection, once what is gathered is written.
    async fn db(&mut self) -> Result<&mut Connection, StoreError> {
        std::mem::take(&mut self.gathered).write(self.connection).await?;
        Ok(self.connection)
    }
}

/// Does jobs in their order, within the transaction of their group.
pub(in crate::store) async fn execute<'j>(
    db: &mut Connection,
    jobs: impl Iterator<Item = &'j Job>,
) -> Result<(), StoreError> {
    let mut rows = Rows { connection: db, gathered: Additions::default() };
    for job in jobs {
        execute_one(&mut rows, job).await?;
    }
    rows.db().await.map(drop)
}

async fn execute_one<'j>(rows: &mut Rows<'_, 'j>, job: &'j Job) -> Result<(), StoreError> {
    match job {
        Job::Change(batch) => change_map(rows, batch, false).await,
        Job::ChangeStaged { batch, .. } => change_map(rows, batch, true).await,
        Job::KeepQuery { map, id, kept, line, body } => {
            rows.gathered.keep(KeptQuery { map: *map, id, kept: *kept, line, body });
            Ok(())
        }
        Job::AppendEvents(map, next_event, events) => {
            let update = "update maps set next_event = $2 where map_key = $1";
            run(rows.db().await?, sql::query(update).bind(map).bind(*next_event as i64)).await?;
            rows.gathered.tell(*map, events);
            Ok(())
        }
        Job::CreateMap { id, properties, digest, owner } => {
            let db = rows.db().await?;
            let key = map_rows::create(db, id, properties, digest, *owner).await?;
            log_rows::add(db, (key, FIRST_VERSION), FIRST_PART, &Part::setting(properties)).await
        }
        Job::DeleteMap(map) => {
            let db = rows.db().await?;
            map_rows::keep_event_numbers(db, *map).await?;
            deletion::mark_deleted(db, *map).await
        }
        Job::DiscardCopy(copy) => deletion::mark_deleted(rows.db().await?, *copy).await,
        Job::BeginCopy { row, id } => copied_rows::begin(rows.db().await?, row, id).await,
        Job::CopyRows { map, block } => copied_rows::write_block(rows.db().await?, *map, block).await,
        Job::AddRows(block) => transferred_rows::write_beside_maps(rows.db().await?, block).await,
        Job::AddRelease { maps, row } => transferred_rows::write_release(rows.db().await?, *maps, row).await,
        Job::RaiseLastEvent(last) => transferred_rows::raise_last_event(rows.db().await?, *last).await,
        Job::FinishCopy { map, copied_as } => {
            release_rows::finish_copy(rows.db().await?, *map, copied_as).await
        }
        Job::ForgetDialogues(map) => {
            let db = rows.db().await?;
            note_rewrite(db, *map).await?;
            retention_rows::forget_dialogues(db, *map).await
        }
        Job::Erase(map, number, step) => erase(rows.db().await?, (*map, *number), step).await,
        Job::CountUses { release, uses } => release_rows::count_uses(rows.db().await?, *release, uses).await,
        Job::Stage { map, version, number, part, .. } => {
            log_rows::stage(rows.db().await?, (*map, *version), *number, part).await
        }
        Job::KeepFrames { map, version, frames } => {
            frame_rows::keep(rows.db().await?, *map, *version, frames).await
        }
        Job::KeepAnswer { key, operation, model, answer, erasures } => {
            model_rows::keep_answer(rows.db().await?, key, (operation, model), answer, *erasures).await
        }
        Job::ForgetAway => model_rows::forget_away(rows.db().await?).await,
        Job::Spend(spent) => model_rows::spend(rows.db().await?, spent).await,
        Job::CreateKey(key) => key_rows::create(rows.db().await?, key).await,
        Job::RevokeKey(key, at) => key_rows::revoke(rows.db().await?, *key, *at).await,
        Job::StartJudgement(map, judgement) => judgement_rows::start(rows.db().await?, *map, judgement).await,
        Job::StopJudgement(map, id) => judgement_rows::stop(rows.db().await?, *map, id).await,
    }
}

async fn erase(db: &mut Connection, of: (MapKey, u64), step: &ErasureStep) -> Result<(), StoreError> {
    match step {
        ErasureStep::Begin(asked, at) => erasure_rows::begin(db, of, asked, *at).await,
        ErasureStep::Count(keyframes, releases) => {
            erasure_rows::count(db, of, (*keyframes, releases.len() as u64)).await?;
            for release in releases {
                release_rows::count_erasure(db, *release).await?;
            }
            Ok(())
        }
        ErasureStep::RemoveTraces(map, sessions) => {
            note_rewrite(db, *map).await?;
            if db.engine() == Engine::Postgres {
                change_log::forget(db, *map).await?;
            }
            traces::remove(db, *map, sessions).await
        }
        ErasureStep::Removed => erasure_rows::removed(db, of).await,
        ErasureStep::Done(at) => erasure_rows::done(db, of, *at).await,
    }
}

/// Has other servers that follow a map load it anew.
async fn note_rewrite(db: &mut Connection, map: MapKey) -> Result<(), StoreError> {
    match db.engine() {
        Engine::Sqlite => Ok(()),
        Engine::Postgres => change_log::note_rewrite(db, map).await,
    }
}

/// Brings a version into the rows and the log; poses and points of it that are staged already wait there.
async fn change_map<'j>(
    rows: &mut Rows<'_, 'j>,
    batch: &'j Batch,
    is_staged: bool,
) -> Result<(), StoreError> {
    let map = batch.map;
    // What must not overtake deferred changes is deferred behind them.
    let defers = batch.changes.iter().any(is_ordered) && rows.gathered.defers(rows.connection, map).await?;
    if defers {
        deferred::defer(rows.db().await?, batch).await?;
    }
    #[cfg(test)]
    crate::store::log::entry::tests::expect_form(&batch.changes, &batch.former);
    rows.gathered.advance(batch);
    log(rows.connection, batch, (is_staged, defers)).await?;
    for change in &batch.changes {
        if !(defers && is_ordered(change)) {
            apply(rows, batch, change).await?;
        }
    }
    if batch.is_followed {
        change_log::log(rows.connection, batch).await?;
    }
    // After the anchors they name.
    rows.gathered.detect(detections(batch)?);
    rows.gathered.tell(map, &batch.events);
    Ok(())
}

/// Writes to the log what a version says and its rows will not tell, before these change.
async fn log(
    db: &mut Connection,
    batch: &Batch,
    (is_staged, defers): (bool, bool),
) -> Result<(), StoreError> {
    let of = (batch.map, batch.version);
    let unsaid = unsaid::by(db, batch.map, &batch.changes).await?;
    if !unsaid.is_empty() {
        let part = Part { kind: Kind::Unsaid, entry: Entry { unsaid, ..Entry::default() } };
        log_rows::add(db, of, FIRST_PART, &part).await?;
    }
    let mut changes = said(batch);
    changes.retain(|change| !(defers && is_ordered(change)));
    let entry = Entry { changes, former: Cow::Borrowed(&batch.former), unsaid: Vec::new() };
    let waits = is_staged || defers;
    if entry.is_empty() && !waits {
        return Ok(());
    }
    let kind = if entry.is_empty() { Kind::Passing } else { Kind::Said };
    log_rows::add(db, of, FIRST_PART, &Part { kind, entry }).await?;
    if waits { deferred::wait(db, of).await } else { Ok(()) }
}

#[expect(clippy::too_many_lines, reason = "one arm for each change")]
async fn apply<'j>(rows: &mut Rows<'_, 'j>, batch: &'j Batch, change: &'j Change) -> Result<(), StoreError> {
    let (map, version) = (batch.map, batch.version);
    let of = (map, version);
    match change {
        Change::SessionAdded(seq, id) => rows.gathered.sessions.push((map, *seq, id)),
        Change::KeyframeAdded(keyframe, bow) => {
            let new = batch.new_keyframe.as_ref();
            let new = new.ok_or_else(|| StoreError::corrupt("a keyframe without its rows"))?;
            rows.gathered.keyframes.push(Arrived { map, version, keyframe, bow, rows: new });
        }
        Change::AnchorAdded(seq, class) => rows.gathered.anchors.push((map, *seq, class)),
        Change::AnchorTouched(seq, version) => drop(rows.gathered.touched.insert((map, *seq), *version)),
        Change::PointSet(session, id, at) => rows.gathered.points.push((map, *session, *id, *at)),
        // Written with the keyframe's rows, or to the log alone.
        Change::GlobalDescriptorSet(..)
        | Change::Observed(..)
        | Change::OutcomeSet(..)
        | Change::ObservationsSent(_) => {}
        Change::MapSet(properties) => {
            let db = rows.db().await?;
            map_rows::set_properties(db, map, properties).await?;
        }
        Change::VocabularySet(name) => {
            let update = "update maps set vocabulary = $2 where map_key = $1";
            run(rows.db().await?, sql::query(update).bind(map).bind(&**name)).await?;
        }
        Change::KeyframeRemoved(seq, _) => {
            let delete = "delete from keyframes where map_key = $1 and keyframe = $2";
            run(rows.db().await?, sql::query(delete).bind(map).bind(seq.0)).await?;
        }
        Change::PartsForgotten(parts) => retention_rows::forget_parts(rows.db().await?, map, parts).await?,
        Change::PoseSet(seq, pose) => {
            let update = "update keyframes set pose = $3 where map_key = $1 and keyframe = $2";
            run(rows.db().await?, sql::query(update).bind(map).bind(seq.0).bind(pose_blob(pose))).await?;
        }
        Change::PointsOfKeyframeSet(points) => {
            observation_rows::set_points_of_keyframe(rows.db().await?, map, points).await?;
        }
        Change::PointsOfDetectionSet(_, keyframe, detection, points) => {
            observation_rows::set_points_of_detection(rows.db().await?, map, (*keyframe, *detection), points)
                .await?;
        }
        Change::PointsForgotten(session, ids) => {
            point_blocks::change(rows.db().await?, map, ids.iter().map(|id| (*session, *id, None))).await?;
        }
        Change::AnchorRemoved(seq) => {
            let db = rows.db().await?;
            let orphan =
                "update detections set anchor = null, outcome = 'anchor_deleted', deleted_anchor = $2,
                deleted_in = $3 where map_key = $1 and anchor = $2";
            run(db, sql::query(orphan).bind(map).bind(seq.0).bind(version as i64)).await?;
            prior_rows::remove(db, map, *seq).await?;
            let delete = "delete from anchors where map_key = $1 and anchor = $2";
            run(db, sql::query(delete).bind(map).bind(seq.0)).await?;
        }
        Change::PriorSet(seq, prior) => prior_rows::add(rows.db().await?, map, *seq, prior).await?,
        Change::PositionSet(_, keyframe, detection, at) => {
            let update =
                "update detections set position = $4 where map_key = $1 and keyframe = $2 and detection = $3";
            let position = pack([at.x, at.y, at.z]);
            run(
                rows.db().await?,
                sql::query(update).bind(map).bind(keyframe.0).bind(*detection).bind(position),
            )
            .await?;
        }
        Change::DescriptionSet(seq, text) => {
            let update = "update anchors set description_by_hand = $3 where map_key = $1 and anchor = $2";
            let query = sql::query(update).bind(map).bind(seq.0).bind(text.as_deref());
            run(rows.db().await?, query).await?;
        }
        Change::Merged(merge) => add_merge(rows.db().await?, map, merge).await?,
        Change::Parted(merge) => remove_merge(rows.db().await?, map, merge).await?,
        Change::SessionsMerged(merge) => session_merge_rows::add(rows.db().await?, of, merge).await?,
        Change::MergeKept(undo) => session_merge_rows::keep_undo(rows.db().await?, of, undo).await?,
        Change::MergeSettled(session) => session_merge_rows::settle(rows.db().await?, map, *session).await?,
        Change::MergeRevoked(undo) => session_merge_rows::remove(rows.db().await?, map, undo).await?,
        Change::LoopAdded(closed) => add_loop(rows.db().await?, map, closed).await?,
        Change::TwinsFound(twins) => twin_rows::add(rows.db().await?, map, twins).await?,
        Change::TwinsWithdrawn(twins) => twin_rows::remove(rows.db().await?, map, twins).await?,
        Change::ObservationMoved(moved) => {
            changed_sign_rows::move_observation(rows.db().await?, map, moved).await?;
        }
        Change::SignMissed(missed) => changed_sign_rows::miss(rows.db().await?, map, missed).await?,
        Change::MissesWithdrawn(anchor) => {
            changed_sign_rows::withdraw_misses(rows.db().await?, map, *anchor).await?;
        }
        Change::SignRetired(anchor, other) => {
            changed_sign_rows::retire(rows.db().await?, map, *anchor, *other).await?;
        }
        Change::SignReturned(anchor) => changed_sign_rows::restore(rows.db().await?, map, *anchor).await?,
        Change::CropRead(read) => model_rows::add_reading(rows.db().await?, of, read).await?,
        Change::Judged(verdict) => model_rows::add_verdict(rows.db().await?, of, verdict).await?,
        Change::JudgementAdvanced(progress) => {
            judgement_rows::advance(rows.db().await?, map, progress).await?;
        }
        Change::ModelAway(away) => model_rows::set_away(rows.db().await?, map, *away).await?,
        Change::LoopRemoved(id) => {
            let db = rows.db().await?;
            let merges = "delete from anchor_merges where map_key = $1 and loop_id = $2";
            run(db, sql::query(merges).bind(map).bind(id.as_str())).await?;
            let delete = "delete from loops where map_key = $1 and id = $2";
            run(db, sql::query(delete).bind(map).bind(id.as_str())).await?;
        }
    }
    Ok(())
}

async fn add_merge(db: &mut Connection, map: MapKey, merge: &Merge) -> Result<(), StoreError> {
    let by = match &merge.cause {
        MergeCause::Covisible => "",
        MergeCause::Loop(id) => id.as_str(),
    };
    let insert =
        "insert into anchor_merges (map_key, into_anchor, from_anchor, loop_id) values ($1, $2, $3, $4)
        on conflict do nothing";
    run(db, sql::query(insert).bind(map).bind(merge.into.0).bind(merge.from.0).bind(by)).await
}

/// Removes the merge of two anchors that no loop made.
async fn remove_merge(db: &mut Connection, map: MapKey, merge: &Merge) -> Result<(), StoreError> {
    let delete = "delete from anchor_merges
        where map_key = $1 and into_anchor = $2 and from_anchor = $3 and loop_id = ''";
    run(db, sql::query(delete).bind(map).bind(merge.into.0).bind(merge.from.0)).await
}

async fn add_loop(db: &mut Connection, map: MapKey, closed: &Loop) -> Result<(), StoreError> {
    let insert =
        "insert into loops (map_key, id, keyframe, candidate, keyframe_id, candidate_id, query, candidate_from_query)
        values ($1, $2, $3, $4, $5, $6, $7, $8)";
    let similarity = closed.candidate_from_query.as_ref().map(|of| {
        let ([x, y, z], [qx, qy, qz, qw]) = (of.translation_m(), of.rotation_xyzw());
        pack([of.scale(), x, y, z, qx, qy, qz, qw])
    });
    let query = sql::query(insert)
        .bind(map)
        .bind(closed.id.as_str())
        .bind(closed.keyframe.0)
        .bind(closed.candidate.0)
        .bind(closed.keyframe_id.as_str())
        .bind(closed.candidate_id.as_str())
        .bind(&closed.query)
        .bind(similarity);
    run(db, query).await
}
