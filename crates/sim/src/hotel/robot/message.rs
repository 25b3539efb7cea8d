//! Message: the robot's requests, in the terms of the API document.

use crate::api::decoding::base64::Base64;
use crate::api::geometry::Similarity;
use crate::api::keyframe::{DetectionShape, FeaturesShape, KeyframeBody, KeypointShape, PointsShape};
use crate::api::map::MapBody;
use crate::api::poses::{PoseList, PosesBody};
use crate::api::space::{Position, Time, Transform};
use crate::domain::ids::KeyframeId;
use crate::domain::keyframe::Keypoint;
use crate::geometry::{Point3, Pose, Sim3};
use crate::hotel::building::texture::{DESCRIPTOR_BITS, bytes};
use crate::hotel::method::Method;
use crate::hotel::sensing::camera::CAMERA;
use crate::hotel::sequence::Step;

/// Bytes of one descriptor.
pub const DESCRIPTOR_BYTES: u32 = (DESCRIPTOR_BITS / 8) as u32;
/// Interval of the keyframes' stamps, in nanoseconds.
pub const STEP_NS: u64 = 500_000_000;

/// Returns the map of one arm.
pub fn map(arm: Method, description: &str) -> MapBody {
    MapBody {
        description: Some(description.to_owned()),
        metric: Some(!arm.is_monocular()),
        settings: Some(arm.settings()),
        ..MapBody::default()
    }
}

/// Returns a keyframe with the map points that it places; `map_from_camera` has the scale of its frame's unit.
pub fn keyframe(
    arm: Method,
    session: &str,
    number: usize,
    step: &Step,
    map_from_camera: &Sim3,
) -> KeyframeBody {
    let placed: Vec<(u64, Point3)> = (step.placed.iter())
        .map(|placed| (step.map_points[placed.feature], map_from_camera.transform(&placed.in_camera)))
        .collect();
    let detections = if arm.sees_signs() { detections(step) } else { Vec::new() };
    let stamp_ns = number as u64 * STEP_NS;
    let stamp = Time { sec: (stamp_ns / 1_000_000_000) as i64, nanosec: (stamp_ns % 1_000_000_000) as u32 };
    KeyframeBody {
        session: session.parse().ok(),
        camera: Some(CAMERA.into()),
        features: Some(features(step)),
        map_points: Some(points(&placed)),
        detections: Some(detections),
        ..KeyframeBody::at(stamp, map_from_camera.without_scale().into())
    }
}

/// Returns the features of a keyframe, as exactly as a detector tells them.
pub fn features(step: &Step) -> FeaturesShape {
    let keypoints = step.features.iter().map(|feature| {
        let Keypoint { u, v, octave, angle_deg } = feature.keypoint;
        let angle_deg = Some(hundredths(angle_deg.unwrap_or(0.0)));
        KeypointShape(Keypoint { u: hundredths(u), v: hundredths(v), octave, angle_deg })
    });
    FeaturesShape {
        descriptor_bytes: DESCRIPTOR_BYTES,
        descriptors: Base64(descriptor_bytes(step)),
        keypoints: keypoints.collect(),
        map_points: Some(step.map_points.iter().map(|id| *id as i64).collect()),
    }
}

/// Returns the concatenated descriptors of a keyframe.
pub fn descriptor_bytes(step: &Step) -> Vec<u8> {
    step.features.iter().flat_map(|feature| bytes(&feature.descriptor)).collect()
}

/// Returns corrected poses and points, after an optimisation.
pub fn poses(session: &str, keyframes: &[(KeyframeId, Pose)], moved_points: &[(u64, Point3)]) -> PosesBody {
    let (ids, poses) = keyframes.iter().map(|(id, pose)| (id.clone(), Transform::from(*pose))).unzip();
    PosesBody {
        session: session.parse().ok(),
        keyframes: Some(PoseList { ids, poses }),
        map_points: Some(points(moved_points)),
    }
}

/// Returns the transformation of an answer; its scale is 1 if the map is metric.
pub fn similarity(said: &Similarity) -> Option<Sim3> {
    let (t, q) = (said.translation, said.rotation);
    Sim3::new(said.scale, [t.x, t.y, t.z], [q.x, q.y, q.z, q.w])
}

/// Returns a rigid transformation of an answer; none if its rotation is no unit quaternion.
pub fn rigid(said: &Transform) -> Option<Sim3> {
    let (t, q) = (said.translation, said.rotation);
    Sim3::new(1.0, [t.x, t.y, t.z], [q.x, q.y, q.z, q.w])
}

/// Returns the signs that a keyframe sees.
pub fn detections(step: &Step) -> Vec<DetectionShape> {
    let detection = |seen: &crate::hotel::sequence::Detection| DetectionShape {
        class: seen.class.to_owned(),
        confidence: hundredths(seen.confidence),
        box_px: seen.bounding_box.map(hundredths),
        map_points: Some(seen.features.iter().map(|feature| step.map_points[*feature] as i64).collect()),
        position: None,
        range: None,
        text: Some(seen.text.clone()),
        description: None,
        crop: None,
    };
    step.detections.iter().map(detection).collect()
}

/// Returns map points with their positions, in metres.
pub fn points(points: &[(u64, Point3)]) -> PointsShape {
    let place = |(id, p): &(u64, Point3)| (*id as i64, Position([p.x, p.y, p.z].map(tenths_of_millimetres)));
    let (ids, positions) = points.iter().map(place).unzip();
    PointsShape { ids, positions }
}

/// Rounds to hundredths, because no sensor is more precise.
fn hundredths(value: f64) -> f64 {
    (value * 1e2).round() / 1e2
}

/// Rounds metres to tenths of millimetres.
pub fn tenths_of_millimetres(value: f64) -> f64 {
    (value * 1e4).round() / 1e4
}
