//! A stranger's first data: what the answers say of it, and how it may be written.

use reqwest::Method;
use serde_json::{Value, json};

use crate::support::{Server, keyframe, pose};

const MAP: &str = "/v1/maps/office";

/// A keyframe so many metres along a corridor, a second a metre.
fn at(x: f64, more: &Value) -> Value {
    let mut body = keyframe();
    body.as_object_mut().expect("an object").remove("covisible");
    body["stamp"] = json!({"sec": x as u64, "nanosec": 0});
    body["pose"] = pose([x, 0.0, 0.0]);
    for (name, value) in more.as_object().expect("members") {
        body[name] = value.clone();
    }
    body
}

#[tokio::test]
async fn a_keyframe_that_nothing_joins_with_its_session_is_told_so() {
    let server = Server::with_map("office").await;
    let apart = |x: f64| at(x, &json!({}));
    let sent = [
        ("the first of its session", apart(0.0), false),
        ("a metre on", apart(1.0), false),
        ("nine metres on", apart(10.0), true),
        ("an empty list says that none is", at(11.0, &json!({"covisible": []})), true),
        ("a list", at(12.0, &json!({"covisible": [{"keyframe": "kf-0", "shared": 20}]})), false),
        ("points that nobody else sees", at(30.0, &json!({"observes": [1, 2, 3]})), true),
        ("the first of another session", at(40.0, &json!({"session": "other"})), false),
    ];
    for (number, (what, body, is_told)) in sent.into_iter().enumerate() {
        let path = format!("{MAP}/keyframes/kf-{number}");
        let stored = server.put(&path, &body).await.expect(201);
        let notice = stored["notice"].as_str();
        assert_eq!(notice.is_some(), is_told, "{what}: {stored:#}");
        assert_eq!(stored["covisible"] == 0, is_told || number == 0 || number == 6, "{what}: {stored:#}");
        assert!(notice.is_none_or(|notice| notice.contains("`covisible`")), "{what}: {stored:#}");
    }
}

#[tokio::test]
async fn a_map_in_brief_lists_the_settings_that_differ() {
    let server = Server::start().await;
    let body = json!({"settings": {"loop_min_confidence": 0.9, "building_repeats": true}});
    let brief = format!("{MAP}?detail=brief");
    let changed = json!({"loop_min_confidence": 0.9});
    assert_eq!(server.put(&brief, &body).await.expect(201)["settings"], changed);
    assert_eq!(server.put(&brief, &body).await.expect(200)["settings"], changed);
    assert_eq!(server.get(&brief).await.expect(200)["settings"], changed);
    let patch = json!({"settings": {"loop_min_confidence": 0.99}});
    assert_eq!(server.patch(&brief, &patch).await.expect(200)["settings"], json!({}));
    let whole = server.get(MAP).await.expect(200);
    assert!(whole["settings"].as_object().is_some_and(|settings| settings.len() > 20), "{whole:#}");
    assert_eq!(server.get(&format!("{MAP}?detail=some")).await.pointers(), ["?detail"]);
}

#[tokio::test]
async fn a_byte_order_mark_is_ignored_and_utf_16_is_told() {
    let server = Server::with_map("office").await;
    let text = keyframe().to_string();
    let marked = [b"\xef\xbb\xbf", text.as_bytes()].concat();
    let path = format!("{MAP}/keyframes/kf-1");
    server.send(Method::PUT, &path, "application/json", marked).await.expect(201);
    // The same facts without the mark are the same keyframe.
    server.put(&path, &keyframe()).await.expect(200);
    let mut line = keyframe();
    line["id"] = json!("kf-2");
    let lines = [b"\xef\xbb\xbf", line.to_string().as_bytes()].concat();
    let bulk = server.send(Method::POST, &format!("{MAP}/keyframes"), "application/x-ndjson", lines).await;
    assert_eq!(bulk.expect(200)["status"], 201);
    let wide: Vec<u8> = "\u{feff}{}".encode_utf16().flat_map(u16::to_le_bytes).collect();
    let refused = server.send(Method::PUT, &path, "application/json", wide).await.expect(400);
    assert!(refused["detail"].as_str().is_some_and(|detail| detail.contains("UTF-16")), "{refused:#}");
}

#[tokio::test]
async fn an_id_of_64_bits_is_refused_with_what_to_send() {
    let server = Server::with_map("office").await;
    let path = format!("{MAP}/keyframes/kf-1");
    for (name, value) in
        [("observes", json!([u64::MAX])), ("observes", json!([1_u64 << 63])), ("observes", json!([-7]))]
    {
        let refused = server.put(&path, &at(0.0, &json!({name: value}))).await.expect(422);
        assert!(refused.to_string().contains("id & 0x7fffffffffffffff"), "{refused:#}");
    }
    server.put(&path, &at(0.0, &json!({"observes": [u64::MAX >> 1]}))).await.expect(201);
}

#[tokio::test]
async fn a_sign_that_stands_where_a_distance_was_assumed_says_so() {
    let server = Server::with_map("office").await;
    let sign = |text: &str, x: f64, range: &str| {
        json!({"class": "door_number", "confidence": 0.9, "box": [0, 0, 10, 10], "text": text,
            "position": [x, 0.0, 2.0], "range": range})
    };
    let signs = json!({"detections": [sign("901", 0.0, "measured"), sign("903", 4.0, "assumed")]});
    server.put(&format!("{MAP}/keyframes/kf-0"), &at(0.0, &signs)).await.expect(201);
    let ranges = [("a-0", Value::Null), ("a-1", json!("assumed"))];
    for (anchor, range) in ranges {
        let shown = server.get(&format!("{MAP}/anchors/{anchor}")).await.expect(200);
        assert_eq!(shown["frames"][0]["range"], range, "{shown:#}");
    }
}
