//! Keypoints in a blob: a column of each coordinate.

use revisit_core::domain::keyframe::Keypoint;
use revisit_core::domain::varint;

use crate::StoreError;
use crate::columns::column::{floats, floats_of};

/// Packs keypoints: columns of u, v and angle, and a byte for each octave, each preceded by its length.
pub(crate) fn keypoints(list: &[Keypoint]) -> Vec<u8> {
    let column = |of: fn(&Keypoint) -> f64| floats(&list.iter().map(of).collect::<Vec<_>>());
    let angles = column(|keypoint| keypoint.angle_deg.unwrap_or(f64::NAN));
    let octaves = list.iter().map(|keypoint| keypoint.octave).collect();
    let mut bytes = Vec::new();
    for part in [column(|keypoint| keypoint.u), column(|keypoint| keypoint.v), angles, octaves] {
        varint::write(part.len() as u64, &mut bytes);
        bytes.extend(part);
    }
    bytes
}

/// Unpacks keypoints.
pub(crate) fn keypoints_of(bytes: &[u8]) -> Result<Vec<Keypoint>, StoreError> {
    let [u, v, angles, octaves] = parts(bytes)?;
    let (u, v, angles) = (floats_of(u)?, floats_of(v)?, floats_of(angles)?);
    if [v.len(), angles.len(), octaves.len()] != [u.len(); 3] {
        return Err(StoreError::corrupt("the columns of keypoints do not fit together"));
    }
    let rows = u.into_iter().zip(v).zip(angles).zip(octaves);
    let keypoint = |(((u, v), angle_deg), octave): (((f64, f64), f64), &u8)| Keypoint {
        u,
        v,
        octave: *octave,
        angle_deg: (!angle_deg.is_nan()).then_some(angle_deg),
    };
    Ok(rows.map(keypoint).collect())
}

/// Returns the parts of packed keypoints.
fn parts(mut bytes: &[u8]) -> Result<[&[u8]; 4], StoreError> {
    let short = || StoreError::corrupt("packed keypoints are short");
    let mut parts = [&bytes[..0]; 4];
    for part in &mut parts {
        let length = varint::read(&mut bytes).and_then(|length| usize::try_from(length).ok());
        (*part, bytes) = length.and_then(|length| bytes.split_at_checked(length)).ok_or_else(short)?;
    }
    if bytes.is_empty() { Ok(parts) } else { Err(StoreError::corrupt("packed keypoints are long")) }
}
