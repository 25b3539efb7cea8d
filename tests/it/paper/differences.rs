//! M7, "why not?", in the answer; `core/tests/paper/differences.rs` asks the core.

use serde_json::json;

use super::equation::compared;
use super::scene::{close_to, door, list};

#[tokio::test]
async fn a_difference_is_told_with_both_identifiers_and_its_figures_where_it_has_any() {
    let plate = |z: f64, text: &str| [door(text, [0.0, 0.0, z])];
    let apart = compared(&json!({}), plate(1.0, "104"), plate(2.5, "110")).await;
    let pair = &list(&apart["anchors"]["differences"])[0];
    assert_eq!(pair["reason"], "another_place", "{apart:#}");
    assert_eq!([&pair["query_identifier"], &pair["candidate_identifier"]], ["104", "110"]);
    close_to("measured", &pair["measured"], 1.5);
    close_to("limit", &pair["limit"], 1.0);
    assert!(!pair["detail"].as_str().unwrap_or_default().is_empty(), "{pair}");
    assert_eq!(apart["reason"]["code"], "contradiction");

    let ignored = compared(&json!({"method": "paper"}), plate(1.0, "104"), plate(1.0, "110")).await;
    let pair = &list(&ignored["anchors"]["differences"])[0];
    assert_eq!(pair["reason"], "veto_off");
    assert!(pair.get("measured").is_none() && pair.get("limit").is_none(), "{pair}");
}
