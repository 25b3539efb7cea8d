//! Of "where am I?".

use serde_json::{Value, json};

use super::keyframes::keyframe_body;
use super::parts::transform;

/// Returns a question about one keyframe without a pose.
pub fn locate() -> Value {
    let stored = keyframe_body();
    json!({
        "keyframe": {
            "camera": stored["camera"],
            "bow": stored["bow"],
            "detections": [
                {"class": "door_number", "confidence": 0.93, "box": [280.0, 200.0, 330.0, 225.0],
                 "position": [-0.3, -0.4, 3.1], "text": "901"},
                {"class": "door_number", "confidence": 0.91, "box": [400.0, 205.0, 440.0, 225.0],
                 "position": [1.4, -0.4, 5.2], "text": "903"}
            ]
        },
        "maps": ["tower", "annex*"],
        "hint": {"map": "tower"},
        "max": 5
    })
}

/// Returns the answer to it.
pub fn locate_answer() -> Value {
    json!({
        "verdict": "located",
        "why": "It reads 901 and 903; no other place of the maps does.",
        "confidence": 0.9921,
        "places": [{
            "map": "tower",
            "keyframe": "kf-3",
            "session": "robot-7",
            "verdict": "located",
            "confidence": 0.9921,
            "evidence": [
                {"kind": "name", "about": "901", "log_odds": 5.3},
                {"kind": "name", "about": "903", "log_odds": 5.3},
                {"kind": "neighbour", "about": "the place next to it has these names around it as well", "log_odds": -3.7},
                {"kind": "view", "about": "0 cells", "log_odds": -2.067}
            ],
            "map_from_camera": transform([12.1, 0.4, 1.2], [-0.5, 0.5, -0.5, 0.5]),
            "uncertainty": {"translation_m": 0.45, "rotation_rad": 0.16},
            "pose_source": "anchors",
            "assumed": ["upright"],
            "signs": {"agreeing": ["901", "903"], "contradicting": 0},
            "verified_views": 0,
            "bow": {"score": 0.21, "common_words": 2, "reference_score": 0.0},
            "geometry": {"status": "skipped", "reason": "the query has no features or no camera"}
        }],
        "look_for": [],
        "maps": [
            {"map": "annex-1", "map_version": 87, "words_compared": true},
            {"map": "tower", "map_version": 412, "words_compared": true}
        ]
    })
}
