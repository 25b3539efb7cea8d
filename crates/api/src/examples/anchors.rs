//! Of anchors, and of what is asked about their texts.

use serde_json::{Value, json};

use super::parts::{list_at, with, without};

/// Returns an anchor.
pub fn anchor() -> Value {
    let bounds = json!({"min": [0.5, 0.0, 2.0], "max": [0.75, 0.25, 2.0]});
    json!({
        "id": "a-7",
        "map_version": 412,
        "class": "door_number",
        "state": "valid",
        "description": "901",
        "kind": "name",
        "description_source": "readings",
        "identifiers": ["901"],
        "information_level": 4,
        "information_reason": "901 is an identifier",
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

/// Returns how an anchor was described.
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
    list_at(412, [without(anchor(), &["map_version"])])
}

/// Returns a sign that a plan shows.
pub fn prior_body() -> Value {
    json!({
        "class": "door_number", "description": "901", "position": [12.5, 4.0, 1.5], "frame": "plan:9",
        "normal": [0.0, 1.0, 0.0], "source": "tower.building.yaml"
    })
}

/// Returns a prior anchor.
pub fn prior_anchor() -> Value {
    let prior = without(prior_body(), &["class", "description"]);
    let place = &prior["position"];
    let bounds = json!({"min": place, "max": place});
    let members = json!({
        "id": "door-901",
        "map_version": 413,
        "description_source": "plan",
        "readings": [],
        "keyframes": [],
        "box": bounds,
        "center": place,
        "frames": [{"session": "plan:9", "box": bounds, "center": place}],
        "map_points": 0,
        "matches": [{
            "anchor": "a-7", "level": 5, "source": "identical", "kind": "revisit", "reason": "both read 901"
        }],
        "prior": prior,
        "plan_position": {"frame": "plan:9", "position": place},
        "has_crop": false,
        "version": 1
    });
    with(anchor(), members)
}

/// Returns a description by hand.
pub fn anchor_patch() -> Value {
    json!({"description": "room 901"})
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
