//! Of maps.

use revisit_core::domain::settings::Settings;
use serde_json::{Value, json};

use super::parts::{TURNED, list, list_at, second, transform, with};
use crate::settings::MapSettings;

/// Returns a map to be made.
pub fn map_body() -> Value {
    json!({
        "description": "Ninth floor of the tower",
        "metric": true,
        "gravity": [0.0, 1.0, 0.0],
        "anchor_classes": ["door_number"],
        "code_classes": ["asset_tag"],
        "settings": {"candidates_max": 20}
    })
}

/// Returns a change to a map.
pub fn map_patch() -> Value {
    json!({"anchor_classes": ["door_number", "floor_plaque"], "settings": {"without_anchors": "geometry"}})
}

/// Returns a map.
pub fn map() -> Value {
    let members = json!({
        "id": "tower",
        "map_version": 412,
        "settings": MapSettings::from(&Settings::default()),
        "keyframes": 120,
        "anchors": 24,
        "sessions": 2,
        "loops": 1,
        "bytes": 5_242_880, "numbering": {"door_number": ["#.99"]}, "twins": []
    });
    with(map_body(), members)
}

/// Maps.
pub fn maps() -> Value {
    list([map()])
}

/// Returns the map's version.
pub fn map_version() -> Value {
    json!({"map_version": 413})
}

/// Returns the sessions of a map: a plan's frame, and a robot's run that is aligned to it.
pub fn sessions() -> Value {
    let robot = json!({
        "session": "robot-7",
        "keyframes": 120,
        "first": second(1_760_000_000),
        "last": {"sec": 1_760_000_240, "nanosec": 500_000_000},
        "frame": "plan:9",
        "plan_from_session": transform([12.0, 3.5, 0.0], TURNED),
        "inliers": 5,
        "uncertainty": {"translation_m": 0.21, "rotation_rad": 0.018}
    });
    list_at(413, [json!({"session": "plan:9", "keyframes": 0, "priors": 42}), robot])
}

/// Returns a release to be published.
pub fn release_body() -> Value {
    json!({"description": "After the November survey"})
}

/// Returns a release.
pub fn release() -> Value {
    json!({
        "name": "2026-11",
        "description": "After the November survey",
        "map_version": 412,
        "published": second(1_763_800_000),
        "keyframes": 120, "anchors": 24, "sessions": 2, "loops": 1,
        "bytes": 5_242_880, "erasures": 0,
        "asked_by": [{"session": "robot-7", "queries": 311, "last": second(1_764_000_000)}]
    })
}

/// Releases of a map.
pub fn releases() -> Value {
    list([release()])
}

/// Returns what changed since a release.
pub fn release_changes() -> Value {
    json!({
        "since_version": 412, "until_version": 431,
        "keyframes_added": 1, "keyframes_removed": 0, "keyframes_moved": 1,
        "anchors_added": 0, "anchors_removed": 0, "anchors_described": 0, "anchors_retired": 1, "anchors_returned": 0,
        "keyframes": [
            {"change": "added", "keyframe": "kf-121"},
            {"change": "moved", "keyframe": "kf-7", "moved_m": 0.12}
        ],
        "anchors": [
            {"change": "retired", "anchor": "a-12", "class": "door_number", "before": "901", "after": "901"}
        ]
    })
}

/// Returns what is to be erased.
pub fn erasure_body() -> Value {
    json!({"sessions": ["robot-7"]})
}

/// Returns an erasure.
pub fn erasure() -> Value {
    json!({
        "id": "e-1", "state": "done", "keyframes": 120, "releases": 1,
        "begun": second(1_764_000_000), "ended": second(1_764_000_007),
        "older_backups": ["nightly-2026-11-24"]
    })
}
