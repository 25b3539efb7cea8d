//! From one row to one value of the model; a value that does not decode is an error that says which.

use revisit_core::domain::anchor::Observation;
use revisit_core::domain::bow::BowVector;
use revisit_core::domain::change::{Declared, Keyframe, Loop};
use revisit_core::domain::global_descriptor::GlobalDescriptor;
use revisit_core::domain::ids::KeyframeSeq;
use revisit_core::domain::keyframe::{Camera, Stamp};

use crate::StoreError;
use crate::columns::blob::{unpack, unpack_array};
use crate::columns::column::integers_of;
use crate::sql::Row;

/// The columns of a keyframe that are read to memory.
pub(crate) const KEYFRAME: &str = "keyframe, id, session, stamp_sec, stamp_nanosec, pose, sent_pose, scale, camera, gravity, height_m,
    keyframes.observes, keyframes.declared, bow_words, bow_weights, keyframes.bytes, global_model, global_encoding, global_descriptor";

/// Reads a keyframe and its bag of words.
pub(crate) fn keyframe(row: &Row) -> Result<(Keyframe, BowVector), StoreError> {
    let keyframe = Keyframe {
        seq: row.try_get("keyframe")?,
        id: row.try_get("id")?,
        session: row.try_get("session")?,
        stamp: Stamp { sec: row.try_get("stamp_sec")?, nanosec: row.try_get("stamp_nanosec")? },
        map_from_camera: row.try_get("pose")?,
        sent_pose: row.try_get("sent_pose")?,
        scale: row.try_get("scale")?,
        camera: row.try_get::<Option<&[u8]>, _>("camera")?.map(camera).transpose()?,
        gravity: row.try_get("gravity")?,
        height_m: row.try_get("height_m")?,
        observes: integers_of::<i64>(row.try_get("observes")?)?.into(),
        declared: declared(row, "declared")?,
        renamed: None,
        bytes: row.try_get("bytes")?,
    };
    Ok((keyframe, bow(row)?))
}

/// Reads the covisible keyframes that a client declared.
pub(crate) fn declared(row: &Row, column: &str) -> Result<Declared, StoreError> {
    let Some(packed) = row.try_get::<Option<&[u8]>, _>(column)? else { return Ok(None) };
    let listed: Vec<(u32, u32)> = unpack(packed)?;
    Ok(Some(listed.into_iter().map(|(other, shared)| (KeyframeSeq(other), shared)).collect()))
}

/// Reads a bag of words.
pub(crate) fn bow(row: &Row) -> Result<BowVector, StoreError> {
    let (words, weights) =
        (integers_of(row.try_get("bow_words")?)?, integers_of(row.try_get("bow_weights")?)?);
    BowVector::from_parts(words, weights).map_err(|error| StoreError::corrupt(error.to_string()))
}

fn camera(bytes: &[u8]) -> Result<Camera, StoreError> {
    const FLOATS: usize = 4 * size_of::<f64>();
    let (floats, integers) =
        bytes.split_at_checked(FLOATS).ok_or_else(|| StoreError::corrupt("a camera is short"))?;
    let [fx, fy, cx, cy] = unpack_array(floats)?;
    let [width, height] = unpack_array(integers)?;
    Ok(Camera { fx, fy, cx, cy, width, height })
}

/// Reads the global descriptor of a keyframe, if it has one.
pub(crate) fn global_descriptor(row: &Row) -> Result<Option<GlobalDescriptor>, StoreError> {
    let Some(data) = row.try_get::<Option<&[u8]>, _>("global_descriptor")? else { return Ok(None) };
    let (model, encoding) = (row.try_get("global_model")?, row.try_get("global_encoding")?);
    Ok(Some(GlobalDescriptor { model, encoding, data: data.into() }))
}

/// Reads what a detection says of the anchor that it feeds.
pub(crate) fn observation(row: &Row, has_crop: bool) -> Result<Observation, StoreError> {
    let [x0, y0, x1, y1] = row.try_get("box_px")?;
    let (text, description): (Option<Box<str>>, Option<Box<str>>) =
        (row.try_get("text")?, row.try_get("description")?);
    let map_points: Vec<i64> = unpack(row.try_get("map_points")?)?;
    Ok(Observation {
        keyframe: row.try_get("keyframe")?,
        detection: row.try_get("detection")?,
        confidence: row.try_get("confidence")?,
        map_points: map_points.into(),
        position_as_sent: row.try_get("position")?,
        range_assumed: row.try_get("range_assumed")?,
        described: description.is_some(),
        reading: description.or(text),
        crop_area_px: has_crop.then_some((x1 - x0) * (y1 - y0)),
        crop_reading: None,
    })
}

/// Reads a confirmed loop.
pub(crate) fn closed_loop(row: &Row) -> Result<Loop, StoreError> {
    Ok(Loop {
        id: row.try_get("id")?,
        keyframe: row.try_get("keyframe")?,
        candidate: row.try_get("candidate")?,
        keyframe_id: row.try_get("keyframe_id")?,
        candidate_id: row.try_get("candidate_id")?,
        query: row.try_get("query")?,
        candidate_from_query: row.try_get("candidate_from_query")?,
    })
}
