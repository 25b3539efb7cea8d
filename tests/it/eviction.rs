//! Eviction: maps leave memory and come back, and no client can tell.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

use reqwest::Method;
use serde_json::{Value, json};

use crate::support::{Answer, Server, pose};

/// Less than any map takes: a map stays in memory only while it is at work, or until another one is wanted.
const NO_MEMORY: u64 = 1;

/// A stream that tells nothing for so long has nothing to tell: the test fails instead of hanging.
const PATIENCE: Duration = Duration::from_secs(20);

const KEYFRAMES: u64 = 12;

/// A keyframe of a robot that walks past the same numbered doors in each session.
fn keyframe(session: &str, number: u64) -> Value {
    let observed: Vec<u64> = (number * 10..number * 10 + 30).collect();
    let positions: Vec<[f64; 3]> = observed.iter().map(|id| [*id as f64 * 0.0625, 1.0, 2.0]).collect();
    json!({
        "session": session, "stamp": {"sec": 1000 + number, "nanosec": 0}, "pose": pose([number as f64 * 0.5, 0.0, 0.0]),
        "bow": {"words": [number * 2, number * 2 + 1, 5000], "weights": [0.5, 0.25, 0.25]},
        "map_points": {"ids": observed, "positions": positions},
        "detections": [{"class": "door_number", "confidence": 0.875, "box": [100.0, 120.0, 180.0, 160.5],
            "map_points": observed[..5], "text": format!("room {}", 900 + number)}]
    })
}

/// A map in which a second robot walks where the first one walked, with a closed loop.
async fn fill(server: &Server, map: &str) {
    server.put(map, &json!({"description": map})).await.expect(201);
    for session in ["first", "second"] {
        for number in 0..KEYFRAMES {
            let path = format!("{map}/keyframes/{session}-{number}");
            server.put(&path, &keyframe(session, number)).await.expect(201);
        }
    }
    let closed = json!({"id": "l", "keyframe": "second-0", "candidate": "first-0"});
    server.post(&format!("{map}/loops"), &closed).await.expect(201);
}

/// Wants two maps by turns until every other one has left memory.
async fn empty_memory(server: &Server) {
    const TURNS: usize = 1_000;
    for _ in 0..TURNS {
        for map in ["/v1/maps/x", "/v1/maps/y"] {
            server.put(map, &json!({})).await;
            server.get(&format!("{map}/keyframes")).await.expect(200);
        }
        if server.figure("revisit_maps").await == 1 {
            return;
        }
    }
    panic!("a map that nobody asks for stays in memory");
}

/// What a server says of a map, byte by byte.
async fn told(server: &Server, map: &str) -> BTreeMap<String, String> {
    let mut told = BTreeMap::new();
    for path in
        ["", "/keyframes", "/anchors", "/loops", "/keyframes/first-3", "/keyframes/second-3/local-anchor-map"]
    {
        let path = format!("{map}{path}");
        let text = Answer::text(server.request(Method::GET, &path)).await;
        told.insert(path, text);
    }
    for number in 0..KEYFRAMES {
        let question = json!({"keyframe": format!("second-{number}")});
        let path = format!("{map}/loop-queries");
        let text = Answer::text(server.request(Method::POST, &path).json(&question)).await;
        let id = serde_json::from_str::<Value>(&text).unwrap()["id"].as_str().unwrap().to_owned();
        let again = Answer::text(server.request(Method::GET, &format!("{path}/{id}"))).await;
        assert_eq!(text, again, "the kept answer");
        told.insert(format!("{path} {number}"), text);
    }
    told
}

#[tokio::test(flavor = "multi_thread")]
async fn a_map_that_left_memory_says_to_the_byte_what_it_said() {
    let folder = tempfile::tempdir().unwrap();
    let server = Server::with_map_memory(folder.path(), NO_MEMORY).await;
    let maps = ["/v1/maps/a", "/v1/maps/b"];
    let mut before = Vec::new();
    for map in maps {
        fill(&server, map).await;
        before.push(told(&server, map).await);
    }
    assert!(before[0].values().any(|text| text.contains("\"candidates\":[{")), "{:#?}", before[0]);
    for _ in 0..3 {
        for (map, before) in maps.iter().zip(&before) {
            empty_memory(&server).await;
            assert_eq!(&told(&server, map).await, before);
        }
    }
    assert!(server.figure("revisit_map_evictions").await >= 6);
    assert!(server.figure("revisit_map_loads_oversized").await > 0);
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_list_of_maps_brings_none_to_memory_and_says_what_each_says() {
    let folder = tempfile::tempdir().unwrap();
    let server = Server::with_map_memory(folder.path(), u64::MAX).await;
    let classes = json!({"anchor_classes": ["sign", "\"door\""], "code_classes": ["tag", "asset"],
        "settings": {"agreeing_reads": 2}, "description": "c"});
    server.put("/v1/maps/c", &classes).await.expect(201);
    for map in ["/v1/maps/a", "/v1/maps/b"] {
        fill(&server, map).await;
    }
    server.delete("/v1/maps/b/keyframes/first-2").await.expect(200);
    server.delete("/v1/maps/b/loops/l").await.expect(200);
    let listed = server.get("/v1/maps").await.expect(200);
    server.stop().await;

    let server = Server::with_map_memory(folder.path(), u64::MAX).await;
    assert_eq!(server.get("/v1/maps").await.expect(200), listed);
    for map in listed["items"].as_array().unwrap() {
        let path = format!("/v1/maps/{}", map["id"].as_str().unwrap());
        assert_eq!(&server.get(&path).await.expect(200), map);
    }
    let (first, last) = (&listed["items"][0], &listed["items"][2]);
    assert_eq!(
        (&first["keyframes"], &first["sessions"], &first["loops"]),
        (&json!(24), &json!(2), &json!(1))
    );
    assert_eq!(
        (&last["anchor_classes"], &last["code_classes"], &last["settings"]["agreeing_reads"]),
        (&json!(["\"door\"", "sign"]), &json!(["asset", "tag"]), &json!(2))
    );
    // Nor does a stream.
    let mut stream = server.request(Method::GET, "/v1/maps/a/events?since=0").send().await.unwrap();
    let chunk = tokio::time::timeout(PATIENCE, stream.chunk()).await.expect("events").unwrap();
    assert!(chunk.is_some_and(|chunk| chunk.starts_with(b"id: 1\n")));
    server.get("/v1/maps/nowhere/events").await.expect(404);
    assert_eq!((server.figure("revisit_maps").await, server.figure("revisit_map_loads").await), (0, 0));
    // A part of the list at a time.
    let part = server.get("/v1/maps?limit=2").await.expect(200);
    let rest =
        server.get(&format!("/v1/maps?limit=2&cursor={}", part["next_cursor"].as_str().unwrap())).await;
    assert_eq!(rest.expect(200)["items"], json!([last]));
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn nothing_is_lost_while_robots_write_to_maps_that_come_and_go() {
    const ROBOTS: u64 = 6;
    const MAPS: u64 = 4;
    const WRITES: u64 = 40;
    let folder = tempfile::tempdir().unwrap();
    let server = Arc::new(Server::with_map_memory(folder.path(), NO_MEMORY).await);
    for map in 0..MAPS {
        server.put(&format!("/v1/maps/m{map}"), &json!({})).await.expect(201);
    }
    let robots = (0..ROBOTS).map(|robot| {
        let server = server.clone();
        tokio::spawn(async move {
            for number in 0..WRITES {
                // Each in an order of its own, so that every map is wanted while another one is.
                let map = format!("/v1/maps/m{}", (number * (robot + 1) + robot) % MAPS);
                let path = format!("{map}/keyframes/{robot}-{number}");
                let stored =
                    server.put(&path, &keyframe(&format!("robot-{robot}"), number)).await.expect(201);
                server.get(&path).await.expect(200);
                let read = server.get(&map).await.expect(200);
                assert!(read["map_version"].as_u64() >= stored["map_version"].as_u64(), "{path}");
                if number % 4 == 3 {
                    let question = json!({"keyframe": format!("{robot}-{number}")});
                    server.post(&format!("{map}/loop-queries"), &question).await.expect(200);
                }
            }
        })
    });
    for robot in robots.collect::<Vec<_>>() {
        robot.await.expect("a robot whose writes are taken");
    }
    assert!(server.figure("revisit_map_evictions").await > MAPS);
    let listed = server.get("/v1/maps").await.expect(200);
    let mut kept = 0;
    for map in listed["items"].as_array().unwrap() {
        let keyframes = map["keyframes"].as_u64().unwrap();
        assert_eq!(
            map["map_version"],
            keyframes + 1,
            "each keyframe made a version, and none was made twice"
        );
        kept += keyframes;
    }
    assert_eq!(kept, ROBOTS * WRITES);
    Arc::into_inner(server).expect("the robots are gone").stop().await;
    super::operations::sound(&folder.path().join("test.db")).await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_stream_outlives_the_eviction_of_its_map_and_ends_with_the_map() {
    let folder = tempfile::tempdir().unwrap();
    let server = Server::with_map_memory(folder.path(), NO_MEMORY).await;
    server.put("/v1/maps/a", &json!({})).await.expect(201);
    let mut stream = server.request(Method::GET, "/v1/maps/a/events").send().await.unwrap();
    let mut text = String::new();
    for number in 0..3 {
        empty_memory(&server).await;
        server.put(&format!("/v1/maps/a/keyframes/k{number}"), &keyframe("a", number)).await.expect(201);
        while text.matches("event: anchor_described").count() <= number as usize {
            let chunk = tokio::time::timeout(PATIENCE, stream.chunk()).await.expect("an event");
            text.push_str(std::str::from_utf8(&chunk.unwrap().expect("a stream that goes on")).unwrap());
        }
    }
    empty_memory(&server).await;
    server.delete("/v1/maps/a").await.expect(204);
    while let Some(chunk) = tokio::time::timeout(PATIENCE, stream.chunk()).await.expect("an end").unwrap() {
        text.push_str(std::str::from_utf8(&chunk).unwrap());
    }
    server.stop().await;
}
