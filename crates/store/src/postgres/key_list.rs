//! Keys of maps as one parameter of a statement.

use crate::map_key::MapKey;

/// Returns keys as a parameter that a statement takes apart by `json_each`.
pub(super) fn list(maps: &[MapKey]) -> String {
    serde_json::json!(maps).to_string()
}
