//! Features read: three parallel lists, one of them packed in base64.

use crate::api::decoding::base64;
use crate::api::decoding::read::Node;
use crate::api::limits;
use crate::domain::counted::counted;
use crate::domain::keyframe::{Features, Keypoint};

/// Reads `features`.
pub fn decode(node: &Node<'_>) -> Option<Features> {
    let body = node.object(&["descriptor_bytes", "descriptors", "keypoints", "map_points"])?;
    let descriptor_bytes = body.required("descriptor_bytes", descriptor_bytes);
    let keypoints = body.required("keypoints", |node| node.list(limits::FEATURES, keypoint));
    let map_points = body.optional("map_points", |node| {
        node.list(limits::FEATURES, |point| {
            point.whole(limits::POINT_OR_NONE).map(|id| (id >= 0).then_some(id))
        })
    });
    let descriptors = body.required("descriptors", |node| {
        let bytes = base64::decode(node)?;
        // Both counts are needed to say how long it should be; where one is wrong, that has been said.
        let (Some(each), Some(keypoints)) = (descriptor_bytes, &keypoints) else { return Some(bytes) };
        if bytes.len() != each * keypoints.len() {
            let limit =
                format!("{} bytes: {each} for each of {} keypoints", each * keypoints.len(), keypoints.len());
            return node.refuse(format!("the descriptors are {}", counted(bytes.len(), "byte")), limit);
        }
        Some(bytes)
    });
    body.parallel("keypoints", "map_points")?;
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
    let length = node.value().as_array().map_or(2, Vec::len);
    if !(2..=4).contains(&length) {
        return node.refuse("a keypoint is [u,v], [u,v,octave] or [u,v,octave,angle_deg]", "2 to 4 numbers");
    }
    let mut at = 0;
    let numbers = node.list(4, |number| {
        at += 1;
        match at {
            1 | 2 => number.number(limits::PIXEL),
            3 => number.whole(limits::OCTAVE).map(|octave| octave as f64),
            _ => number.number(limits::ANGLE_DEG),
        }
    })?;
    Some(Keypoint {
        u: *numbers.first()?,
        v: *numbers.get(1)?,
        octave: numbers.get(2).map_or(0, |octave| *octave as u8),
        angle_deg: numbers.get(3).copied(),
    })
}
