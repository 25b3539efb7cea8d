//! Of loop queries, confirmed loops and events.

use serde_json::{Value, json};

use super::parts::{list, list_at, second, with};

/// Returns a loop query.
pub fn loop_query() -> Value {
    json!({"keyframe": "kf-120", "verify": "auto", "max_wait_ms": 0, "seed": 0})
}

/// Returns the answer to a loop query.
pub fn loop_answer() -> Value {
    json!({
        "id": "q-2f6f6d0a4c1b",
        "map_version": 412,
        "verdict": "loop",
        "why": "Both read 901; no other place in this map does.",
        "confidence": 0.997_527_377,
        "best": "kf-3",
        "loops": ["kf-3"],
        "degraded": false,
        "excluded_covisible": 12,
        "closed": [],
        "candidates": [
            {
                "keyframe": "kf-3",
                "verdict": "loop",
                "bow": {"score": 0.31, "common_words": 412, "reference_score": 0.22},
                "anchors": {
                    "similarity": 0.71, "threshold": 0.3, "in_query": 4, "in_candidate": 3, "pending": 0,
                    "matches": [{
                        "query_anchor": "a-7", "candidate_anchor": "a-2", "kind": "name", "level": 5, "source": "identical",
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
                },
                "confidence": 0.997_527_377,
                "evidence": [
                    {"kind": "name", "about": "901", "query_anchors": ["a-7"], "candidate_anchors": ["a-2"], "log_odds": 5.3},
                    {"kind": "view", "about": "74 cells", "log_odds": 10.267},
                    {"kind": "copy", "about": "a copy of the place would show the same", "log_odds": -9.567}
                ]
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
                "geometry": {"status": "skipped"},
                "confidence": 0.004_496_273,
                "evidence": [{
                    "kind": "other_name", "about": "910 / 901", "query_anchors": ["a-7"], "candidate_anchors": ["a-11"],
                    "log_odds": -5.4
                }],
                "reason": {
                    "code": "contradiction", "measured": 0.004, "limit": 0.99,
                    "detail": "reads 910 where 901 hung"
                }
            }
        ]
    })
}

/// Returns a loop that the client closed.
pub fn loop_body() -> Value {
    json!({"id": "loop-1", "keyframe": "kf-120", "candidate": "kf-3", "query": "q-2f6f6d0a4c1b"})
}

/// A loop is closed.
pub fn loop_closed() -> Value {
    json!({"id": "loop-1", "map_version": 413, "merged": [{"into": "a-2", "from": "a-7"}], "warnings": []})
}

/// A loop is revoked.
pub fn loop_revoked() -> Value {
    json!({"id": "loop-1", "map_version": 414, "split": [{"into": "a-2", "from": "a-7"}]})
}

/// Confirmed loops.
pub fn loops() -> Value {
    list_at(413, [with(loop_body(), json!({"merged": [{"into": "a-2", "from": "a-7"}]}))])
}

/// Verdicts in a line each.
pub fn verdicts() -> Value {
    let item = json!({
        "query": "q-2f6f6d0a4c1b", "time": second(1_782_907_200), "keyframe": "kf-120", "session": "robot-1",
        "candidate": "kf-3", "map_version": 412, "verdict": "no_loop", "reason": "contradiction",
        "why": "It reads 910 where 901 hung.", "is_whole": true
    });
    list([item])
}

/// Returns the data of one event.
pub fn event() -> Value {
    json!({"seq": 31, "event": "loop_found", "map_version": 412, "time": second(1_782_907_200),
        "keyframe": "kf-120", "candidate": "kf-3", "query": "q-2f6f6d0a4c1b"})
}

/// Events as the stream carries them.
pub fn event_stream() -> String {
    format!("id: 31\nevent: loop_found\ndata: {}\n\n", event())
}
