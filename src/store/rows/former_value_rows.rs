//! Former values, as rows: to the database and back.
//!
//! A version's former values are packed lists, written once and read by exports alone. Those of a large correction are
//! staged with it, and moved here when it is folded.

use super::blob::{pack, unpack};
use super::keyframe_rows::pose_blob;
use super::statement::run;
use crate::domain::former::FormerValues;
use crate::domain::ids::{KeyframeSeq, SessionSeq};
use crate::geometry::{Point3, Pose};
use crate::store::StoreError;
use crate::store::commit::job::{Batch, MapKey};
use crate::store::slices::parts::{Kind, Part, cut};
use crate::store::sql::{self, Connection};

/// The coordinates of a point that was not there.
const ABSENT: [f64; 3] = [f64::NAN; 3];

/// Packs former values into parts.
pub(in crate::store) fn packed(former: &FormerValues) -> Vec<Part> {
    let mut poses = Vec::new();
    for (keyframe, pose) in &former.poses {
        poses.extend(pack([keyframe.0]));
        poses.extend(pose_blob(pose));
    }
    let points = former
        .points
        .iter()
        .map(|(session, id, at)| ((session.0, *id), at.map_or(ABSENT, |at| [at.x, at.y, at.z])));
    let forgotten = former.forgotten.iter().map(|(session, id, at)| ((session.0, *id), [at.x, at.y, at.z]));
    let positions = former
        .positions
        .iter()
        .map(|(keyframe, detection, at)| ([keyframe.0, u32::from(*detection)], [at.x, at.y, at.z]));
    let lists = [
        (Kind::FormerPoses, poses),
        (Kind::FormerPoints, pack(points)),
        (Kind::FormerForgotten, pack(forgotten)),
        (Kind::FormerPositions, pack(positions)),
    ];
    lists.iter().flat_map(|(kind, entries)| cut(*kind, entries)).collect()
}

/// Unpacks a part; empty for a kind that is no history.
pub(in crate::store) fn unpacked(kind: Kind, entries: &[u8]) -> Result<FormerValues, StoreError> {
    let mut former = FormerValues::default();
    match kind {
        Kind::FormerPoses => {
            let pose = |(keyframe, [x, y, z, qx, qy, qz, qw]): (u32, [f64; 7])| {
                (KeyframeSeq(keyframe), Pose::from_stored([x, y, z], [qx, qy, qz, qw]))
            };
            former.poses = unpack(entries)?.into_iter().map(pose).collect();
        }
        Kind::FormerPoints => {
            let point = |((session, id), at): ((u32, i64), [f64; 3])| {
                (SessionSeq(session), id, (!at[0].is_nan()).then(|| Point3::from(at)))
            };
            former.points = unpack(entries)?.into_iter().map(point).collect();
        }
        Kind::FormerForgotten => {
            let point =
                |((session, id), at): ((u32, i64), [f64; 3])| (SessionSeq(session), id, Point3::from(at));
            former.forgotten = unpack(entries)?.into_iter().map(point).collect();
        }
        Kind::FormerPositions => {
            let position = |([keyframe, detection], at): ([u32; 2], [f64; 3])| {
                let detection =
                    u16::try_from(detection).map_err(|_| StoreError::corrupt("a detection's number"))?;
                Ok((KeyframeSeq(keyframe), detection, Point3::from(at)))
            };
            former.positions =
                unpack(entries)?.into_iter().map(position).collect::<Result<_, StoreError>>()?;
        }
        _ => {}
    }
    Ok(former)
}

/// Returns the values that a version replaced, in their rows or staged still.
pub(in crate::store) async fn of_version(
    db: &mut Connection,
    map: MapKey,
    version: i64,
) -> Result<FormerValues, StoreError> {
    let select = "select part, kind, entries from former_values where map_key = $1 and version = $2
        union all select p.part, p.kind, p.entries from deferred_parts p
            join deferred_changes c on c.map_key = p.map_key and c.version = p.version and p.part >= c.part
            where p.map_key = $1 and p.version = $2 and p.kind like 'former_%'
        order by 1";
    let parts: Vec<(u32, String, Vec<u8>)> =
        sql::query_as(select).bind(map).bind(version).fetch_all(db).await?;
    let mut all = FormerValues::default();
    for (_, kind, entries) in parts {
        let part = unpacked(Kind::from_name(&kind)?, &entries)?;
        all.poses.extend(part.poses);
        all.points.extend(part.points);
        all.forgotten.extend(part.forgotten);
        all.positions.extend(part.positions);
    }
    Ok(all)
}

/// Adds the former values of a batch that is not staged.
pub(in crate::store) async fn add(db: &mut Connection, batch: &Batch) -> Result<(), StoreError> {
    for (number, part) in (0_u32..).zip(packed(&batch.former)) {
        let insert =
            "insert into former_values (map_key, version, part, kind, entries) values ($1, $2, $3, $4, $5)";
        let query = sql::query(insert).bind(batch.map).bind(batch.version as i64).bind(number);
        run(db, query.bind(part.kind.as_str()).bind(part.entries)).await?;
    }
    Ok(())
}

/// Moves a staged part here.
pub(in crate::store) async fn keep_part(
    db: &mut Connection,
    map: MapKey,
    (version, part): (i64, u32),
) -> Result<(), StoreError> {
    let insert = "insert into former_values (map_key, version, part, kind, entries)
        select map_key, version, part, kind, entries from deferred_parts
        where map_key = $1 and version = $2 and part = $3";
    run(db, sql::query(insert).bind(map).bind(version).bind(part)).await
}
