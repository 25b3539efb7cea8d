//! Deferred changes: poses and points that are committed as packed lists, and reach their rows later, in slices.
//!
//! A correction of 100,000 poses would rewrite 100,000 rows in one transaction, and every other map's writes would wait
//! for it. Instead it is staged in parts, which may share groups with other jobs and count for nothing yet. One small
//! transaction then gives them their row of `deferred_changes`, with the map's new version: from there on they are
//! facts. [`super::fold`] brings them into the rows; until then a map is loaded with them on top of its rows.
//!
//! Later changes of the same kinds must not overtake them, so they are deferred too while a map has any. What is folded is a
//! plain assignment: folding an entry twice changes nothing.

use super::parts::{Kind, Part, cut};
use crate::domain::change::Change;
use crate::domain::ids::{AnchorSeq, KeyframeSeq, SessionSeq};
use crate::geometry::{Point3, Pose};
use crate::store::StoreError;
use crate::store::commit::cost;
use crate::store::commit::job::{Batch, Job, MapKey};
use crate::store::rows::blob::{pack, unpack};
use crate::store::rows::former_value_rows;
use crate::store::rows::keyframe_rows::pose_blob;
use crate::store::rows::statement::run;
use crate::store::rows::validate::Known;
use crate::store::sql::{self, Connection};

/// What a batch's changes of these kinds may cost if written at once, in microseconds; above it they are deferred.
const DIRECT_US: u64 = if cfg!(test) { 100 } else { 20_000 };

/// Whether a change must not overtake deferred ones. Of an anchor's versions the largest counts, in whatever order they come.
pub(in crate::store) fn is_ordered(change: &Change) -> bool {
    Kind::of(change).is_some_and(|kind| kind != Kind::Touched)
}

/// Returns the jobs that stage a batch's large changes, if it has any, and the one that commits it.
pub(in crate::store) fn staged(job: Job) -> Vec<Job> {
    let Job::Change(mut batch) = job else { return vec![job] };
    let cost: u64 = batch.changes.iter().filter(|c| Kind::of(c).is_some()).map(cost::of_change).sum();
    if cost <= DIRECT_US {
        return vec![Job::Change(batch)];
    }
    let frees_space = Job::batch_frees_space(&batch);
    let (map, version) = (batch.map, batch.version);
    let mut parts = packed(&batch.changes);
    parts.extend(former_value_rows::packed(&std::mem::take(&mut batch.former)));
    batch.changes.retain(|change| Kind::of(change).is_none());
    // The log would tell a part of it only.
    batch.is_followed = false;
    let count = parts.len() as u32;
    let stage = |(number, part)| Job::Stage { map, version, number, part, frees_space };
    let mut jobs: Vec<Job> = (0..).zip(parts).map(stage).collect();
    jobs.push(Job::ChangeStaged { batch, parts: count, frees_space });
    jobs
}

/// Packs those changes that may be deferred; kinds do not depend on each other, and each keeps its order.
fn packed<'c>(changes: impl IntoIterator<Item = &'c Change> + Clone) -> Vec<Part> {
    let mut parts = Vec::new();
    for kind in Kind::ALL {
        let mut entries = Vec::new();
        for change in changes.clone().into_iter().filter(|change| Kind::of(change) == Some(kind)) {
            pack_change(change, &mut entries);
        }
        parts.extend(cut(kind, &entries));
    }
    parts
}

fn pack_change(change: &Change, to: &mut Vec<u8>) {
    match change {
        Change::PoseSet(keyframe, pose) => {
            to.extend(pack([keyframe.0]));
            to.extend(pose_blob(pose));
        }
        Change::PointSet(session, id, at) => {
            to.extend(pack([(session.0, *id)]));
            to.extend(pack([at.x, at.y, at.z]));
        }
        Change::PointsForgotten(session, ids) => to.extend(pack(ids.iter().map(|id| (session.0, *id)))),
        Change::PositionSet(anchor, keyframe, detection, at) => {
            to.extend(pack([anchor.0, keyframe.0, u32::from(*detection)]));
            to.extend(pack([at.x, at.y, at.z]));
        }
        Change::AnchorTouched(anchor, version) => to.extend(pack([(anchor.0, *version as i64)])),
        _ => {}
    }
}

/// Returns the changes that a packed list says; none for history.
pub(in crate::store) fn unpacked(kind: Kind, entries: &[u8]) -> Result<Vec<Change>, StoreError> {
    let point = |[x, y, z]: [f64; 3]| Point3::new(x, y, z);
    Ok(match kind {
        Kind::Poses => {
            let pose = |(keyframe, [x, y, z, qx, qy, qz, qw]): (u32, [f64; 7])| {
                Change::PoseSet(KeyframeSeq(keyframe), Pose::from_stored([x, y, z], [qx, qy, qz, qw]))
            };
            unpack(entries)?.into_iter().map(pose).collect()
        }
        Kind::Points => {
            let set = |((session, id), at)| Change::PointSet(SessionSeq(session), id, point(at));
            unpack::<((u32, i64), [f64; 3])>(entries)?.into_iter().map(set).collect()
        }
        Kind::Forgotten => {
            let forgotten = |(session, id)| Change::PointsForgotten(SessionSeq(session), [id].into());
            unpack::<(u32, i64)>(entries)?.into_iter().map(forgotten).collect()
        }
        Kind::Positions => {
            let moved = |([anchor, keyframe, detection], at): ([u32; 3], [f64; 3])| {
                let detection =
                    u16::try_from(detection).map_err(|_| StoreError::corrupt("a detection's number"))?;
                Ok(Change::PositionSet(AnchorSeq(anchor), KeyframeSeq(keyframe), detection, point(at)))
            };
            unpack(entries)?.into_iter().map(moved).collect::<Result<_, StoreError>>()?
        }
        Kind::Touched => {
            let touched =
                |(anchor, version): (u32, i64)| Change::AnchorTouched(AnchorSeq(anchor), version as u64);
            unpack(entries)?.into_iter().map(touched).collect()
        }
        Kind::FormerPoses | Kind::FormerPoints | Kind::FormerForgotten | Kind::FormerPositions => Vec::new(),
    })
}

/// Writes a part that counts for nothing until its version has its row.
pub(in crate::store) async fn stage(
    db: &mut Connection,
    map: MapKey,
    version: u64,
    number: u32,
    part: &Part,
) -> Result<(), StoreError> {
    if number == 0 {
        // An earlier attempt at this version may have failed halfway.
        let leftover = "delete from deferred_parts where map_key = $1 and version >= $2";
        run(db, sql::query(leftover).bind(map).bind(version as i64)).await?;
    }
    let insert =
        "insert into deferred_parts (map_key, version, part, kind, entries) values ($1, $2, $3, $4, $5)";
    let query = sql::query(insert).bind(map).bind(version as i64).bind(number);
    run(db, query.bind(part.kind.as_str()).bind(&part.entries)).await
}

/// Makes the staged parts of a version count.
pub(in crate::store) async fn commit_staged(
    db: &mut Connection,
    map: MapKey,
    version: u64,
    parts: u32,
) -> Result<(), StoreError> {
    let insert = "insert into deferred_changes (map_key, version, parts, part, entries_done) values ($1, $2, $3, 0, 0)";
    run(db, sql::query(insert).bind(map).bind(version as i64).bind(parts)).await
}

/// Whether changes of a map wait for their rows.
pub(in crate::store) async fn any(db: &mut Connection, map: MapKey) -> Result<bool, StoreError> {
    let select = "select exists (select 1 from deferred_changes where map_key = $1)";
    Ok(sql::query_scalar(select).bind(map).fetch_one(db).await?)
}

/// Defers the ordered changes of a batch behind those that wait already.
pub(in crate::store) async fn defer(db: &mut Connection, batch: &Batch) -> Result<(), StoreError> {
    let parts = packed(batch.changes.iter().filter(|change| is_ordered(change)));
    for (number, part) in (0..).zip(&parts) {
        stage(db, batch.map, batch.version, number, part).await?;
    }
    commit_staged(db, batch.map, batch.version, parts.len() as u32).await
}

/// Tells a map's deferred changes on top of its rows.
pub(in crate::store) async fn apply(
    db: &mut Connection,
    map: MapKey,
    known: &mut Known,
    take: &mut (impl FnMut(Vec<Change>) + Send),
) -> Result<(), StoreError> {
    for (version, parts, first) in versions(db, map).await? {
        for number in first..parts {
            let mut changes = part(db, map, version, number).await?;
            changes.retain(|change| match change {
                // Of an anchor's versions the largest counts.
                Change::AnchorTouched(anchor, version) => {
                    known.anchors.get(anchor).is_some_and(|anchor| anchor.version < *version)
                }
                _ => true,
            });
            for change in &changes {
                if let Change::AnchorTouched(anchor, version) = change
                    && let Some(known) = known.anchors.get_mut(anchor)
                {
                    known.version = *version;
                }
            }
            take(changes);
        }
    }
    Ok(())
}

/// Takes a map's deferred changes, in their order and part by part: together they may be more than memory holds.
pub(in crate::store) async fn for_each(
    db: &mut Connection,
    map: MapKey,
    mut take: impl FnMut(Change),
) -> Result<(), StoreError> {
    for (version, parts, first) in versions(db, map).await? {
        for number in first..parts {
            part(db, map, version, number).await?.into_iter().for_each(&mut take);
        }
    }
    Ok(())
}

/// Returns the versions with deferred changes, each with the number of its parts and the first that is not in the rows.
async fn versions(db: &mut Connection, map: MapKey) -> Result<Vec<(i64, u32, u32)>, StoreError> {
    let select = "select version, parts, part from deferred_changes where map_key = $1 order by version";
    Ok(sql::query_as(select).bind(map).fetch_all(db).await?)
}

/// Returns the changes of one part.
async fn part(
    db: &mut Connection,
    map: MapKey,
    version: i64,
    number: u32,
) -> Result<Vec<Change>, StoreError> {
    let select = "select kind, entries from deferred_parts where map_key = $1 and version = $2 and part = $3";
    let query = sql::query_as(select).bind(map).bind(version).bind(number);
    let found: Option<(String, Vec<u8>)> = query.fetch_optional(db).await?;
    let missing = || StoreError::corrupt(format!("part {number} of deferred changes is not there"));
    let (kind, entries) = found.ok_or_else(missing)?;
    unpacked(Kind::from_name(&kind)?, &entries)
}

/// Returns the deferred positions of a keyframe's detections, the latest last.
pub(in crate::store) async fn positions(
    db: &mut Connection,
    map: MapKey,
    keyframe: KeyframeSeq,
) -> Result<Vec<(u16, Point3)>, StoreError> {
    let select = "select entries from deferred_parts join deferred_changes using (map_key, version)
        where map_key = $1 and kind = 'positions' order by version, deferred_parts.part";
    let parts: Vec<Vec<u8>> = sql::query_scalar(select).bind(map).fetch_all(db).await?;
    let mut found = Vec::new();
    for entries in parts {
        found.extend(unpacked(Kind::Positions, &entries)?.into_iter().filter_map(|change| match change {
            Change::PositionSet(_, seen_by, detection, at) if seen_by == keyframe => Some((detection, at)),
            _ => None,
        }));
    }
    Ok(found)
}

/// Removes the parts that a process staged and did not commit.
pub(in crate::store) async fn remove_uncommitted(db: &mut Connection) -> Result<(), StoreError> {
    let delete = "delete from deferred_parts where not exists (
        select 1 from deferred_changes c
        where c.map_key = deferred_parts.map_key and c.version = deferred_parts.version
    )";
    run(db, sql::query(delete)).await
}

/// Removes the parts of a map that a server staged and did not commit.
pub(in crate::store) async fn remove_uncommitted_of(
    db: &mut Connection,
    map: MapKey,
) -> Result<(), StoreError> {
    let delete = "delete from deferred_parts where map_key = $1 and version not in (
        select version from deferred_changes where map_key = $1
    )";
    run(db, sql::query(delete).bind(map)).await
}
