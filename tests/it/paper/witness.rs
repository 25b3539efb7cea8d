//! M22, texts that need a witness, in the answer; `core/tests/paper/witness.rs` asks the core.

use serde_json::json;

use super::equation::compared;
use super::scene::{close_to, door, thing};

#[tokio::test]
async fn a_slogan_alone_is_told_to_lack_a_witness() {
    let slogan = || thing("sign", "Be Updated").at([0.0, 0.0, 1.0]);
    let alone = compared(&json!({}), [slogan()], [slogan()]).await;
    close_to("S", &alone["anchors"]["similarity"], 1.0);
    assert_eq!([&alone["verdict"], &alone["reason"]["code"]], ["undecided", "no_witness"]);
    let numbered = || [slogan(), door("901", [0.5, 0.0, 1.0])];
    assert_eq!(compared(&json!({}), numbered(), numbered()).await["verdict"], "loop");
    let off = json!({"single_text_needs_witness": false});
    assert_eq!(compared(&off, [slogan()], [slogan()]).await["verdict"], "loop");
}
