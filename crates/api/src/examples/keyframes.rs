//! Of keyframes, one by one and in bulk, and what follows from them.

use serde_json::{Value, json};

use super::parts::{TURNED, UPRIGHT, list_at, second, transform, with, without};

/// A PNG file of 8 by 8 pixels.
const CROP: &str = "iVBORw0KGgoAAAANSUhEUgAAAAgAAAAICAAAAADhZOFXAAAAFElEQVR42mP4DwUM/xXAgFQGFAAAjpQgZSHqsWMAAAAASUVORK5CYII=";

/// Eight numbers; a model computes hundreds.
const GLOBAL_DESCRIPTOR: &str = "AP8Cf4EDBPo=";

/// Returns a keyframe to be stored.
pub fn keyframe_body() -> Value {
    json!({
        "session": "robot-7",
        "stamp": second(1),
        "pose": pose(),
        "camera": {"fx": 525.0, "fy": 525.0, "cx": 320.0, "cy": 240.0, "width": 640, "height": 480},
        "gravity": [0.0, 1.0, 0.0],
        "bow": {"words": [3, 17], "weights": [0.4, 0.6]},
        "global_descriptor": {"model": "megaloc", "encoding": "int8", "data": GLOBAL_DESCRIPTOR},
        "features": {
            "descriptor_bytes": 8,
            "descriptors": "AAECAwQFBgcICQoLDA0ODw==",
            "keypoints": [[100.5, 80.25, 0.0], [310.0, 200.0, 2.0, 45.0]],
            "map_points": [12, -1]
        },
        "map_points": {"ids": [12, 13], "positions": [[0.5, 0.0, 2.0], [0.75, 0.25, 2.0]]},
        "observes": [12, 13],
        "covisible": [{"keyframe": "kf-119", "shared": 87}],
        "detections": [{
            "class": "door_number",
            "confidence": 0.93,
            "box": [300.0, 180.0, 340.0, 220.0],
            "map_points": [12, 13],
            "position": [0.625, 0.125, 2.0],
            "text": "901",
            "description": "door number 901 in black letters",
            "crop": CROP
        }]
    })
}

fn pose() -> Value {
    transform([1.5, 0.0, 0.25], UPRIGHT)
}

/// A keyframe is stored.
pub fn keyframe_answer() -> Value {
    json!({
        "keyframe": "kf-120",
        "map_version": 412,
        "covisible": 12,
        "detections": [{"anchor": "a-7", "outcome": "observed", "state": "valid"}]
    })
}

/// Returns a keyframe as it stands.
pub fn keyframe() -> Value {
    let mut sent = keyframe_body();
    let detection = without(sent["detections"][0].take(), &["position", "description", "crop"]);
    let became = json!({"has_crop": false, "anchor": "a-7", "outcome": "observed", "state": "valid"});
    let members = json!({
        "id": "kf-120",
        "map_version": 412,
        "map_points": {"ids": [12], "positions": [[0.5, 0.0, 2.0]]},
        "covisible_total": 12,
        "detections": [with(detection, became)]
    });
    with(without(sent, &["camera", "features"]), members)
}

/// Keyframes.
pub fn keyframes() -> Value {
    let line = json!({
        "id": "kf-120", "session": "robot-7", "stamp": second(1), "pose": pose(), "covisible": 12, "anchors": ["a-7"]
    });
    json!({"map_version": 412, "items": [line], "next_cursor": "kf-120"})
}

/// Returns the lines of a bulk request: another robot at the same door, and the keyframe before `kf-120`.
pub fn bulk_lines() -> [Value; 2] {
    let at_the_origin = transform([0.0; 3], UPRIGHT);
    let door = json!({
        "class": "door_number", "confidence": 0.9, "box": [250.0, 190.0, 290.0, 230.0], "position": [-0.9, 0.1, 1.75],
        "text": "901"
    });
    let bow = json!({"words": [3, 17], "weights": [0.5, 0.5]});
    [
        json!({"id": "kf-3", "session": "robot-3", "stamp": second(0), "pose": at_the_origin, "bow": bow,
            "detections": [door]}),
        json!({"id": "kf-119", "session": "robot-7", "stamp": {"sec": 0, "nanosec": 500_000_000}, "pose": pose()}),
    ]
}

/// Returns a bulk request.
pub fn bulk_body() -> Value {
    let lines: Vec<String> = bulk_lines().iter().map(Value::to_string).collect();
    json!(lines.join("\n") + "\n")
}

/// One line of a bulk answer.
pub fn bulk_line() -> Value {
    json!({"id": "kf-119", "line": 2, "status": 201, "map_version": 412, "covisible": 12, "detections": []})
}

/// Covisible keyframes.
pub fn covisible() -> Value {
    list_at(412, [json!({"keyframe": "kf-119", "shared": 87})])
}

/// Returns a local anchor map.
pub fn local_anchor_map() -> Value {
    json!({
        "keyframe": "kf-120",
        "map_version": 412,
        "anchors": [{
            "anchor": "a-7", "class": "door_number", "state": "valid", "description": "901", "kind": "name",
            "bearing": [0.0, 0.0, 1.0], "distance_m": 2.0, "weight": 0.5
        }]
    })
}

/// Changed observations.
pub fn observations_body() -> Value {
    json!({
        "session": "robot-7",
        "replaced": [[13, 31]],
        "removed": [14],
        "keyframes": [{
            "keyframe": "kf-120",
            "observes": [12, 31],
            "covisible": [{"keyframe": "kf-119", "shared": 91}]
        }]
    })
}

/// The map follows.
pub fn observations_answer() -> Value {
    json!({"map_version": 413, "keyframes": 2, "map_points": 2, "anchors_merged": 1})
}

/// A merge of sessions.
pub fn merge_body() -> Value {
    json!({
        "into": "robot-3",
        "into_from_session": transform([12.5, -3.25, 0.0], TURNED),
        "map_points": {"offset": 100_000}
    })
}

/// The sessions are one.
pub fn sessions_merged() -> Value {
    json!({"map_version": 414, "keyframes": 120, "map_points": 8412, "anchors_merged": 3})
}

/// The sessions are two again.
pub fn merge_revoked() -> Value {
    json!({"map_version": 415, "keyframes": 120})
}

/// One frame for all sessions.
pub fn frames() -> Value {
    let reference = transform([0.0; 3], UPRIGHT);
    let other = transform([12.5, -3.25, 0.0], TURNED);
    json!({
        "version": 416,
        "reference": "robot-3",
        "frames": [
            {"session": "robot-3", "reference_from_session": reference, "residual": 0.04, "loops": 12},
            {"session": "robot-7", "reference_from_session": other, "residual": 0.04, "loops": 12},
            {"session": "robot-9", "loops": 0}
        ],
        "suspects": [{"loop": "loop-17", "cycle": ["loop-3"], "residual": 6.2, "residual_rad": 0.01}],
        "loops": 12,
        "left_out": 2
    })
}

/// Corrected poses.
pub fn poses_body() -> Value {
    json!({
        "session": "robot-7",
        "keyframes": {"ids": ["kf-120"], "poses": [pose()]},
        "map_points": {"ids": [12], "positions": [[0.5, 0.0, 2.0]]}
    })
}

/// Poses are corrected.
pub fn poses_answer() -> Value {
    json!({"map_version": 413, "keyframes": 1, "map_points": 1})
}
