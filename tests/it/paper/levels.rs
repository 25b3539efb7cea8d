//! §IV-A.2 and M14, asked of the service: the text functions; `crates/core/src/semantics/golden.rs` asks the core.

use serde_json::{Value, json};

use crate::support::Server;

async fn asked(server: &Server, function: &str, body: Value) -> Value {
    let answer = server.post(&format!("/v1/semantics/{function}"), &body).await.expect(200);
    assert_eq!([&answer["cached"], &answer["degraded"]], [&json!(false), &json!(false)]);
    assert!(!answer["source"].as_str().unwrap_or_default().is_empty(), "{answer}");
    answer
}

#[tokio::test]
async fn the_text_functions_give_the_built_in_judges_levels_with_reasons() {
    let server = Server::start().await;
    for (a, b, level) in [("room 901", "Room 901", 5), ("901", "A 901", 3), ("901", "910", 1)] {
        let answer = asked(&server, "similarity", json!({"a": a, "b": b, "class": "door_number"})).await;
        assert_eq!(answer["level"], level, "{a:?} / {b:?}: {answer}");
        assert!(!answer["reason"].as_str().unwrap_or_default().is_empty(), "{answer}");
    }
    for (text, level) in [("room 901", 5), ("901", 4), ("brown door", 3), ("exit", 2), ("", 1)] {
        let answer = asked(&server, "information", json!({"text": text})).await;
        assert_eq!(answer["level"], level, "{text:?}: {answer}");
    }
    let merged = asked(&server, "merge", json!({"a": "room 901", "b": "brown door"})).await;
    let text = merged["text"].as_str().unwrap_or_default();
    assert!(text.contains("901") && text.contains("brown"), "{merged}");
}
