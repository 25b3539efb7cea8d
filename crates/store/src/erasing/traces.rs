//! Traces: what rows say of keyframes that are gone, beside the rows that went with them. An erasure removes it.
//!
//! Events and stored verdicts name keyframes and texts anywhere in them, so they go as a whole. So does the cache of models'
//! answers, which tells no map.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};

use revisit_core::domain::change::Change;
use revisit_core::domain::ids::{AnchorSeq, KeyframeSeq, LoopId, PointId, SessionId, SessionSeq};
use revisit_core::semantics::Text;

use crate::StoreError;
use crate::columns::column::integers_of;
use crate::loading::read::sent_points;
use crate::log::entry::Entry;
use crate::log::log_rows::{self, FIRST_PART};
use crate::map_key::MapKey;
use crate::rows::judgement_rows;
use crate::sql::run;
use crate::sql::{self, Connection};

/// Statements that remove traces. Each has the map's key as its only parameter.
const STATEMENTS: &[&str] = &[
    "delete from loop_queries where map_key = $1",
    "delete from events where map_key = $1",
    "delete from fleet_frames where map_key = $1",
    "delete from versions where map_key = $1 and part < 0",
    "update judgements set at_class = null, at_a = null, at_b = null, at_operation = null
        where map_key = $1 and state <> 'running'",
    // The merge can be revoked no more: what would revoke it has poses of all its keyframes.
    "update session_merges set undo = null where map_key = $1",
];

/// Removes the traces of keyframes that are gone from a map, and of sessions that are erased with them: those are named with all that
/// any version of the map knew them to be merged with.
pub(crate) async fn remove(
    db: &mut Connection,
    map: MapKey,
    sessions: &[SessionId],
) -> Result<(), StoreError> {
    for statement in STATEMENTS {
        run(db, sql::statement(*statement, (map,))).await?;
    }
    let mut erased = BTreeSet::new();
    for session in sessions {
        // It may have asked a release without a keyframe in it.
        let delete = "delete from release_uses where map_key = $1 and session = $2";
        run(db, sql::statement(delete, (map, session))).await?;
        erased.extend(forget_session(db, map, session).await?);
    }
    if !sessions.is_empty() {
        forget_names_in_loops(db, map).await?;
    }
    forget_in_log(db, map, erased).await?;
    remove_verdicts(db, map).await?;
    judgement_rows::step_back(db, map).await?;
    run(db, sql::query("delete from model_answers")).await
}

/// Takes the names of keyframes that are gone from loops, and what was measured between them: which session they were of is not
/// known any more. Nothing else reads either.
async fn forget_names_in_loops(db: &mut Connection, map: MapKey) -> Result<(), StoreError> {
    for (number, name) in [("keyframe", "keyframe_id"), ("candidate", "candidate_id")] {
        let gone =
            format!("map_key = $1 and {number} not in (select keyframe from keyframes where map_key = $1)");
        // A map's figures count the names in its loops.
        let update = format!(
            "update maps set bytes = bytes - coalesce((select sum(octet_length({name}) - octet_length('erased-' || {number}))
                from loops where {gone}), 0) where map_key = $1"
        );
        run(db, sql::query(sqlx::AssertSqlSafe(update)).bind(map)).await?;
        let update = format!(
            "update loops set {name} = 'erased-' || {number}, candidate_from_query = null where {gone}"
        );
        run(db, sql::query(sqlx::AssertSqlSafe(update)).bind(map)).await?;
    }
    Ok(())
}

/// Gives a session without keyframes another name, and returns its number. Its row stays, for numbers are given once.
async fn forget_session(
    db: &mut Connection,
    map: MapKey,
    session: &SessionId,
) -> Result<Option<SessionSeq>, StoreError> {
    let select = "select session from sessions s where map_key = $1 and id = $2
        and not exists (select 1 from keyframes k where k.map_key = $1 and k.session = s.session)
        and not exists (select 1 from prior_anchors p where p.map_key = $1 and p.frame = s.session)";
    let found = sql::query_scalar(select).bind(map).bind(session).fetch_optional(&mut *db).await?;
    let Some(SessionSeq(number)) = found else { return Ok(None) };
    let mut name = format!("erased-{number}");
    let is_taken = "select exists (select 1 from sessions where map_key = $1 and id = $2)";
    while sql::query_scalar::<bool>(is_taken).bind(map).bind(&name).fetch_one(&mut *db).await? {
        name.push('-');
    }
    // A map's figures count the names of its sessions.
    let update = "update maps set bytes = bytes - octet_length($2) + octet_length($3) where map_key = $1";
    run(db, sql::statement(update, (map, session, &name))).await?;
    let update = "update sessions set id = $3 where map_key = $1 and session = $2";
    run(db, sql::statement(update, (map, number, name))).await?;
    Ok(Some(SessionSeq(number)))
}

/// The keyframes, anchors, points and loops that the log may still name.
struct Standing {
    keyframes: BTreeSet<KeyframeSeq>,
    anchors: BTreeSet<AnchorSeq>,
    /// Map points that a keyframe was sent with, by the session that theirs is merged into by now. Clients number the points of each
    /// session from 0.
    points: BTreeSet<(SessionSeq, PointId)>,
    /// Merges that stand, in their order.
    merges: Vec<(SessionSeq, SessionSeq)>,
    erased: BTreeSet<SessionSeq>,
    /// Those, and the sessions that they were merged into for a while: former positions of these are of either.
    held: BTreeSet<SessionSeq>,
    /// Loops of which the log tells.
    loops: BTreeSet<LoopId>,
}

impl Standing {
    async fn of(db: &mut Connection, map: MapKey, erased: BTreeSet<SessionSeq>) -> Result<Self, StoreError> {
        let select = "select anchor from anchors where map_key = $1";
        let anchors = sql::query_scalar(select).bind(map).fetch_all(&mut *db).await?;
        let select = "select session, into_session from session_merges where map_key = $1 order by version";
        let merges = sql::query_as(select).bind(map).fetch_all(&mut *db).await?;
        let mut this = Self {
            keyframes: BTreeSet::new(),
            anchors: anchors.into_iter().collect(),
            points: BTreeSet::new(),
            merges,
            held: erased.clone(),
            erased,
            loops: BTreeSet::new(),
        };
        let select = "select keyframe, session, observes, sent_points from keyframes where map_key = $1";
        for row in sql::query(select).bind(map).fetch_all(&mut *db).await? {
            this.keyframes.insert(row.try_get("keyframe")?);
            let session = this.whole(row.try_get("session")?);
            this.points.extend(sent_points(&row)?.into_iter().map(|point| (session, point)));
            if !this.merges.is_empty() {
                // After a merge of sessions points have other numbers than those they were sent with.
                let observed: Vec<PointId> = integers_of(row.try_get("observes")?)?;
                this.points.extend(observed.into_iter().map(|point| (session, point)));
            }
        }
        Ok(this)
    }

    /// Returns the session that one is merged into by now.
    fn whole(&self, session: SessionSeq) -> SessionSeq {
        self.merges.iter().fold(session, |now, (from, into)| if now == *from { *into } else { now })
    }

    fn has_point(&self, session: SessionSeq, point: PointId) -> bool {
        !self.held.contains(&session) && self.points.contains(&(self.whole(session), point))
    }

    /// Takes a merge that was ever made.
    fn note_merge(&mut self, change: &Change) {
        if let Change::SessionsMerged(merge) = change
            && self.held.contains(&merge.session)
        {
            self.held.insert(merge.into);
        }
    }

    /// Whether the log goes on telling a change: asked of all, in their order.
    fn keeps(&mut self, change: &Change, of: &[Cow<'_, Change>]) -> bool {
        match change {
            Change::PoseSet(keyframe, _) => self.keyframes.contains(keyframe),
            Change::PointSet(session, point, _) => self.has_point(*session, *point),
            Change::LoopAdded(closed) => {
                let stands = [closed.keyframe, closed.candidate].iter().all(|of| self.keyframes.contains(of));
                stands && { self.loops.insert(closed.id.clone()) }
            }
            Change::LoopRemoved(id) => self.loops.remove(id),
            Change::DescriptionSet(anchor, _) => self.anchors.contains(anchor),
            Change::ObservationsSent(update) => !self.erased.contains(&update.session),
            Change::PriorSet(_, prior) => !self.erased.contains(&prior.frame),
            Change::AnchorAdded(anchor, _) => !of.iter().any(|change| {
                matches!(&**change, Change::PriorSet(of, prior) if of == anchor && self.erased.contains(&prior.frame))
            }),
            _ => true,
        }
    }

    /// Takes out of an entry what names something that is gone.
    fn forget(&mut self, entry: &mut Entry<'static>) {
        let all = std::mem::take(&mut entry.changes);
        let stays: Vec<bool> = all.iter().map(|change| self.keeps(change, &all)).collect();
        entry.changes =
            all.into_iter().zip(stays).filter_map(|(change, stays)| stays.then_some(change)).collect();
        let former = entry.former.to_mut();
        former.poses.retain(|(keyframe, _)| self.keyframes.contains(keyframe));
        former.points.retain(|(session, point, _)| self.has_point(*session, *point));
        former.forgotten.retain(|(session, point, _)| self.has_point(*session, *point));
    }
}

/// Takes out of the log what names keyframes, points and sessions that are gone.
async fn forget_in_log(
    db: &mut Connection,
    map: MapKey,
    erased: BTreeSet<SessionSeq>,
) -> Result<(), StoreError> {
    let mut standing = Standing::of(db, map, erased).await?;
    let start = (0, i64::MIN);
    let mut last = start;
    while let Some(row) = log_rows::row_after(db, map, last).await? {
        last = (row.version, row.part);
        Entry::of(&row.body)?.changes.iter().for_each(|change| standing.note_merge(change));
    }
    last = start;
    let mut counts = 0;
    while let Some(row) = log_rows::row_after(db, map, last).await? {
        last = (row.version, row.part);
        if row.part == FIRST_PART {
            counts = row.version;
        }
        let mut entry = Entry::of(&row.body)?;
        standing.forget(&mut entry);
        // Without its first part the others of a version count for nothing, nor do they in the database.
        let is_left = row.part == FIRST_PART || !entry.is_empty() && counts == row.version;
        let body = if is_left { Some(entry.to_bytes()?) } else { None };
        if body.as_ref() != Some(&row.body) {
            log_rows::replace(db, map, &row, body).await?;
        }
    }
    Ok(())
}

/// Removes verdicts of models about texts that nothing in the map carries any more.
async fn remove_verdicts(db: &mut Connection, map: MapKey) -> Result<(), StoreError> {
    let select = "select operation, class, a, b, text from model_verdicts where map_key = $1";
    let verdicts: Vec<(String, String, String, String, Option<String>)> =
        sql::query_as(select).bind(map).fetch_all(&mut *db).await?;
    if verdicts.is_empty() {
        return Ok(());
    }
    let select = "select coalesce(description, text) from detections where map_key = $1 and coalesce(description, text) is not null
        union select text from detections where map_key = $1 and text is not null
        union select text from model_readings where map_key = $1
        union select description_by_hand from anchors where map_key = $1 and description_by_hand is not null
        union select description from prior_anchors where map_key = $1";
    let texts: Vec<String> = sql::query_scalar(select).bind(map).fetch_all(&mut *db).await?;
    let normal = |text: &str| Text::parse(text).normalised().to_owned();
    let mut carried: BTreeSet<String> = texts.iter().map(|text| normal(text)).collect();
    let mut left: BTreeMap<_, _> =
        verdicts.into_iter().map(|(operation, class, a, b, text)| ((operation, class, a, b), text)).collect();
    // A merged text may be merged again.
    loop {
        let is_carried =
            |a: &String, b: &String| carried.contains(a) && (b.is_empty() || carried.contains(b));
        let found: Vec<_> = left.keys().filter(|(_, _, a, b)| is_carried(a, b)).cloned().collect();
        if found.is_empty() {
            break;
        }
        for key in found {
            carried.extend(left.remove(&key).flatten().map(|text| normal(&text)));
        }
    }
    for (operation, class, a, b) in left.into_keys() {
        let delete = "delete from model_verdicts
            where map_key = $1 and operation = $2 and class = $3 and a = $4 and b = $5";
        run(db, sql::statement(delete, (map, operation, class, a, b))).await?;
    }
    Ok(())
}
