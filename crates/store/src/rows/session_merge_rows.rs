//! Merges of sessions, as rows. A keyframe's row keeps the session that was sent; these say which it is of by now.

use revisit_core::domain::change::{Change, SessionMerge};
use revisit_core::domain::former::FormerValues;
use revisit_core::domain::ids::{KeyframeSeq, SessionSeq};
use revisit_core::domain::session_merge::MergeUndo;

use crate::StoreError;
use crate::columns::json;
use crate::log::log_rows;
use crate::map_key::MapKey;
use crate::sql::{self, Connection, Query};

/// A merge as far as it says which session a keyframe is of.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MergedSession {
    pub session: SessionSeq,
    pub into: SessionSeq,
    pub next_keyframe: KeyframeSeq,
    /// Whether it can be revoked.
    pub is_open: bool,
}

/// Returns the session that a keyframe is of after these merges, in their order.
pub(crate) fn session_after(merges: &[MergedSession], keyframe: KeyframeSeq, sent: SessionSeq) -> SessionSeq {
    merges.iter().fold(sent, |session, merge| {
        if session == merge.session && keyframe < merge.next_keyframe { merge.into } else { session }
    })
}

/// Adds a merge.
pub(crate) fn add((map, version): (MapKey, u64), merge: &SessionMerge) -> Query {
    let insert = "insert into session_merges (map_key, version, session, into_session, next_keyframe)
        values ($1, $2, $3, $4, $5)";
    sql::statement(insert, (map, version, merge.session, merge.into, merge.next_keyframe))
}

/// Keeps what revokes a merge.
pub(crate) fn keep_undo((map, version): (MapKey, u64), undo: &MergeUndo) -> Result<Query, StoreError> {
    let update = "update session_merges set undo = $3 where map_key = $1 and version = $2";
    Ok(sql::statement(update, (map, version, json::text(undo)?)))
}

/// The merge of a session can be revoked no more.
pub(crate) fn settle(map: MapKey, session: SessionSeq) -> Query {
    let update = "update session_merges set undo = null
        where map_key = $1 and session = $2 and undo is not null";
    sql::statement(update, (map, session))
}

/// Removes a merge that was revoked.
pub(crate) fn remove(map: MapKey, undo: &MergeUndo) -> Query {
    let delete = "delete from session_merges where map_key = $1 and session = $2 and next_keyframe = $3
        and undo is not null";
    sql::statement(delete, (map, undo.session, undo.next_keyframe))
}

/// Returns the merges of a map, in their order.
pub(crate) async fn all(db: &mut Connection, map: MapKey) -> Result<Vec<MergedSession>, StoreError> {
    let select = "select session, into_session, next_keyframe, undo is not null from session_merges
        where map_key = $1 order by version";
    let rows: Vec<(_, _, _, _)> = sql::query_as(select).bind(map).fetch_all(db).await?;
    let merge =
        |(session, into, next_keyframe, is_open)| MergedSession { session, into, next_keyframe, is_open };
    Ok(rows.into_iter().map(merge).collect())
}

/// Returns the changes that tell an index which of these merges can be revoked.
pub(crate) fn open(merges: &[MergedSession]) -> Vec<Change> {
    let open = merges.iter().filter(|merge| merge.is_open);
    let kept = open.map(|merge| MergeUndo::naming(merge.session, merge.into, merge.next_keyframe));
    kept.map(|undo| Change::MergeKept(Box::new(undo))).collect()
}

/// Returns what revokes the merge of a session, with the values that it replaced; `None` if none can be revoked.
pub(crate) async fn undo(
    db: &mut Connection,
    map: MapKey,
    session: SessionSeq,
) -> Result<Option<(MergeUndo, FormerValues)>, StoreError> {
    let select = "select version, undo from session_merges
        where map_key = $1 and session = $2 and undo is not null";
    let query = sql::query_as(select).bind(map).bind(session);
    let found: Option<(u64, String)> = query.fetch_optional(&mut *db).await?;
    let Some((version, body)) = found else { return Ok(None) };
    let mut former = FormerValues::default();
    for entry in log_rows::of_version(db, map, version).await? {
        former.extend(entry.former.into_owned());
    }
    Ok(Some((json::value(&body)?, former)))
}
