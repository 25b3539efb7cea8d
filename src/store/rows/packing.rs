//! Packing: how the numbers of a keyframe's rows lie in their blobs, by the version that wrote them.

use super::blob::unpack;
use super::column::{floats, floats_of, integers_of};
use crate::domain::keyframe::Keypoint;
use crate::domain::varint;
use crate::store::StoreError;
use crate::store::sql::Row;

/// The way in which the numbers of a row are packed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::store) enum Packing {
    /// Each with the width of its type.
    Fixed,
    /// As columns, which tell their own width.
    Columns,
}

impl Packing {
    /// The one that rows are written with.
    pub const NEWEST: Self = Self::Columns;

    /// Returns its number in the rows.
    pub fn number(self) -> i64 {
        match self {
            Self::Fixed => 0,
            Self::Columns => 1,
        }
    }

    /// Reads the packing of a row.
    pub fn of(row: &Row) -> Result<Self, StoreError> {
        match row.try_get("packing")? {
            0 => Ok(Self::Fixed),
            1 => Ok(Self::Columns),
            other => Err(StoreError::corrupt(format!("packing {other}"))),
        }
    }

    /// Unpacks numbers of 64 bits.
    pub fn wide(self, bytes: &[u8]) -> Result<Vec<i64>, StoreError> {
        match self {
            Self::Fixed => unpack(bytes),
            Self::Columns => integers_of(bytes),
        }
    }

    /// Unpacks unsigned numbers of 32 bits.
    pub fn narrow(self, bytes: &[u8]) -> Result<Vec<u32>, StoreError> {
        match self {
            Self::Fixed => unpack(bytes),
            Self::Columns => integers_of(bytes),
        }
    }

    /// Unpacks keypoints.
    pub fn keypoints(self, bytes: &[u8]) -> Result<Vec<Keypoint>, StoreError> {
        let keypoint = |u, v, angle_deg: f64, octave| Keypoint {
            u,
            v,
            octave,
            angle_deg: (!angle_deg.is_nan()).then_some(angle_deg),
        };
        match self {
            Self::Fixed => {
                let rows: Vec<((f64, f64), (f64, u8))> = unpack(bytes)?;
                Ok(rows.into_iter().map(|((u, v), (angle, octave))| keypoint(u, v, angle, octave)).collect())
            }
            Self::Columns => {
                let [u, v, angles, octaves] = parts(bytes)?;
                let (u, v, angles) = (floats_of(u)?, floats_of(v)?, floats_of(angles)?);
                if [v.len(), angles.len(), octaves.len()] != [u.len(); 3] {
                    return Err(StoreError::corrupt("the columns of keypoints do not fit together"));
                }
                let rows = u.into_iter().zip(v).zip(angles).zip(octaves);
                Ok(rows.map(|(((u, v), angle), octave)| keypoint(u, v, angle, *octave)).collect())
            }
        }
    }
}

/// Packs keypoints: columns of u, v and angle, and a byte for each octave, each preceded by its length.
pub(in crate::store) fn keypoints(list: &[Keypoint]) -> Vec<u8> {
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
