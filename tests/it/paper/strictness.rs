//! The gates of §V-B, in the answer: settings move them; `crates/core/tests/paper/strictness.rs` asks the core.

use serde_json::{Value, json};

use super::equation::compared;
use super::scene::{close_to, door};

#[tokio::test]
async fn the_settings_of_a_request_move_each_gate() {
    let found = async |mut settings: Value| {
        settings["method"] = json!("paper");
        let there = door("room 901", [0.0, 0.0, 3.0]);
        compared(&settings, [door("901", [0.0, 0.0, 2.0])], [there]).await
    };
    let exactly_a_metre = found(json!({})).await;
    let reason = &exactly_a_metre["reason"];
    assert_eq!(reason["code"], "score_below_threshold", "{exactly_a_metre:#}");
    close_to("measured", &reason["measured"], 0.0);
    close_to("limit", &reason["limit"], 0.3);
    let further = found(json!({"anchor_map_max_distance_difference_m": 1.5})).await;
    assert_eq!((&further["verdict"], further.get("reason")), (&json!("loop"), None));
    for (gate, value) in [
        ("anchor_map_max_angle_difference_rad", json!(0.0)),
        ("anchor_map_min_similarity", json!(1.0)),
        ("matching_min_similarity_level", json!(5)),
    ] {
        let mut settings = json!({"anchor_map_max_distance_difference_m": 1.5});
        settings[gate] = value;
        let is_loop = found(settings).await["verdict"] == "loop";
        assert_eq!(
            is_loop,
            gate == "matching_min_similarity_level",
            "{gate}: 901 and room 901 are of level 5"
        );
    }
}
