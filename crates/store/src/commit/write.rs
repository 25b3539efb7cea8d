//! From changes to rows.

use std::borrow::Cow;

use revisit_core::domain::change::{Change, Loop, Merge, MergeCause};
use revisit_core::domain::ids::{AnchorSeq, LoopId};

use super::additions::Additions;
use crate::StoreError;
use crate::commit::said::said;
use crate::copies::copied_rows;
use crate::copies::transferred_rows;
use crate::erasing::erasure_rows;
use crate::erasing::retention_rows;
use crate::erasing::traces;
use crate::erasing::unsaid;
use crate::jobs::job::{Batch, ErasureStep, Job};
use crate::loading::deferred;
use crate::log::entry::Entry;
use crate::log::log_rows::{self, FIRST_PART};
use crate::log::parts::{Kind, Part, is_ordered};
use crate::map_key::MapKey;
use crate::postgres::change_log;
use crate::rows::keyframe_rows::{Arrived, detections};
use crate::rows::verdict_rows::KeptQuery;
use crate::rows::{
    changed_sign_rows, frame_rows, judgement_rows, key_rows, keyframe_rows, map_rows, model_rows,
    observation_rows, point_blocks, prior_rows, release_rows, session_merge_rows, twin_rows,
};
use crate::slices::deletion;
use crate::sql::run;
use crate::sql::{self, Connection, Engine, Query};

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
pub(crate) async fn execute<'j>(
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
            run(rows.db().await?, sql::statement(update, (*map, *next_event))).await?;
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
            run(db, erasure_rows::count(of, (*keyframes, releases.len()))).await?;
            for release in releases {
                run(db, release_rows::count_erasure(*release)).await?;
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
        ErasureStep::Removed => run(db, erasure_rows::removed(of)).await,
        ErasureStep::Done(at) => run(db, erasure_rows::done(of, *at)).await,
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
    crate::log::entry::tests::expect_form(&batch.changes, &batch.former);
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

async fn apply<'j>(rows: &mut Rows<'_, 'j>, batch: &'j Batch, change: &'j Change) -> Result<(), StoreError> {
    let (map, version) = (batch.map, batch.version);
    let of = (map, version);
    let statement = match change {
        // Gathered, and written with those of other jobs.
        Change::SessionAdded(seq, id) => {
            rows.gathered.sessions.push((map, *seq, id));
            return Ok(());
        }
        Change::KeyframeAdded(keyframe, bow) => {
            let new = batch.new_keyframe.as_ref();
            let new = new.ok_or_else(|| StoreError::corrupt("a keyframe without its rows"))?;
            rows.gathered.keyframes.push(Arrived { map, version, keyframe, bow, rows: new });
            return Ok(());
        }
        Change::AnchorAdded(seq, class) => {
            rows.gathered.anchors.push((map, *seq, class));
            return Ok(());
        }
        Change::AnchorTouched(seq, version) => {
            rows.gathered.touched.insert((map, *seq), *version);
            return Ok(());
        }
        Change::PointSet(session, id, at) => {
            rows.gathered.points.push((map, *session, *id, *at));
            return Ok(());
        }
        // Written with the keyframe's rows, or to the log alone.
        Change::GlobalDescriptorSet(..)
        | Change::Observed(..)
        | Change::OutcomeSet(..)
        | Change::ObservationsSent(_) => return Ok(()),
        // More than one statement.
        Change::PartsForgotten(parts) => {
            return retention_rows::forget_parts(rows.db().await?, map, parts).await;
        }
        Change::PointsForgotten(session, ids) => {
            let points = ids.iter().map(|id| (*session, *id, None));
            return point_blocks::change(rows.db().await?, map, points).await;
        }
        Change::AnchorRemoved(seq) => return remove_anchor(rows.db().await?, of, *seq).await,
        Change::JudgementAdvanced(progress) => {
            return judgement_rows::advance(rows.db().await?, map, progress).await;
        }
        Change::LoopRemoved(id) => return remove_loop(rows.db().await?, map, id).await,

        Change::MapSet(properties) => map_rows::set_properties(map, properties)?,
        Change::VocabularySet(name) => {
            sql::statement("update maps set vocabulary = $2 where map_key = $1", (map, &**name))
        }
        Change::KeyframeRemoved(seq, _) => {
            sql::statement("delete from keyframes where map_key = $1 and keyframe = $2", (map, *seq))
        }
        Change::PoseSet(seq, pose) => keyframe_rows::set_pose(map, *seq, pose),
        Change::PointsOfKeyframeSet(points) => observation_rows::set_points_of_keyframe(map, points),
        Change::PointsOfDetectionSet(_, keyframe, detection, points) => {
            observation_rows::set_points_of_detection(map, (*keyframe, *detection), points)
        }
        Change::PriorSet(seq, prior) => prior_rows::add(map, *seq, prior),
        Change::DescriptionSet(seq, text) => {
            let update = "update anchors set description_by_hand = $3 where map_key = $1 and anchor = $2";
            sql::statement(update, (map, *seq, text.as_deref()))
        }
        Change::Merged(merge) => add_merge(map, merge),
        Change::Parted(merge) => remove_merge(map, merge),
        Change::SessionsMerged(merge) => session_merge_rows::add(of, merge),
        Change::MergeKept(undo) => session_merge_rows::keep_undo(of, undo)?,
        Change::MergeSettled(session) => session_merge_rows::settle(map, *session),
        Change::MergeRevoked(undo) => session_merge_rows::remove(map, undo),
        Change::LoopAdded(closed) => add_loop(map, closed),
        Change::TwinsFound(twins) => twin_rows::add(map, twins),
        Change::TwinsWithdrawn(twins) => twin_rows::remove(map, twins),
        Change::ObservationMoved(moved) => changed_sign_rows::move_observation(map, moved),
        Change::SignMissed(missed) => changed_sign_rows::miss(map, missed),
        Change::MissesWithdrawn(anchor) => changed_sign_rows::withdraw_misses(map, *anchor),
        Change::SignRetired(anchor, other) => changed_sign_rows::retire(map, *anchor, *other),
        Change::SignReturned(anchor) => changed_sign_rows::restore(map, *anchor),
        Change::CropRead(read) => model_rows::add_reading(of, read)?,
        Change::Judged(verdict) => model_rows::add_verdict(of, verdict),
        Change::ModelAway(away) => {
            sql::statement("update maps set models_away = $2 where map_key = $1", (map, *away))
        }
    };
    run(rows.db().await?, statement).await
}

async fn remove_anchor(
    db: &mut Connection,
    (map, version): (MapKey, u64),
    anchor: AnchorSeq,
) -> Result<(), StoreError> {
    let orphan = "update detections set anchor = null, outcome = 'anchor_deleted', deleted_anchor = $2,
        deleted_in = $3 where map_key = $1 and anchor = $2";
    run(db, sql::statement(orphan, (map, anchor, version))).await?;
    run(db, prior_rows::remove(map, anchor)).await?;
    run(db, sql::statement("delete from anchors where map_key = $1 and anchor = $2", (map, anchor))).await
}

async fn remove_loop(db: &mut Connection, map: MapKey, id: &LoopId) -> Result<(), StoreError> {
    let merges = "delete from anchor_merges where map_key = $1 and loop_id = $2";
    run(db, sql::statement(merges, (map, id))).await?;
    run(db, sql::statement("delete from loops where map_key = $1 and id = $2", (map, id))).await
}

fn add_merge(map: MapKey, merge: &Merge) -> Query {
    let by = match &merge.cause {
        MergeCause::Covisible => "",
        MergeCause::Loop(id) => id.as_str(),
    };
    let insert =
        "insert into anchor_merges (map_key, into_anchor, from_anchor, loop_id) values ($1, $2, $3, $4)
        on conflict do nothing";
    sql::statement(insert, (map, merge.into, merge.from, by))
}

/// Removes the merge of two anchors that no loop made.
fn remove_merge(map: MapKey, merge: &Merge) -> Query {
    let delete = "delete from anchor_merges
        where map_key = $1 and into_anchor = $2 and from_anchor = $3 and loop_id = ''";
    sql::statement(delete, (map, merge.into, merge.from))
}

fn add_loop(map: MapKey, closed: &Loop) -> Query {
    let Loop { id, keyframe, candidate, keyframe_id, candidate_id, query, candidate_from_query } = closed;
    let insert =
        "insert into loops (map_key, id, keyframe, candidate, keyframe_id, candidate_id, query, candidate_from_query)
        values ($1, $2, $3, $4, $5, $6, $7, $8)";
    let similarity = candidate_from_query.as_ref();
    sql::statement(insert, (map, id, *keyframe, *candidate, keyframe_id, candidate_id, query, similarity))
}
