//! Observations that a client's map changed, as rows beside those that keep what was sent.

use revisit_core::domain::change::{Keyframe, PointsOfKeyframe, Renamed};
use revisit_core::domain::ids::{KeyframeSeq, PointId};

use crate::StoreError;
use crate::columns::column::{integers, integers_of};
use crate::map_key::MapKey;
use crate::rows::decode;
use crate::rows::keyframe_rows::declared_blob;
use crate::sql::{self, Query, Row};

/// The columns of a keyframe's points beside those of its own row, for a select that joins the two.
pub(crate) const JOINED: &str =
    "keyframe_points.observes as observes_now, renamed_from, renamed_to, renames_all,
    keyframe_points.declared as declared_now, keyframe_points.bytes as bytes_now";

/// Sets what a keyframe observes.
pub(crate) fn set_points_of_keyframe(map: MapKey, points: &PointsOfKeyframe) -> Query {
    let PointsOfKeyframe { keyframe, observes, renamed, declared, bytes } = points;
    let insert = "insert into keyframe_points
        (map_key, keyframe, observes, renamed_from, renamed_to, renames_all, declared, bytes)
        values ($1, $2, $3, $4, $5, $6, $7, $8)
        on conflict (map_key, keyframe) do update set observes = excluded.observes,
            renamed_from = excluded.renamed_from, renamed_to = excluded.renamed_to,
            renames_all = excluded.renames_all, declared = excluded.declared, bytes = excluded.bytes";
    let (from, to): (Vec<PointId>, Vec<PointId>) = renamed.pairs.iter().copied().unzip();
    let (observes, from, to) = (integers(&observes.to_vec()), integers(&from), integers(&to));
    let declared = declared_blob(declared);
    sql::statement(insert, (map, *keyframe, observes, from, to, renamed.is_complete, declared, *bytes))
}

/// Sets the map points of a detection.
pub(crate) fn set_points_of_detection(
    map: MapKey,
    (keyframe, detection): (KeyframeSeq, u16),
    points: &[PointId],
) -> Query {
    let update =
        "update detections set points_now = $4 where map_key = $1 and keyframe = $2 and detection = $3";
    sql::statement(update, (map, keyframe, detection, integers(points)))
}

/// Gives a keyframe what it observes now, if its row was selected with [`JOINED`] and that is not what was sent.
pub(crate) fn bring_up_to_date(keyframe: &mut Keyframe, row: &Row) -> Result<(), StoreError> {
    let Some(observes) = row.try_get::<Option<&[u8]>, _>("observes_now")? else { return Ok(()) };
    let from: Vec<PointId> = integers_of(row.try_get("renamed_from")?)?;
    let to: Vec<PointId> = integers_of(row.try_get("renamed_to")?)?;
    if from.len() != to.len() || !from.is_sorted_by(|a, b| a < b) {
        return Err(StoreError::corrupt("the renamed points do not fit together"));
    }
    keyframe.observes = integers_of::<PointId>(observes)?.into();
    keyframe.declared = decode::declared(row, "declared_now")?;
    let (pairs, is_complete) = (from.into_iter().zip(to).collect(), row.try_get("renames_all")?);
    keyframe.renamed = Some(Renamed { pairs, is_complete });
    keyframe.bytes = row.try_get("bytes_now")?;
    Ok(())
}

/// Returns the map points that a detection has now, where they are others than were sent.
pub(crate) fn points_of_detection(row: &Row) -> Result<Option<Vec<PointId>>, StoreError> {
    let Some(points) = row.try_get::<Option<&[u8]>, _>("points_now")? else { return Ok(None) };
    let points: Vec<PointId> = integers_of(points)?;
    if !points.is_sorted_by(|a, b| a < b) {
        return Err(StoreError::corrupt("the map points are not in order"));
    }
    Ok(Some(points))
}
