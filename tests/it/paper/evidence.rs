//! M64, the sum of evidence, in the answer; `crates/core/tests/paper/odds.rs` asks the core.

use serde_json::json;

use super::equation::compared;
use super::scene::{close_to, door, thing};

#[tokio::test]
async fn a_slogan_proves_no_more_than_that_there_is_no_copy_and_a_plate_does() {
    let slogan = || thing("sign", "Be Updated").at([0.0, 0.0, 1.0]);
    let alone = compared(&json!({}), [slogan()], [slogan()]).await;
    close_to("S", &alone["anchors"]["similarity"], 1.0);
    assert_eq!([&alone["verdict"], &alone["reason"]["code"]], ["undecided", "too_little_evidence"]);
    let numbered = || [slogan(), door("901", [0.5, 0.0, 1.0])];
    let found = compared(&json!({}), numbered(), numbered()).await;
    assert_eq!(found["verdict"], "loop", "{found:#}");
    assert_eq!([&found["evidence"][0]["kind"], &found["evidence"][0]["about"]], ["name", "901"], "{found:#}");
    let paper = compared(&json!({"method": "paper"}), [slogan()], [slogan()]).await;
    assert_eq!(paper["verdict"], "loop");
    assert!(paper.get("confidence").is_none() && paper.get("evidence").is_none(), "{paper:#}");
}
