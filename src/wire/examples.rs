//! Examples: one of each body and answer, as the API document shows them.
//!
//! They tell one story: a corridor, a door with the number 901, and a robot that comes back to it.

use serde_json::{Value, json};

use super::settings::MapSettings;
use crate::model::settings::Settings;

/// A map to be made.
pub fn map_body() -> Value {
    json!({
        "description": "Ninth floor of the tower",
        "metric": true,
        "anchor_classes": ["door_number"],
        "settings": {"candidates_max": 20}
    })
}

/// A change to a map.
pub fn map_patch() -> Value {
    json!({"anchor_classes": ["door_number", "floor_plaque"], "settings": {"without_anchors": "geometry"}})
}

/// A map.
pub fn map() -> Value {
    json!({
        "id": "tower",
        "map_version": 412,
        "description": "Ninth floor of the tower",
        "metric": true,
        "anchor_classes": ["door_number"],
        "settings": MapSettings::from(&Settings::default()),
        "keyframes": 120,
        "anchors": 24,
        "sessions": 2,
        "loops": 1,
        "bytes": 5_242_880
    })
}

/// Maps.
pub fn maps() -> Value {
    json!({"items": [map()], "next_cursor": null})
}

/// A keyframe to be stored.
pub fn keyframe_body() -> Value {
    json!({
        "session": "robot-7",
        "stamp": {"sec": 1, "nanosec": 0},
        "pose": transform(),
        "camera": {"fx": 525.0, "fy": 525.0, "cx": 320.0, "cy": 240.0, "width": 640, "height": 480},
        "bow": {"words": [3, 17], "weights": [0.4, 0.6]},
        "features": {
            "descriptor_bytes": 8,
            "descriptors": "AAECAwQFBgcICQoLDA0ODw==",
            "keypoints": [[100.5, 80.25], [310.0, 200.0, 2.0, 45.0]],
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
            "crop": "iVBORw0KGgo="
        }]
    })
}

fn transform() -> Value {
    json!({"translation": {"x": 1.5, "y": 0.0, "z": 0.25}, "rotation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}})
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

/// A keyframe as it stands.
pub fn keyframe() -> Value {
    json!({
        "id": "kf-120",
        "map_version": 412,
        "session": "robot-7",
        "stamp": {"sec": 1, "nanosec": 0},
        "pose": transform(),
        "bow": {"words": [3, 17], "weights": [0.4, 0.6]},
        "map_points": {"ids": [12], "positions": [[0.5, 0.0, 2.0]]},
        "observes": [12, 13],
        "covisible": [{"keyframe": "kf-119", "shared": 87}],
        "covisible_total": 12,
        "detections": [{
            "class": "door_number",
            "confidence": 0.93,
            "box": [300.0, 180.0, 340.0, 220.0],
            "map_points": [12, 13],
            "text": "901",
            "has_crop": false,
            "anchor": "a-7",
            "outcome": "observed",
            "state": "valid"
        }]
    })
}

/// Keyframes.
pub fn keyframes() -> Value {
    let line = json!({
        "id": "kf-120", "session": "robot-7", "stamp": {"sec": 1, "nanosec": 0}, "pose": transform(),
        "covisible": 12, "anchors": ["a-7"]
    });
    json!({"map_version": 412, "items": [line], "next_cursor": "kf-120"})
}

/// One line of a bulk request.
pub fn bulk_body() -> Value {
    json!({"id": "kf-120", "stamp": {"sec": 1, "nanosec": 0}, "pose": transform()})
}

/// One line of a bulk answer.
pub fn bulk_line() -> Value {
    json!({"id": "kf-120", "line": 1, "status": 201, "map_version": 412, "covisible": 12, "detections": []})
}

/// Covisible keyframes.
pub fn covisible() -> Value {
    json!({"map_version": 412, "items": [{"keyframe": "kf-119", "shared": 87}], "next_cursor": null})
}

/// A local anchor map.
pub fn local_anchor_map() -> Value {
    json!({
        "keyframe": "kf-120",
        "map_version": 412,
        "anchors": [{
            "anchor": "a-7", "class": "door_number", "state": "valid", "description": "901",
            "bearing": [0.0, 0.0, 1.0], "distance_m": 2.0, "weight": 0.5
        }]
    })
}

/// Corrected poses.
pub fn poses_body() -> Value {
    json!({
        "session": "robot-7",
        "keyframes": {"ids": ["kf-120"], "poses": [transform()]},
        "map_points": {"ids": [12], "positions": [[0.5, 0.0, 2.0]]}
    })
}

/// Poses are corrected.
pub fn poses_answer() -> Value {
    json!({"map_version": 413, "keyframes": 1, "map_points": 1})
}

/// An anchor.
pub fn anchor() -> Value {
    let bounds = json!({"min": [0.5, 0.0, 2.0], "max": [0.75, 0.25, 2.0]});
    json!({
        "id": "a-7",
        "map_version": 412,
        "class": "door_number",
        "state": "valid",
        "description": "901",
        "description_source": "readings",
        "identifiers": ["901"],
        "information_level": 4,
        "readings": [{"text": "901", "weight": 2.79, "count": 3}, {"text": "907", "weight": 0.4, "count": 1}],
        "keyframes": ["kf-119", "kf-120"],
        "box": bounds,
        "center": [0.625, 0.125, 2.0],
        "frames": [{"session": "robot-7", "box": bounds, "center": [0.625, 0.125, 2.0]}],
        "map_points": 2,
        "matches": [{
            "anchor": "a-2", "level": 5, "source": "identical", "kind": "revisit",
            "reason": "both read 901"
        }],
        "matches_total": 1,
        "merged_from": [],
        "has_crop": true,
        "version": 4
    })
}

/// How an anchor was described.
pub fn transcript() -> Value {
    let step = |question: &str| json!({"speaker": "model:blip-2", "question": question, "answer": "901"});
    json!({
        "map_version": 412,
        "anchor": "a-7",
        "items": [{
            "keyframe": "kf-120", "detection": 0, "text": "901", "source": "model:blip-2", "degraded": false,
            "steps": [
                step("Which text, number, name or code is written on this door number?"),
                step("Read the number, name or code on it once more, character by character.")
            ]
        }]
    })
}

/// Anchors.
pub fn anchors() -> Value {
    let mut item = anchor();
    item.as_object_mut().map(|members| members.remove("map_version"));
    json!({"map_version": 412, "items": [item], "next_cursor": null})
}

/// A description by hand.
pub fn anchor_patch() -> Value {
    json!({"description": "room 901"})
}

/// A loop query.
pub fn loop_query() -> Value {
    json!({"keyframe": "kf-120", "verify": "auto", "max_wait_ms": 0, "seed": 0})
}

/// The answer to a loop query.
pub fn loop_answer() -> Value {
    json!({
        "id": "q-2f6f6d0a4c1b",
        "map_version": 412,
        "verdict": "loop",
        "best": "kf-3",
        "loops": ["kf-3"],
        "degraded": false,
        "excluded_covisible": 12,
        "candidates": [
            {
                "keyframe": "kf-3",
                "verdict": "loop",
                "bow": {"score": 0.31, "common_words": 412, "reference_score": 0.22},
                "anchors": {
                    "similarity": 0.71, "threshold": 0.3, "in_query": 4, "in_candidate": 3, "pending": 0,
                    "matches": [{
                        "query_anchor": "a-7", "candidate_anchor": "a-2", "level": 5, "source": "identical",
                        "angle_difference_rad": 0.1, "distance_difference_m": 0.3, "weight": 1.2
                    }],
                    "contradictions": []
                },
                "geometry": {
                    "status": "verified", "model": "sim3", "matches": 190, "hypotheses": 34, "inliers": 143,
                    "mean_reprojection_error_px": 1.2,
                    "candidate_from_query": {
                        "scale": 1.0,
                        "translation": {"x": 0.2, "y": 0.0, "z": -0.1},
                        "rotation": {"x": 0.0, "y": 0.087, "z": 0.0, "w": 0.9962}
                    }
                }
            },
            {
                "keyframe": "kf-44",
                "verdict": "rejected",
                "bow": {"score": 0.28, "common_words": 390, "reference_score": 0.22},
                "anchors": {
                    "similarity": 0.0, "threshold": 0.3, "in_query": 4, "in_candidate": 2, "pending": 0,
                    "matches": [],
                    "contradictions": [{
                        "query_anchor": "a-7", "candidate_anchor": "a-11",
                        "reason": "reads 910 where 901 hung", "weight": 1.0
                    }]
                },
                "geometry": {"status": "skipped", "reason": "an earlier check decided"},
                "reason": {
                    "code": "contradiction", "measured": 1.0, "limit": 0.0,
                    "detail": "1 pair of sure identifiers contradicts"
                }
            }
        ]
    })
}

/// A loop that the client closed.
pub fn loop_body() -> Value {
    json!({"id": "loop-1", "keyframe": "kf-120", "candidate": "kf-3", "query": "q-2f6f6d0a4c1b"})
}

/// A loop is closed.
pub fn loop_closed() -> Value {
    json!({"id": "loop-1", "map_version": 413, "merged": [{"into": "a-2", "from": "a-7"}]})
}

/// A loop is revoked.
pub fn loop_revoked() -> Value {
    json!({"id": "loop-1", "map_version": 414, "split": [{"into": "a-2", "from": "a-7"}]})
}

/// Confirmed loops.
pub fn loops() -> Value {
    let item = json!({
        "id": "loop-1", "keyframe": "kf-120", "candidate": "kf-3", "query": "q-2f6f6d0a4c1b",
        "merged": [{"into": "a-2", "from": "a-7"}]
    });
    json!({"map_version": 413, "items": [item], "next_cursor": null})
}

/// The data of one event.
pub fn event() -> Value {
    json!({"seq": 31, "event": "loop_found", "map_version": 412, "keyframe": "kf-120", "candidate": "kf-3",
        "query": "q-2f6f6d0a4c1b"})
}

/// Events as the stream carries them.
pub fn event_stream() -> String {
    format!("id: 31\nevent: loop_found\ndata: {}\n\n", event())
}

/// Two texts.
pub fn text_pair() -> Value {
    json!({"a": "room 901", "b": "door number 901 in black letters", "class": "door_number"})
}

/// One text.
pub fn one_text() -> Value {
    json!({"text": "room 901", "class": "door_number"})
}

/// SimilarityLevel.
pub fn similarity() -> Value {
    json!({"level": 5, "source": "identifiers", "reason": "both name room 901", "cached": false, "degraded": false})
}

/// InformationLevel.
pub fn information() -> Value {
    json!({"level": 5, "source": "lexical", "reason": "an identifier with its role", "cached": false,
        "degraded": false})
}

/// MergeText.
pub fn merged_text() -> Value {
    json!({"text": "door number 901 in black letters", "source": "lexical", "cached": false, "degraded": false})
}

/// Usage.
pub fn usage() -> Value {
    json!(super::usage::Usage::without_models())
}

/// A backup to be taken.
pub fn backup_body() -> Value {
    json!({"id": "before-the-upgrade"})
}

fn backup() -> Value {
    json!({
        "id": "before-the-upgrade",
        "created": {"sec": 1_793_000_000, "nanosec": 0},
        "bytes": 73_400_320,
        "sha256": "9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08",
        "schema": 2,
        "maps": 3,
        "keyframes": 12_041,
        "anchors": 310
    })
}

/// A backup was taken.
pub fn backup_taken() -> Value {
    let mut taken = backup();
    taken["removed"] = json!(["b-1792000000"]);
    taken
}

/// Backups.
pub fn backups() -> Value {
    json!({"items": [backup()], "next_cursor": null})
}

/// The map's version.
pub fn map_version() -> Value {
    json!({"map_version": 413})
}

/// The process is alive.
pub fn health() -> Value {
    json!({"status": "alive"})
}

/// The server is ready.
pub fn ready() -> Value {
    json!({"status": "ready"})
}

/// A version.
pub fn version() -> Value {
    json!({"name": "revisit", "version": "0.1.0", "sqlite": "3.51.3", "vocabulary": null})
}

/// The beginning of the API document.
pub fn document() -> Value {
    json!({"openapi": "3.1.0", "info": {"title": "Revisit", "version": "0.1.0"}, "paths": {}})
}

/// A refusal.
pub fn problem() -> Value {
    json!({
        "type": "/docs#problem-invalid",
        "title": "The body does not mean what it should",
        "status": 422,
        "detail": "2 fields are wrong",
        "code": "invalid",
        "request_id": "6c0f2a9e51d34b77-1f",
        "errors": [
            {"pointer": "/pose/rotation", "detail": "not a unit quaternion: its norm is 0",
             "got": "an object of 4 fields", "limit": "a norm of 1, within 1 %"},
            {"pointer": "/stamp", "detail": "the field is required"}
        ]
    })
}
