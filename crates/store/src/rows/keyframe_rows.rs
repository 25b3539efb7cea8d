//! The rows of a keyframe: itself, its features, its detections, its map points.

use std::collections::HashMap;

use revisit_core::domain::anchor::Outcome;
use revisit_core::domain::bow::BowVector;
use revisit_core::domain::change::{Change, Declared, Keyframe};
use revisit_core::domain::ids::{AnchorSeq, KeyframeSeq};
use revisit_core::domain::keyframe::{Camera, Detection};
use revisit_core::geometry::Sim3;

use crate::StoreError;
use crate::columns::blob::pack;
use crate::columns::bulk_insert::write_rows;
use crate::columns::clock::seconds_now;
use crate::columns::column::integers;
use crate::columns::keypoints::keypoints;
use crate::jobs::job::{Batch, NewKeyframeRows};
use crate::map_key::MapKey;
use crate::sql::run;
use crate::sql::{self, Connection, Query};

/// A keyframe that arrived.
pub(crate) struct Arrived<'j> {
    pub map: MapKey,
    pub version: u64,
    pub keyframe: &'j Keyframe,
    pub bow: &'j BowVector,
    pub rows: &'j NewKeyframeRows,
}

/// Packs the covisible keyframes that a client declared.
pub(crate) fn declared_blob(declared: &Declared) -> Option<Vec<u8>> {
    declared.as_ref().map(|listed| pack(listed.iter().map(|(other, shared)| (other.0, *shared))))
}

/// Corrects a keyframe's pose.
pub(crate) fn set_pose(map: MapKey, keyframe: KeyframeSeq, map_from_camera: &Sim3) -> Query {
    let update = "update keyframes set pose = $3, scale = $4 where map_key = $1 and keyframe = $2";
    sql::statement(update, (map, keyframe, &map_from_camera.without_scale(), map_from_camera.scale()))
}

/// Adds the rows of keyframes, and of their features.
pub(crate) async fn add_keyframes(db: &mut Connection, arrived: &[Arrived<'_>]) -> Result<(), StoreError> {
    let head =
        "insert into keyframes (map_key, keyframe, id, session, stamp_sec, stamp_nanosec, pose, sent_pose, scale, camera,
            observes, sent_points, declared, bow_words, bow_weights, digest, bytes, version, gravity, height_m, global_model, global_encoding, global_descriptor, stored_sec) ";
    write_rows(db, head, "", arrived, |row, Arrived { map, version, keyframe, bow, rows }| {
        row.push_bind(*map).push_bind(keyframe.seq).push_bind(&keyframe.id).push_bind(keyframe.session);
        row.push_bind(keyframe.stamp.sec).push_bind(keyframe.stamp.nanosec);
        row.push_bind(&keyframe.map_from_camera).push_bind(&keyframe.sent_pose).push_bind(keyframe.scale);
        row.push_bind(keyframe.camera.map(camera_blob));
        row.push_bind(integers(&keyframe.observes.to_vec()));
        row.push_bind(integers(&rows.keyframe.map_points.iter().map(|(id, _)| *id).collect::<Vec<_>>()));
        row.push_bind(declared_blob(&keyframe.declared));
        for list in [bow.words(), bow.weights()] {
            row.push_bind(integers(&list.iter().map(|number| i64::from(*number)).collect::<Vec<_>>()));
        }
        row.push_bind(&rows.digest).push_bind(keyframe.bytes).push_bind(*version);
        row.push_bind(keyframe.gravity).push_bind(keyframe.height_m);
        let global = rows.keyframe.global_descriptor.as_ref();
        row.push_bind(global.map(|of| &of.model)).push_bind(global.map(|of| of.encoding));
        row.push_bind(global.map(|of| &of.data[..]));
        row.push_bind(seconds_now());
    })
    .await?;
    let with_features = |arrived: &'_ Arrived<'_>| arrived.rows.keyframe.features.is_some();
    let arrived: Vec<&Arrived<'_>> = arrived.iter().filter(|arrived| with_features(arrived)).collect();
    let head = "insert into keyframe_features (map_key, keyframe, descriptor_bytes, descriptors, keypoints, map_points) ";
    write_rows(db, head, "", &arrived, |row, arrived| {
        let Arrived { map, keyframe, rows, .. } = arrived;
        let Some(features) = &rows.keyframe.features else { return };
        row.push_bind(*map).push_bind(keyframe.seq).push_bind(features.descriptor_bytes);
        row.push_bind(&features.descriptors).push_bind(keypoints(&features.keypoints));
        row.push_bind(integers(&features.map_points.iter().map(|id| id.unwrap_or(-1)).collect::<Vec<_>>()));
    })
    .await
}

fn camera_blob(camera: Camera) -> Vec<u8> {
    let mut blob = pack([camera.fx, camera.fy, camera.cx, camera.cy]);
    blob.extend(pack([camera.width, camera.height]));
    blob
}

/// A detection, and what became of it.
#[derive(Clone, Copy)]
pub(crate) struct Detected<'j> {
    map: MapKey,
    keyframe: KeyframeSeq,
    number: u16,
    detection: &'j Detection,
    outcome: &'static str,
    anchor: Option<AnchorSeq>,
}

/// Returns the detections of the keyframe that arrived with a batch.
pub(crate) fn detections(batch: &Batch) -> Result<Vec<Detected<'_>>, StoreError> {
    let arrived = batch.changes.iter().find_map(|change| match change {
        Change::KeyframeAdded(keyframe, _) => Some(keyframe.seq),
        _ => None,
    });
    let (Some(keyframe), Some(rows)) = (arrived, &batch.new_keyframe) else { return Ok(Vec::new()) };
    let outcomes: HashMap<u16, Outcome> = batch
        .changes
        .iter()
        .filter_map(|change| match change {
            Change::OutcomeSet(of, detection, outcome) => (*of == keyframe).then_some((*detection, *outcome)),
            _ => None,
        })
        .collect();
    let row = |(number, detection)| {
        let (outcome, anchor) = match outcomes.get(&number) {
            Some(Outcome::Created(anchor)) => ("created", Some(*anchor)),
            Some(Outcome::Observed(anchor)) => ("observed", Some(*anchor)),
            Some(Outcome::Ignored(reason)) => (reason.as_str(), None),
            None => return Err(StoreError::corrupt("a detection without an outcome")),
        };
        Ok(Detected { map: batch.map, keyframe, number, detection, outcome, anchor })
    };
    (0..).zip(&rows.keyframe.detections).map(row).collect()
}

/// Adds the rows of detections, and of their crops.
pub(crate) async fn add_detections(
    db: &mut Connection,
    detections: &[Detected<'_>],
) -> Result<(), StoreError> {
    let head = "insert into detections (map_key, keyframe, detection, class, confidence, box_px, map_points,
            position, range_assumed, text, description, outcome, anchor) ";
    write_rows(db, head, "", detections, |row, detected| {
        let Detected { map, keyframe, number, detection, outcome, anchor } = *detected;
        row.push_bind(map).push_bind(keyframe).push_bind(number);
        row.push_bind(&detection.class).push_bind(detection.confidence);
        row.push_bind(detection.box_px).push_bind(pack(detection.map_points.iter().copied()));
        row.push_bind(detection.position_in_session).push_bind(detection.range_assumed);
        row.push_bind(&detection.text).push_bind(&detection.description);
        row.push_bind(outcome).push_bind(anchor);
    })
    .await?;
    for Detected { map, keyframe, number, detection, .. } in detections {
        if let Some(crop) = &detection.crop {
            let insert = "insert into crops (map_key, keyframe, detection, media_type, bytes) values ($1, $2, $3, $4, $5)";
            run(db, sql::statement(insert, (map, *keyframe, *number, crop.media_type, &crop.bytes))).await?;
        }
    }
    Ok(())
}
