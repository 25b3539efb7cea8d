//! The rows of a keyframe: itself, its features, its detections, its map points.

use std::collections::HashMap;

use sqlx::{Sqlite, SqliteConnection};

use super::StoreError;
use super::blob::pack;
use super::job::{MapKey, NewKeyframeRows};
use super::write::run;
use crate::geometry::{Point3, Pose};
use crate::model::anchor::Outcome;
use crate::model::bow::BowVector;
use crate::model::change::Keyframe;
use crate::model::ids::{KeyframeSeq, PointId, SessionSeq};
use crate::model::keyframe::{Features, NewKeyframe};

/// SQLite takes at most 32,766 parameters; six for each point.
const POINTS_PER_STATEMENT: usize = 512;

/// One statement for each number of points there may be: kept, they would fill every connection's cache with large statements.
const NOT_KEPT: bool = false;

pub(super) fn pose_blob(pose: &Pose) -> Vec<u8> {
    pack(pose.translation_m().into_iter().chain(pose.rotation_xyzw()))
}

pub(super) async fn add_keyframe(
    db: &mut SqliteConnection,
    map: MapKey,
    keyframe: &Keyframe,
    bow: &BowVector,
    rows: &NewKeyframeRows,
) -> Result<(), StoreError> {
    let camera = keyframe.camera.map(|camera| {
        let mut blob = pack([camera.fx, camera.fy, camera.cx, camera.cy]);
        blob.extend(pack([camera.width, camera.height]));
        blob
    });
    let insert =
        "insert into keyframes (map_key, keyframe, id, session, stamp_sec, stamp_nanosec, pose, camera,
            observes, sent_points, declared, bow_words, bow_weights, digest, bytes)
        values ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12, $13, $14, $15)";
    let query = sqlx::query(insert)
        .bind(map)
        .bind(keyframe.seq.0)
        .bind(keyframe.id.as_str())
        .bind(keyframe.session.0)
        .bind(keyframe.stamp.sec)
        .bind(keyframe.stamp.nanosec)
        .bind(pose_blob(&keyframe.map_from_camera))
        .bind(camera)
        .bind(pack(keyframe.observes.iter()))
        .bind(pack(rows.keyframe.map_points.iter().map(|(id, _)| *id)))
        .bind(pack(keyframe.declared.iter().map(|(other, shared)| (other.0, *shared))))
        .bind(pack(bow.words().iter().copied()))
        .bind(pack(bow.weights().iter().copied()))
        .bind(&rows.digest[..])
        .bind(keyframe.bytes as i64);
    run(db, query).await?;
    match &rows.keyframe.features {
        Some(features) => add_features(db, map, keyframe.seq, features).await,
        None => Ok(()),
    }
}

async fn add_features(
    db: &mut SqliteConnection,
    map: MapKey,
    keyframe: KeyframeSeq,
    features: &Features,
) -> Result<(), StoreError> {
    let insert = "insert into keyframe_features (map_key, keyframe, descriptor_bytes, descriptors, keypoints, map_points)
        values ($1, $2, $3, $4, $5, $6)";
    let keypoints =
        features.keypoints.iter().map(|k| ((k.u, k.v), (k.angle_deg.unwrap_or(f64::NAN), k.octave)));
    let query = sqlx::query(insert)
        .bind(map)
        .bind(keyframe.0)
        .bind(features.descriptor_bytes as i64)
        .bind(&features.descriptors)
        .bind(pack(keypoints))
        .bind(pack(features.map_points.iter().map(|id| id.unwrap_or(-1))));
    run(db, query).await
}

pub(super) async fn add_detections(
    db: &mut SqliteConnection,
    map: MapKey,
    keyframe: KeyframeSeq,
    new: &NewKeyframe,
    outcomes: &HashMap<(KeyframeSeq, u16), Outcome>,
) -> Result<(), StoreError> {
    for (number, detection) in new.detections.iter().enumerate() {
        let number = number as u16;
        let (outcome, anchor) = match outcomes.get(&(keyframe, number)) {
            Some(Outcome::Created(anchor)) => ("created", Some(anchor.0)),
            Some(Outcome::Observed(anchor)) => ("observed", Some(anchor.0)),
            Some(Outcome::Ignored(reason)) => (reason.as_str(), None),
            None => return Err(StoreError::corrupt("a detection without an outcome")),
        };
        let insert =
            "insert into detections (map_key, keyframe, detection, class, confidence, box_px, map_points,
                position, text, description, outcome, anchor)
            values ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12)";
        let query = sqlx::query(insert)
            .bind(map)
            .bind(keyframe.0)
            .bind(number)
            .bind(&detection.class)
            .bind(detection.confidence)
            .bind(pack(detection.box_px))
            .bind(pack(detection.map_points.iter().copied()))
            .bind(detection.position_in_session.map(|at| pack([at.x, at.y, at.z])))
            .bind(&detection.text)
            .bind(&detection.description)
            .bind(outcome)
            .bind(anchor);
        run(db, query).await?;
        if let Some(crop) = &detection.crop {
            let insert = "insert into crops (map_key, keyframe, detection, media_type, bytes) values ($1, $2, $3, $4, $5)";
            let query = sqlx::query(insert).bind(map).bind(keyframe.0).bind(number);
            run(db, query.bind(crop.media_type).bind(&crop.bytes)).await?;
        }
    }
    Ok(())
}

pub(super) async fn set_points(
    db: &mut SqliteConnection,
    map: MapKey,
    points: &[(SessionSeq, PointId, Point3)],
) -> Result<(), StoreError> {
    for chunk in points.chunks(POINTS_PER_STATEMENT) {
        let mut insert =
            sqlx::QueryBuilder::<Sqlite>::new("insert into map_points (map_key, session, point, x, y, z) ");
        insert.push_values(chunk, |mut row, (session, id, at)| {
            row.push_bind(map).push_bind(session.0).push_bind(*id);
            row.push_bind(at.x).push_bind(at.y).push_bind(at.z);
        });
        insert.push(" on conflict (map_key, session, point) do update set x = excluded.x, y = excluded.y, z = excluded.z");
        insert.build().persistent(NOT_KEPT).execute(&mut *db).await?;
    }
    Ok(())
}

pub(super) async fn forget_points(
    db: &mut SqliteConnection,
    map: MapKey,
    session: SessionSeq,
    ids: &[PointId],
) -> Result<(), StoreError> {
    for chunk in ids.chunks(POINTS_PER_STATEMENT) {
        let mut delete = sqlx::QueryBuilder::<Sqlite>::new("delete from map_points where map_key = ");
        delete.push_bind(map).push(" and session = ").push_bind(session.0).push(" and point in (");
        let mut named = delete.separated(", ");
        for id in chunk {
            named.push_bind(*id);
        }
        delete.push(")").build().persistent(NOT_KEPT).execute(&mut *db).await?;
    }
    Ok(())
}
