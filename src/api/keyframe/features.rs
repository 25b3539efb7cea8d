//! Features read: three parallel lists, one of them packed in base64.

use crate::api::decoding::column::{Column, Number};
use crate::api::decoding::document::Kind;
use crate::api::decoding::read::Node;
use crate::api::limits;
use crate::domain::counted::counted;
use crate::domain::keyframe::{Features, Keypoint};

/// u, v, octave and angle; an angle that is not a number is left out.
const KEYPOINTS: Column =
    Column { list: "keypoints", packed: "keypoints_f32", number: Number::F32, row: Some(4) };
const MAP_POINTS: Column =
    Column { list: "map_points", packed: "map_points_i64", number: Number::I64, row: None };
const FIELDS: [&str; 6] =
    ["descriptor_bytes", "descriptors", KEYPOINTS.list, KEYPOINTS.packed, MAP_POINTS.list, MAP_POINTS.packed];

/// Reads `features`.
pub fn decode(node: &Node<'_>) -> Option<Features> {
    let body = node.object(&FIELDS)?;
    let descriptor_bytes = body.required("descriptor_bytes", descriptor_bytes);
    let keypoints = body.required_column(KEYPOINTS, |node| node.list(limits::FEATURES, keypoint));
    let map_points = body.optional_column(MAP_POINTS, |node| {
        node.list(limits::FEATURES, |point| {
            point.whole(limits::POINT_OR_NONE).map(|id| (id >= 0).then_some(id))
        })
    });
    let descriptors = body.required("descriptors", |node| {
        let bytes = node.bytes()?;
        // Both counts are needed to say how long it should be; where one is wrong, that has been said.
        let (Some(each), Some(keypoints)) = (descriptor_bytes, &keypoints) else { return Some(bytes) };
        if bytes.len() != each * keypoints.len() {
            let limit =
                format!("{} bytes: {each} for each of {} keypoints", each * keypoints.len(), keypoints.len());
            return node.refuse(format!("the descriptors are {}", counted(bytes.len(), "byte")), limit);
        }
        Some(bytes)
    });
    body.parallel_columns(KEYPOINTS, MAP_POINTS)?;
    let keypoints = keypoints?;
    Some(Features {
        descriptor_bytes: descriptor_bytes?,
        descriptors: descriptors?,
        map_points: map_points?.unwrap_or_else(|| vec![None; keypoints.len()]),
        keypoints,
    })
}

fn descriptor_bytes(node: &Node<'_>) -> Option<usize> {
    let bytes = node.whole(limits::DESCRIPTOR_BYTES)?;
    if bytes % 8 != 0 {
        return node.refuse("descriptors are compared 8 bytes at a time", "a multiple of 8");
    }
    usize::try_from(bytes).ok()
}

fn keypoint(node: &Node<'_>) -> Option<Keypoint> {
    let numbers = node.value();
    if numbers.kind() == Kind::List && !(2..=4).contains(&numbers.len()) {
        return node.refuse("a keypoint is [u,v], [u,v,octave] or [u,v,octave,angle_deg]", "2 to 4 numbers");
    }
    let mut keypoint = Keypoint { u: 0.0, v: 0.0, octave: 0, angle_deg: None };
    node.each(4, |at, number| {
        match at {
            0 => keypoint.u = number.number(limits::PIXEL)?,
            1 => keypoint.v = number.number(limits::PIXEL)?,
            2 => keypoint.octave = number.whole(limits::OCTAVE)? as u8,
            _ => keypoint.angle_deg = Some(number.number(limits::ANGLE_DEG)?),
        }
        Some(())
    })?;
    Some(keypoint)
}
