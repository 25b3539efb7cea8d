//! Of maps.

use serde_json::{Value, json};

use crate::api::settings::MapSettings;
use crate::domain::settings::Settings;

/// Returns a map to be made.
pub fn map_body() -> Value {
    json!({
        "description": "Ninth floor of the tower",
        "metric": true,
        "gravity": [0.0, 1.0, 0.0],
        "anchor_classes": ["door_number"],
        "settings": {"candidates_max": 20}
    })
}

/// Returns a change to a map.
pub fn map_patch() -> Value {
    json!({"anchor_classes": ["door_number", "floor_plaque"], "settings": {"without_anchors": "geometry"}})
}

/// Returns a map.
pub fn map() -> Value {
    json!({
        "id": "tower",
        "map_version": 412,
        "description": "Ninth floor of the tower",
        "metric": true,
        "gravity": [0.0, 1.0, 0.0],
        "anchor_classes": ["door_number"],
        "settings": MapSettings::from(&Settings::default()),
        "keyframes": 120,
        "anchors": 24,
        "sessions": 2,
        "loops": 1,
        "bytes": 5_242_880, "numbering": {"door_number": ["#.99"]}, "twins": []
    })
}

/// Maps.
pub fn maps() -> Value {
    json!({"items": [map()], "next_cursor": null})
}

/// Returns the map's version.
pub fn map_version() -> Value {
    json!({"map_version": 413})
}
