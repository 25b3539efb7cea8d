//! Traces: what rows say of keyframes that are gone, beside the rows that went with them. An erasure removes it.
//!
//! Events and stored verdicts name keyframes and texts anywhere in them, so they go as a whole. So does the cache of models'
//! answers, which tells no map.

use std::collections::{BTreeMap, BTreeSet};

use super::column::integers_of;
use super::former_value_rows::{packed, unpacked};
use super::judgement_rows;
use super::read::sent_points;
use super::statement::run;
use crate::domain::ids::{PointId, SessionId, SessionSeq};
use crate::semantics::Text;
use crate::store::StoreError;
use crate::store::commit::job::MapKey;
use crate::store::slices::parts::Kind;
use crate::store::sql::{self, Connection};

/// Statements that remove traces. Each has the map's key as its only parameter.
const STATEMENTS: &[&str] = &[
    "delete from loop_queries where map_key = $1",
    "delete from events where map_key = $1",
    "delete from fleet_frames where map_key = $1",
    "delete from replaced_verdicts where map_key = $1",
    "update judgements set at_class = null, at_a = null, at_b = null, at_operation = null
        where map_key = $1 and state <> 'running'",
    // The merge can be revoked no more: what would revoke it has poses of all its keyframes.
    "update session_merges set undo = null where map_key = $1",
    // Loops of keyframes that are gone, and what was said of anchors that are.
    "delete from operations where map_key = $1 and json_extract(body, '$.operation') = 'loop'
        and (cast(json_extract(body, '$.keyframe') as bigint) not in (select keyframe from keyframes where map_key = $1)
            or cast(json_extract(body, '$.candidate') as bigint) not in (select keyframe from keyframes where map_key = $1))
        and json_extract(body, '$.id') not in (select id from loops where map_key = $1)",
    "delete from operations where map_key = $1 and json_extract(body, '$.operation') = 'loop_revoked'
        and json_extract(body, '$.id') not in (select json_extract(body, '$.id') from operations
            where map_key = $1 and json_extract(body, '$.operation') = 'loop')",
    "delete from operations where map_key = $1 and json_extract(body, '$.operation') = 'description'
        and cast(json_extract(body, '$.anchor') as bigint) not in (select anchor from anchors where map_key = $1)",
];

/// The same of what was asked of a session, which is the second parameter: its points, and the plans in its frame.
const OF_SESSION: &[&str] = &[
    "delete from operations where map_key = $1 and json_extract(body, '$.operation') = 'observations'
        and cast(json_extract(body, '$.session') as bigint) = $2",
    "delete from operations where map_key = $1 and json_extract(body, '$.operation') = 'prior_deleted'
        and json_extract(body, '$.id') in (select json_extract(body, '$.id') from operations where map_key = $1
            and json_extract(body, '$.operation') = 'prior' and cast(json_extract(body, '$.frame') as bigint) = $2)
        and json_extract(body, '$.id') not in (select json_extract(body, '$.id') from operations where map_key = $1
            and json_extract(body, '$.operation') = 'prior' and cast(json_extract(body, '$.frame') as bigint) <> $2)",
    "delete from operations where map_key = $1 and json_extract(body, '$.operation') = 'prior'
        and cast(json_extract(body, '$.frame') as bigint) = $2",
];

/// Removes the traces of keyframes that are gone from a map, and of sessions that are erased with them: those are named with all that
/// any version of the map knew them to be merged with.
pub(in crate::store) async fn remove(
    db: &mut Connection,
    map: MapKey,
    sessions: &[SessionId],
) -> Result<(), StoreError> {
    for statement in STATEMENTS {
        run(db, sql::query(*statement).bind(map)).await?;
    }
    let mut erased = BTreeSet::new();
    for session in sessions {
        // It may have asked a release without a keyframe in it.
        let delete = "delete from release_uses where map_key = $1 and session = $2";
        run(db, sql::query(delete).bind(map).bind(session.as_str())).await?;
        erased.extend(forget_session(db, map, session).await?);
    }
    if !sessions.is_empty() {
        forget_names_in_loops(db, map).await?;
    }
    remove_former_values(db, map, &erased).await?;
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
    let found: Option<u32> =
        sql::query_scalar(select).bind(map).bind(session.as_str()).fetch_optional(&mut *db).await?;
    let Some(number) = found else { return Ok(None) };
    let mut name = format!("erased-{number}");
    let is_taken = "select exists (select 1 from sessions where map_key = $1 and id = $2)";
    while sql::query_scalar::<bool>(is_taken).bind(map).bind(&name).fetch_one(&mut *db).await? {
        name.push('-');
    }
    // A map's figures count the names of its sessions.
    let update = "update maps set bytes = bytes - octet_length($2) + octet_length($3) where map_key = $1";
    run(db, sql::query(update).bind(map).bind(session.as_str()).bind(&name)).await?;
    let update = "update sessions set id = $3 where map_key = $1 and session = $2";
    run(db, sql::query(update).bind(map).bind(number).bind(name)).await?;
    for delete in OF_SESSION {
        run(db, sql::query(*delete).bind(map).bind(number)).await?;
    }
    Ok(Some(SessionSeq(number)))
}

/// Removes replaced poses and positions of keyframes that are gone, and of map points that no other keyframe of their session was
/// sent with. Clients number the points of each session from 0.
async fn remove_former_values(
    db: &mut Connection,
    map: MapKey,
    erased: &BTreeSet<SessionSeq>,
) -> Result<(), StoreError> {
    let select = "select version, part, kind, entries from former_values where map_key = $1";
    let parts: Vec<(i64, u32, String, Vec<u8>)> = sql::query_as(select).bind(map).fetch_all(&mut *db).await?;
    if parts.is_empty() {
        return Ok(());
    }
    let mut keyframes = BTreeSet::new();
    let mut points: BTreeSet<(SessionSeq, PointId)> = BTreeSet::new();
    let select = "select session, into_session from session_merges where map_key = $1 order by version";
    let merges: Vec<(u32, u32)> = sql::query_as(select).bind(map).fetch_all(&mut *db).await?;
    let whole = |session: SessionSeq| {
        merges.iter().fold(session, |now, (from, into)| if now.0 == *from { SessionSeq(*into) } else { now })
    };
    let select = "select keyframe, session, observes, sent_points from keyframes where map_key = $1";
    for row in sql::query(select).bind(map).fetch_all(&mut *db).await? {
        keyframes.insert(row.try_get::<u32, _>("keyframe")?);
        let session = whole(SessionSeq(row.try_get("session")?));
        points.extend(sent_points(&row)?.into_iter().map(|point| (session, point)));
        if !merges.is_empty() {
            // After a merge of sessions points have other numbers than those they were sent with.
            let observed: Vec<PointId> = integers_of(row.try_get("observes")?)?;
            points.extend(observed.into_iter().map(|point| (session, point)));
        }
    }
    let held = with_those_that_held(db, map, erased).await?;
    for (version, part, kind, entries) in parts {
        let mut former = unpacked(Kind::from_name(&kind)?, &entries)?;
        let stays = |session: SessionSeq, point| {
            !held.contains(&session) && points.contains(&(whole(session), point))
        };
        former.poses.retain(|(keyframe, _)| keyframes.contains(&keyframe.0));
        former.positions.retain(|(keyframe, ..)| keyframes.contains(&keyframe.0));
        former.points.retain(|(session, point, _)| stays(*session, *point));
        former.forgotten.retain(|(session, point, _)| stays(*session, *point));
        // One part holds one kind, and never more than before.
        let left = packed(&former).pop().map(|part| part.entries).unwrap_or_default();
        if left.is_empty() {
            let delete = "delete from former_values where map_key = $1 and version = $2 and part = $3";
            run(db, sql::query(delete).bind(map).bind(version).bind(part)).await?;
        } else if left != entries {
            let update =
                "update former_values set entries = $4 where map_key = $1 and version = $2 and part = $3";
            run(db, sql::query(update).bind(map).bind(version).bind(part).bind(left)).await?;
        }
    }
    Ok(())
}

/// Returns erased sessions with those that they were merged into for a while: former positions of these are of either.
async fn with_those_that_held(
    db: &mut Connection,
    map: MapKey,
    erased: &BTreeSet<SessionSeq>,
) -> Result<BTreeSet<SessionSeq>, StoreError> {
    let select = "select cast(json_extract(body, '$.session') as bigint), cast(json_extract(body, '$.into') as bigint)
        from operations where map_key = $1 and json_extract(body, '$.operation') = 'merge_sessions' order by version";
    let merges: Vec<(i64, i64)> = sql::query_as(select).bind(map).fetch_all(db).await?;
    let mut held: BTreeSet<i64> = erased.iter().map(|session| i64::from(session.0)).collect();
    for (session, into) in merges {
        if held.contains(&session) {
            held.insert(into);
        }
    }
    Ok(held.into_iter().map(|session| SessionSeq(session as u32)).collect())
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
        run(db, sql::query(delete).bind(map).bind(operation).bind(class).bind(a).bind(b)).await?;
    }
    Ok(())
}
