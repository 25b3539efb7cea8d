//! M7, contradictions, in the answer; `crates/core/tests/paper/contradiction.rs` asks the core.

use serde_json::json;

use super::equation::compared;
use super::scene::{close_to, door, list};

#[tokio::test]
async fn a_contradiction_is_told_with_its_weight_and_both_numbers() {
    let plate = |text: &str| [door(text, [0.0, 0.0, 1.0])];
    let found = compared(&json!({}), plate("901"), plate("910")).await;
    assert_eq!([&found["verdict"], &found["reason"]["code"]], ["rejected", "contradiction"]);
    assert!(found["confidence"].as_f64() < Some(0.01), "{found:#}");
    assert_eq!(found["reason"]["limit"], 0.99);
    let contradictions = list(&found["anchors"]["contradictions"]);
    assert_eq!(contradictions.len(), 1, "{found:#}");
    let pair = &contradictions[0];
    assert_eq!([&pair["query_anchor"], &pair["candidate_anchor"]], ["a-1", "a-0"]);
    close_to("weight", &pair["weight"], 2.0);
    for text in [&found["reason"]["detail"], &pair["reason"]] {
        let text = text.as_str().unwrap_or_default();
        assert!(text.contains("901") && text.contains("910"), "{text:?}");
    }
    let paper = compared(&json!({"method": "paper"}), plate("901"), plate("910")).await;
    assert_eq!(paper["anchors"]["contradictions"], json!([]));
}
