//! What a map may hold.

use std::time::Duration;

use reqwest::Method;
use revisit::config::quotas::Quotas;
use serde_json::{Value, json};

use crate::support::{Answer, Server, keyframe};

fn with_plate(text: &str, x: f64) -> Value {
    let mut body = keyframe();
    body["detections"] = json!([{"class": "door_number", "confidence": 0.9, "box": [0, 0, 9, 9],
        "position": [x, 0.0, 2.0], "text": text}]);
    body
}

#[tokio::test]
async fn a_full_map_refuses_keyframes_and_goes_on_reading_and_deleting() {
    let full = |quotas: Quotas| async move {
        let server = Server::with_quotas(quotas).await;
        server.put("/v1/maps/m", &json!({})).await.expect(201);
        server.put("/v1/maps/m/keyframes/a", &with_plate("901", 0.0)).await.expect(201);
        server.put("/v1/maps/m/keyframes/b", &with_plate("902", 9.0)).await.expect(201);
        let refused = server.put("/v1/maps/m/keyframes/c", &with_plate("903", 18.0)).await.expect(507);
        assert_eq!(refused["code"], "map_full", "{refused}");
        server.put("/v1/maps/m/keyframes/a", &with_plate("901", 0.0)).await.expect(200);
        let map = server.get("/v1/maps/m").await.expect(200);
        server.put("/v1/maps/other", &json!({})).await.expect(201);
        server.put("/v1/maps/other/keyframes/c", &with_plate("903", 18.0)).await.expect(201);
        server.delete("/v1/maps/m/keyframes/a").await.expect(200);
        server.put("/v1/maps/m/keyframes/c", &with_plate("903", 18.0)).await.expect(201);
        (refused, map)
    };
    let quotas = Quotas::default();
    let (refused, _) = full(Quotas { map_max_keyframes: Some(2), ..quotas }).await;
    assert!(refused["detail"].as_str().expect("a text").contains("2 keyframes"), "{refused}");
    let (refused, _) = full(Quotas { map_max_anchors: Some(2), ..quotas }).await;
    assert!(refused["detail"].as_str().expect("a text").contains("2 anchors"), "{refused}");
}

/// What any keyframe takes: its stamp (12 bytes), its pose (7 floats), its name of one letter.
const HEAD: u64 = 12 + 7 * 8 + 1;
/// What the session "default" takes, once.
const SESSION: u64 = 7;
/// What a map point with a position takes, once: its number and three floats.
const POINT: u64 = 4 * 8;

async fn bytes(server: &Server) -> u64 {
    server.get("/v1/maps/m").await.expect(200)["bytes"].as_u64().expect("a number")
}

fn limited(bytes: u64) -> Quotas {
    Quotas { map_max_bytes: Some(bytes), ..Quotas::default() }
}

fn points(ids: &[i64]) -> Value {
    json!({"ids": ids, "positions": vec![[0.5, 0.0, 2.0]; ids.len()]})
}

#[tokio::test]
async fn a_map_counts_the_bytes_of_its_keyframes() {
    // Three words (8 bytes each) and two observed points (8 bytes each).
    const BYTES: u64 = HEAD + 3 * 8 + 2 * 8;
    let server = Server::with_quotas(limited(SESSION + 2 * BYTES)).await;
    let mut body = keyframe();
    body["bow"] = json!({"words": [1, 2, 3], "weights": [1, 1, 1]});
    body["observes"] = json!([4, 5]);
    server.put("/v1/maps/m", &json!({})).await.expect(201);
    for (keyframe, status, held) in [("a", 201, BYTES), ("b", 201, 2 * BYTES), ("c", 507, 2 * BYTES)] {
        server.put(&format!("/v1/maps/m/keyframes/{keyframe}"), &body).await.expect(status);
        assert_eq!(bytes(&server).await, SESSION + held);
    }
    server.delete("/v1/maps/m/keyframes/a").await.expect(200);
    assert_eq!(bytes(&server).await, SESSION + BYTES);
}

#[tokio::test]
async fn a_key_makes_as_many_maps_as_it_may_and_they_hold_as_many_bytes() {
    let server = Server::start().await;
    let root = server.post("/v1/keys", &json!({"actions": ["read", "write", "admin"]})).await.expect(201);
    let root = root["secret"].as_str().unwrap();
    let ask = async |method: Method, path: &str, secret: &str, body: Value| {
        Answer::of(server.request(method, path).bearer_auth(secret).json(&body)).await
    };
    let limited = json!({"actions": ["read", "write"], "max_maps": 2, "max_bytes": 3 * (SESSION + HEAD)});
    let key = ask(Method::POST, "/v1/keys", root, limited).await.expect(201);
    let key = key["secret"].as_str().unwrap();
    let full = async |method: Method, path: &str, secret: &str, body: Value| {
        let refused = ask(method, path, secret, body).await.expect(507);
        assert_eq!(refused["code"], "map_full", "{refused}");
    };
    for (map, secret) in [("a", key), ("b", key), ("not-its-own", root)] {
        ask(Method::PUT, &format!("/v1/maps/{map}"), secret, json!({})).await.expect(201);
        ask(Method::PUT, &format!("/v1/maps/{map}/keyframes/kf"), secret, keyframe()).await.expect(201);
    }
    full(Method::PUT, "/v1/maps/c", key, json!({})).await;
    full(Method::PUT, "/v1/maps/c", key, json!({"base": {"map": "a"}})).await;
    // Sent again, it is the map that there is.
    ask(Method::PUT, "/v1/maps/b", key, json!({})).await.expect(200);

    ask(Method::PUT, "/v1/maps/a/releases/first", key, json!({})).await.expect(201);
    // What a key holds is looked up once a second.
    tokio::time::sleep(Duration::from_millis(1100)).await;
    full(Method::PUT, "/v1/maps/a/releases/second", key, json!({})).await;
    // Whoever sends it, and to whichever of them.
    full(Method::PUT, "/v1/maps/b/keyframes/another", root, keyframe()).await;
    ask(Method::PUT, "/v1/maps/b/keyframes/kf", key, keyframe()).await.expect(200);
    // What another key made is not its own, however much it sends.
    ask(Method::PUT, "/v1/maps/not-its-own/keyframes/another", key, keyframe()).await.expect(201);

    ask(Method::DELETE, "/v1/maps/a", key, json!({})).await.expect(204);
    tokio::time::sleep(Duration::from_millis(1100)).await;
    ask(Method::PUT, "/v1/maps/b/keyframes/another", key, keyframe()).await.expect(201);
    full(Method::PUT, "/v1/maps/c", key, json!({"base": {"map": "b"}})).await;
    ask(Method::PUT, "/v1/maps/c", key, json!({})).await.expect(201);
}

#[tokio::test]
async fn a_release_counts_as_its_map_does() {
    let server = Server::with_quotas(limited(2 * (SESSION + HEAD))).await;
    server.put("/v1/maps/m", &json!({})).await.expect(201);
    server.put("/v1/maps/m/keyframes/a", &keyframe()).await.expect(201);
    server.put("/v1/maps/m/releases/first", &json!({})).await.expect(201);
    let refused = server.put("/v1/maps/m/releases/second", &json!({})).await.expect(507);
    assert_eq!(refused["code"], "map_full", "{refused}");
    server.delete("/v1/maps/m/releases/first").await.expect(204);
    server.put("/v1/maps/m/releases/second", &json!({})).await.expect(201);
}

#[tokio::test]
async fn everything_that_a_detection_brings_counts() {
    let plain = json!({"class": "sign", "confidence": 0.5, "box": [0, 0, 1, 1]});
    let (head, crop) = (5 * 8 + 4, "iVBORw0KGgoAAAAA");
    let cases: [(&str, Value, u64); 6] = [
        ("class", json!("signal"), 2),
        ("text", json!("EXIT"), 4),
        ("description", json!("a green EXIT sign"), 17),
        ("position", json!([1.0, 0.0, 2.0]), 24),
        ("map_points", json!([7, 8, 9]), 24),
        ("crop", json!(crop), 12),
    ];
    for (field, value, more) in cases {
        let mut detection = plain.clone();
        detection[field] = value;
        let mut body = keyframe();
        body["detections"] = json!([detection]);
        let server = Server::with_quotas(limited(SESSION + HEAD + head + more)).await;
        server.put("/v1/maps/m", &json!({})).await.expect(201);
        server.put("/v1/maps/m/keyframes/a", &body).await.expect(201);
        assert_eq!(bytes(&server).await, SESSION + HEAD + head + more, "{field}");
        server.put("/v1/maps/m/keyframes/b", &keyframe()).await.expect(507);
        server.delete("/v1/maps/m/keyframes/a").await.expect(200);
        assert_eq!(bytes(&server).await, SESSION, "{field}");
        let server = Server::with_quotas(limited(SESSION + HEAD + head + more - 1)).await;
        server.put("/v1/maps/m", &json!({})).await.expect(201);
        let refused = server.put("/v1/maps/m/keyframes/a", &body).await.expect(507);
        assert_eq!(refused["code"], "map_full", "{field}");
    }
}

#[tokio::test]
async fn a_map_point_counts_once_however_often_it_is_sent_until_it_is_forgotten() {
    let server = Server::start().await;
    let mut body = keyframe();
    (body["map_points"], body["observes"]) = (points(&[1, 2]), json!([1, 2]));
    // The keyframe keeps the numbers of what it observes and of what it sent.
    let keyframe = HEAD + 4 * 8;
    server.put("/v1/maps/m", &json!({})).await.expect(201);
    for (name, keyframes) in [("a", 1), ("b", 2)] {
        server.put(&format!("/v1/maps/m/keyframes/{name}"), &body).await.expect(201);
        assert_eq!(bytes(&server).await, SESSION + keyframes * keyframe + 2 * POINT);
    }
    let moved = json!({"session": "default", "map_points": points(&[2, 1])});
    server.post("/v1/maps/m/poses", &moved).await.expect(200);
    assert_eq!(bytes(&server).await, SESSION + 2 * keyframe + 2 * POINT);
    server.delete("/v1/maps/m/keyframes/a").await.expect(200);
    assert_eq!(bytes(&server).await, SESSION + keyframe + 2 * POINT);
    server.delete("/v1/maps/m/keyframes/b").await.expect(200);
    assert_eq!(bytes(&server).await, SESSION);
}

#[tokio::test]
async fn a_full_map_takes_no_new_points_and_moves_those_it_has() {
    let server = Server::with_quotas(limited(SESSION + HEAD + 2 * POINT)).await;
    server.put("/v1/maps/m", &json!({})).await.expect(201);
    server.put("/v1/maps/m/keyframes/a", &keyframe()).await.expect(201);
    let poses = |ids: &[i64]| {
        json!({"session": "default", "keyframes": {"ids": ["a"], "poses": [crate::support::pose([1.0, 0.0, 0.0])]},
            "map_points": points(ids)})
    };
    for (ids, status) in [(&[1, 2, 3][..], 507), (&[1, 2], 200), (&[1, 2], 200), (&[2, 3], 507), (&[], 200)] {
        let answer = server.post("/v1/maps/m/poses", &poses(ids)).await.expect(status);
        assert!(status == 200 || answer["code"] == "map_full", "{answer}");
    }
    assert_eq!(bytes(&server).await, SESSION + HEAD + 2 * POINT);
    server.patch("/v1/maps/m", &json!({"description": "full"})).await.expect(200);
}

#[tokio::test]
async fn every_loop_counts_also_between_one_pair() {
    // Two keyframes' numbers, and the names of the loop and of both keyframes.
    const LOOP: u64 = 2 * 4 + 3;
    let held = SESSION + 2 * HEAD;
    let server = Server::with_quotas(limited(held + 2 * LOOP)).await;
    server.put("/v1/maps/m", &json!({})).await.expect(201);
    for name in ["a", "b"] {
        server.put(&format!("/v1/maps/m/keyframes/{name}"), &keyframe()).await.expect(201);
    }
    for (id, status, loops) in [("1", 201, 1), ("2", 201, 2), ("3", 507, 2), ("1", 200, 2)] {
        let body = json!({"id": id, "keyframe": "a", "candidate": "b"});
        server.post("/v1/maps/m/loops", &body).await.expect(status);
        assert_eq!(bytes(&server).await, held + loops * LOOP);
    }
    server.delete("/v1/maps/m/loops/1").await.expect(200);
    assert_eq!(bytes(&server).await, held + LOOP);
}

#[tokio::test]
async fn merges_of_a_loop_count_until_it_is_revoked() {
    let server = Server::with_map("m").await;
    let mut again = with_plate("901", 0.0);
    again["session"] = json!("again");
    server.put("/v1/maps/m/keyframes/a", &with_plate("901", 0.0)).await.expect(201);
    server.put("/v1/maps/m/keyframes/b", &again).await.expect(201);
    let before = bytes(&server).await;
    let closed =
        server.post("/v1/maps/m/loops", &json!({"id": "l", "keyframe": "b", "candidate": "a"})).await;
    assert_eq!(closed.expect(201)["merged"].as_array().expect("a list").len(), 1);
    // The loop, and one link of two anchors under its name.
    assert_eq!(bytes(&server).await, before + (2 * 4 + 3) + (2 * 4 + 1));
    server.delete("/v1/maps/m/loops/l").await.expect(200);
    assert_eq!(bytes(&server).await, before);
}

#[tokio::test]
async fn a_restart_counts_the_same_bytes() {
    let directory = tempfile::tempdir().expect("a directory");
    let start = || Server::on(directory.path());
    let server = start().await;
    server.put("/v1/maps/m", &json!({})).await.expect(201);
    let mut body = with_plate("901", 0.0);
    (body["map_points"], body["observes"]) = (points(&[1, 2, 3]), json!([1, 2, 4]));
    for name in ["a", "b", "c"] {
        server.put(&format!("/v1/maps/m/keyframes/{name}"), &body).await.expect(201);
    }
    let poses = json!({"session": "default", "map_points": points(&[4, 5])});
    server.post("/v1/maps/m/poses", &poses).await.expect(200);
    server.post("/v1/maps/m/loops", &json!({"id": "l", "keyframe": "c", "candidate": "a"})).await.expect(201);
    server.delete("/v1/maps/m/keyframes/b").await.expect(200);
    let before = bytes(&server).await;
    server.stop().await;
    let server = start().await;
    assert_eq!(bytes(&server).await, before);
    server.stop().await;
}
