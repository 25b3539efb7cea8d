//! The list of verdicts: what the fleet was answered, and why, after the answers themselves are gone.

use std::cell::Cell;

use serde_json::{Value, json};

use crate::support::{Server, pose};

const MAP: &str = "/v1/maps/hotel";

/// A keyframe before one door.
fn before(plate: &str, second: u64, session: &str) -> Value {
    json!({"stamp": {"sec": second, "nanosec": 0}, "session": session, "pose": pose([0.0; 3]),
        "bow": {"words": [3, 17, 42], "weights": [1, 1, 1]},
        "detections": [{"class": "door_number", "confidence": 0.9, "box": [300, 200, 340, 220], "position": [0.4, 0, 2],
            "text": plate}]})
}

async fn asked(server: &Server, keyframe: &str, body: &Value) -> Value {
    server.put(&format!("{MAP}/keyframes/{keyframe}?query=loop"), body).await.expect(201)["loop"].take()
}

async fn list(server: &Server, query: &str) -> Value {
    server.get(&format!("{MAP}/loop-queries{query}")).await.expect(200)
}

fn keyframes(list: &Value) -> Vec<&str> {
    list["items"].as_array().unwrap().iter().map(|item| item["keyframe"].as_str().unwrap()).collect()
}

#[tokio::test]
async fn verdicts_are_listed_by_answer_reason_session_and_time_and_erased_with_a_session() {
    let server = Server::start().await;
    server.put(MAP, &json!({})).await.expect(201);
    asked(&server, "kf-1", &before("901", 1, "monday")).await;
    let wrong = asked(&server, "kf-2", &before("910", 90, "tuesday")).await;
    // The second of a row of rejections is listed, and no event of its own.
    asked(&server, "kf-3", &before("910", 91, "tuesday")).await;
    let right = asked(&server, "kf-4", &before("901", 900, "wednesday")).await;
    assert_eq!(
        (&wrong["verdict"], &right["verdict"]),
        (&json!("no_loop"), &json!("loop")),
        "{wrong:#} {right:#}"
    );

    let all = list(&server, "").await;
    assert_eq!(keyframes(&all), ["kf-4", "kf-3", "kf-2", "kf-1"], "{all:#}");
    let line = &all["items"][2];
    for (field, value) in [
        ("query", &wrong["id"]),
        ("why", &wrong["why"]),
        ("reason", &wrong["candidates"][0]["reason"]["code"]),
        ("candidate", &json!("kf-1")),
        ("session", &json!("tuesday")),
        ("is_whole", &json!(true)),
    ] {
        assert_eq!(line[field], *value, "{field}: {line:#}");
    }
    let second = line["time"]["sec"].as_i64().unwrap();
    for (query, expected) in [
        ("?verdict=loop", &["kf-4"][..]),
        ("?session=monday", &["kf-1"]),
        ("?reason=contradiction&session=tuesday", &["kf-3", "kf-2"]),
        ("?verdict=undecided", &[]),
        (&format!("?since={}&limit=1", second - 60), &["kf-4"]),
        (&format!("?until={}", second - 60), &[]),
        (&format!("?since={}", second + 3600), &[]),
    ] {
        assert_eq!(keyframes(&list(&server, query).await), expected, "{query}");
    }
    let part = list(&server, "?limit=3").await;
    let rest = list(&server, &format!("?limit=3&cursor={}", part["next_cursor"].as_str().unwrap())).await;
    assert_eq!((keyframes(&rest), &rest["next_cursor"]), (vec!["kf-1"], &Value::Null));
    let refused = server.get(&format!("{MAP}/loop-queries?verdict=maybe&since=now&colour=red")).await;
    let mut named = refused.pointers();
    named.sort_unstable();
    assert_eq!((refused.status.as_u16(), named.as_slice()), (422, &["?colour", "?since", "?verdict"][..]));

    let told = server.event(&format!("{MAP}/events"), |event| event["event"] == "loop_rejected").await;
    assert_eq!((&told["keyframe"], &told["detail"]), (&json!("kf-2"), &wrong["why"]), "{told:#}");
    assert!(told["time"]["sec"].as_i64().unwrap() >= second - 1, "{told:#}");
    let rejections = Cell::new(0);
    let until_found = |event: &Value| {
        rejections.set(usize::from(event["event"] == "loop_rejected") + rejections.get());
        event["event"] == "loop_found"
    };
    let events = format!("{MAP}/events?since={}", told["seq"]);
    server.event(&events, until_found).await;
    assert_eq!(rejections.get(), 0, "kf-3 goes on with what was told of kf-2");

    server.post(&format!("{MAP}/erase"), &json!({"sessions": ["monday"]})).await.expect(202);
    while !keyframes(&list(&server, "").await).is_empty() {}
}
