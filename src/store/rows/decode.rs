//! From one row to one value of the model; a value that does not decode is an error that says which.

use super::blob::{unpack, unpack_array};
use super::column::integers_of;
use crate::domain::anchor::Observation;
use crate::domain::bow::BowVector;
use crate::domain::change::{Declared, Keyframe, Loop};
use crate::domain::global_descriptor::{GlobalDescriptor, GlobalEncoding};
use crate::domain::ids::{KeyframeSeq, LoopId, SessionSeq, StoredId};
use crate::domain::keyframe::{Camera, Stamp};
use crate::domain::request::Digest;
use crate::geometry::{Gravity, Point3, Pose, Sim3};
use crate::store::StoreError;
use crate::store::sql::Row;

/// Reads the digest of a body.
pub(in crate::store) fn digest(row: &Row) -> Result<Digest, StoreError> {
    let bytes: &[u8] = row.try_get("digest")?;
    bytes.try_into().map_err(|_| StoreError::corrupt("a digest of another length"))
}

/// Reads a keyframe and its bag of words.
pub(in crate::store) fn keyframe(row: &Row) -> Result<(Keyframe, BowVector), StoreError> {
    let keyframe = Keyframe {
        seq: KeyframeSeq(row.try_get("keyframe")?),
        id: id(row.try_get("id")?)?,
        session: SessionSeq(row.try_get("session")?),
        stamp: Stamp { sec: row.try_get("stamp_sec")?, nanosec: row.try_get("stamp_nanosec")? },
        map_from_camera: pose(row.try_get("pose")?)?,
        camera: row.try_get::<Option<&[u8]>, _>("camera")?.map(camera).transpose()?,
        gravity: gravity(row)?,
        height_m: row.try_get("height_m")?,
        observes: integers_of::<i64>(row.try_get("observes")?)?.into(),
        declared: declared(row, "declared")?,
        renamed: None,
        bytes: row.try_get::<i64, _>("bytes")? as u64,
    };
    Ok((keyframe, bow(row)?))
}

/// Reads the covisible keyframes that a client declared.
pub(in crate::store) fn declared(row: &Row, column: &str) -> Result<Declared, StoreError> {
    let Some(packed) = row.try_get::<Option<&[u8]>, _>(column)? else { return Ok(None) };
    let listed: Vec<(u32, u32)> = unpack(packed)?;
    Ok(Some(listed.into_iter().map(|(other, shared)| (KeyframeSeq(other), shared)).collect()))
}

/// Reads a bag of words.
pub(in crate::store) fn bow(row: &Row) -> Result<BowVector, StoreError> {
    let (words, weights) =
        (integers_of(row.try_get("bow_words")?)?, integers_of(row.try_get("bow_weights")?)?);
    BowVector::from_parts(words, weights).map_err(|error| StoreError::corrupt(error.to_string()))
}

/// Reads a pose.
pub(in crate::store) fn pose(bytes: &[u8]) -> Result<Pose, StoreError> {
    let [x, y, z, qx, qy, qz, qw] = unpack_array(bytes)?;
    Ok(Pose::from_stored([x, y, z], [qx, qy, qz, qw]))
}

fn camera(bytes: &[u8]) -> Result<Camera, StoreError> {
    const FLOATS: usize = 4 * size_of::<f64>();
    let (floats, integers) =
        bytes.split_at_checked(FLOATS).ok_or_else(|| StoreError::corrupt("a camera is short"))?;
    let [fx, fy, cx, cy] = unpack_array(floats)?;
    let [width, height] = unpack_array(integers)?;
    Ok(Camera { fx, fy, cx, cy, width, height })
}

/// Reads the gravity of a keyframe or a map, if it has one.
pub(in crate::store) fn gravity(row: &Row) -> Result<Option<Gravity>, StoreError> {
    let vector = row.try_get::<Option<&[u8]>, _>("gravity")?.map(unpack_array).transpose()?;
    vector.map(given_gravity).transpose()
}

/// Returns a vector of gravity that was accepted once.
pub(in crate::store) fn given_gravity(vector: [f64; 3]) -> Result<Gravity, StoreError> {
    Gravity::new(vector).ok_or_else(|| StoreError::corrupt("a vector of gravity that is no unit vector"))
}

/// Reads the global descriptor of a keyframe, if it has one.
pub(in crate::store) fn global_descriptor(row: &Row) -> Result<Option<GlobalDescriptor>, StoreError> {
    let Some(data) = row.try_get::<Option<&[u8]>, _>("global_descriptor")? else { return Ok(None) };
    let (model, encoding): (&str, &str) = (row.try_get("global_model")?, row.try_get("global_encoding")?);
    let unknown = || StoreError::corrupt(format!("a global descriptor in {encoding:?}"));
    let encoding = GlobalEncoding::from_name(encoding).ok_or_else(unknown)?;
    Ok(Some(GlobalDescriptor { model: id(model)?, encoding, data: data.into() }))
}

/// Reads a position.
pub(in crate::store) fn point(bytes: &[u8]) -> Result<Point3, StoreError> {
    Ok(Point3::from(unpack_array::<f64, 3>(bytes)?))
}

/// Reads what a detection says of the anchor that it feeds.
pub(in crate::store) fn observation(row: &Row, has_crop: bool) -> Result<Observation, StoreError> {
    let [x0, y0, x1, y1]: [f64; 4] = unpack_array(row.try_get("box_px")?)?;
    let (text, description): (Option<&str>, Option<&str>) =
        (row.try_get("text")?, row.try_get("description")?);
    let map_points: Vec<i64> = unpack(row.try_get("map_points")?)?;
    Ok(Observation {
        keyframe: KeyframeSeq(row.try_get("keyframe")?),
        detection: row.try_get("detection")?,
        confidence: row.try_get("confidence")?,
        map_points: map_points.into(),
        position_in_session: row.try_get::<Option<&[u8]>, _>("position")?.map(point).transpose()?,
        range_assumed: row.try_get("range_assumed")?,
        reading: description.or(text).map(Into::into),
        described: description.is_some(),
        crop_area_px: has_crop.then_some((x1 - x0) * (y1 - y0)),
        crop_reading: None,
    })
}

/// Reads a confirmed loop.
pub(in crate::store) fn closed_loop(row: &Row) -> Result<Loop, StoreError> {
    Ok(Loop {
        id: id::<LoopId>(row.try_get("id")?)?,
        keyframe: KeyframeSeq(row.try_get("keyframe")?),
        candidate: KeyframeSeq(row.try_get("candidate")?),
        keyframe_id: id(row.try_get("keyframe_id")?)?,
        candidate_id: id(row.try_get("candidate_id")?)?,
        query: row.try_get("query")?,
        candidate_from_query: row
            .try_get::<Option<&[u8]>, _>("candidate_from_query")?
            .map(similarity)
            .transpose()?,
    })
}

/// Reads a similarity: scale, translation, quaternion.
fn similarity(blob: &[u8]) -> Result<Sim3, StoreError> {
    let [scale, x, y, z, qx, qy, qz, qw] = unpack_array(blob)?;
    Ok(Sim3::scaled(Pose::from_stored([x, y, z], [qx, qy, qz, qw]), scale))
}

/// Reads an id that was accepted once.
pub(in crate::store) fn id<T: StoredId>(text: &str) -> Result<T, StoreError> {
    T::stored(text).map_err(|error| StoreError::corrupt(format!("{text:?}: {error}")))
}
