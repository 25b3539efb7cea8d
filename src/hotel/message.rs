//! Message: what the robot says to the server, in the words of the API document.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};

use super::arm::Arm;
use super::camera::{FOCAL_LENGTH_PX, IMAGE_PX};
use super::journey::Step;
use super::texture::{DESCRIPTOR_BITS, bytes};
use crate::geometry::{Point3, Pose, Sim3};
use crate::wire::geometry::Similarity;

/// Keyframes come this often by their stamps, in nanoseconds.
pub const STEP_NS: u64 = 500_000_000;

/// The map of one arm.
pub fn map(arm: Arm, description: &str) -> Value {
    json!({"description": description, "metric": !arm.is_monocular(), "settings": arm.settings()})
}

/// A keyframe with the map points that it places; `map_from_camera` has the scale of its frame's unit.
pub fn keyframe(arm: Arm, session: &str, number: usize, step: &Step, map_from_camera: &Sim3) -> Value {
    let placed: Vec<(u64, Point3)> = (step.placed.iter())
        .map(|placed| (step.map_points[placed.feature].0, map_from_camera.transform(&placed.in_camera)))
        .collect();
    let keypoints: Vec<Value> = (step.features.iter())
        .map(|feature| {
            let keypoint = feature.keypoint;
            let angle_deg = keypoint.angle_deg.unwrap_or(0.0);
            json!([hundredths(keypoint.u), hundredths(keypoint.v), keypoint.octave, hundredths(angle_deg)])
        })
        .collect();
    let map_points: Vec<u64> = step.map_points.iter().map(|(id, _)| *id).collect();
    let detections: Vec<Value> = if arm.sees_signs() { detections(step) } else { Vec::new() };
    let stamp_ns = number as u64 * STEP_NS;
    json!({
        "session": session,
        "stamp": {"sec": stamp_ns / 1_000_000_000, "nanosec": stamp_ns % 1_000_000_000},
        "pose": transform(&map_from_camera.without_scale()),
        "camera": {
            "fx": FOCAL_LENGTH_PX, "fy": FOCAL_LENGTH_PX, "cx": IMAGE_PX[0] / 2.0, "cy": IMAGE_PX[1] / 2.0,
            "width": IMAGE_PX[0] as u32, "height": IMAGE_PX[1] as u32,
        },
        "features": {
            "descriptor_bytes": DESCRIPTOR_BITS / 8,
            "descriptors": STANDARD.encode(descriptor_bytes(step)),
            "keypoints": keypoints,
            "map_points": map_points,
        },
        "map_points": points(&placed),
        "detections": detections,
    })
}

/// The descriptors of a keyframe, one after the other.
pub fn descriptor_bytes(step: &Step) -> Vec<u8> {
    step.features.iter().flat_map(|feature| bytes(&feature.descriptor)).collect()
}

/// Corrected poses and points, after an optimisation.
pub fn poses(session: &str, keyframes: &[(String, Pose)], moved_points: &[(u64, Point3)]) -> Value {
    let ids: Vec<&str> = keyframes.iter().map(|(id, _)| id.as_str()).collect();
    let poses: Vec<Value> = keyframes.iter().map(|(_, pose)| transform(pose)).collect();
    json!({"session": session, "keyframes": {"ids": ids, "poses": poses}, "map_points": points(moved_points)})
}

/// The transformation of an answer; its scale is 1 if the map is metric.
pub fn similarity(said: &Similarity) -> Option<Sim3> {
    let (t, q) = (said.translation, said.rotation);
    Sim3::new(said.scale, [t.x, t.y, t.z], [q.x, q.y, q.z, q.w])
}

fn detections(step: &Step) -> Vec<Value> {
    let detection = |seen: &super::journey::Detection| {
        let on_it: Vec<u64> = seen.features.iter().map(|feature| step.map_points[*feature].0).collect();
        json!({
            "class": seen.class,
            "confidence": hundredths(seen.confidence),
            "box": seen.bounding_box.map(hundredths),
            "map_points": on_it,
            "text": seen.text,
        })
    };
    step.detections.iter().map(detection).collect()
}

fn points(points: &[(u64, Point3)]) -> Value {
    let ids: Vec<u64> = points.iter().map(|(id, _)| *id).collect();
    let positions: Vec<[f64; 3]> =
        points.iter().map(|(_, p)| [p.x, p.y, p.z].map(tenths_of_millimetres)).collect();
    json!({"ids": ids, "positions": positions})
}

fn transform(pose: &Pose) -> Value {
    let ([x, y, z], [qx, qy, qz, qw]) = (pose.translation_m(), pose.rotation_xyzw());
    json!({"translation": {"x": x, "y": y, "z": z}, "rotation": {"x": qx, "y": qy, "z": qz, "w": qw}})
}

/// Digits that no sensor has are not sent.
fn hundredths(value: f64) -> f64 {
    (value * 1e2).round() / 1e2
}

fn tenths_of_millimetres(value: f64) -> f64 {
    (value * 1e4).round() / 1e4
}
