//! Events: a client that resumes misses nothing, or is told that it would.

use reqwest::Method;
use serde_json::{Value, json};

use crate::raw::Connection;
use crate::support::{Answer, Server, keyframe};

const MAP: &str = "/v1/maps/m";
const EVENTS: &str = "/v1/maps/m/events";

/// Makes the map, with an event for each keyframe.
async fn make(server: &Server, keyframes: u32) {
    server.put(MAP, &json!({})).await.expect(201);
    for number in 0..keyframes {
        server.put(&format!("{MAP}/keyframes/kf-{number}"), &keyframe()).await.expect(201);
    }
}

/// The status of an answer that may have no end.
async fn status(server: &Server, query: &str, last: Option<u64>) -> u16 {
    let request = server.request(Method::GET, &format!("{EVENTS}{query}"));
    let request = last.into_iter().fold(request, |request, last| request.header("last-event-id", last));
    request.send().await.expect("an answer").status().as_u16()
}

/// The numbers of the first events.
async fn numbers(server: &Server, count: usize) -> Vec<u64> {
    let mut stream = server.request(Method::GET, EVENTS).send().await.expect("an answer");
    let mut text = String::new();
    loop {
        let ids: Vec<u64> =
            text.lines().filter_map(|line| line.strip_prefix("id: ")?.parse().ok()).take(count).collect();
        if ids.len() == count {
            return ids;
        }
        text += &String::from_utf8_lossy(&stream.chunk().await.expect("a stream").expect("more events"));
    }
}

async fn expect_gone(server: &Server, seq: u64) {
    assert_eq!(status(server, "", Some(seq)).await, 410, "last-event-id: {seq}");
    assert_eq!(status(server, &format!("?since={seq}"), None).await, 410, "since={seq}");
}

#[tokio::test]
async fn a_number_of_a_map_that_was_deleted_and_made_again_is_gone() {
    let folder = tempfile::tempdir().unwrap();
    let server = Server::on(folder.path()).await;
    make(&server, 3).await;
    assert_eq!(numbers(&server, 3).await, [1, 2, 3]);
    for known in 0..=3 {
        assert_eq!(status(&server, "", Some(known)).await, 200, "{known}");
        assert_eq!(status(&server, &format!("?since={known}"), None).await, 200, "{known}");
    }
    // Not given yet, so of another map.
    expect_gone(&server, 4).await;

    // With more events than before, with fewer, and with none.
    let mut newest = 3;
    let mut server = server;
    for keyframes in [5, 1, 0, 2] {
        server.delete(MAP).await.expect(204);
        // Whatever was in memory is forgotten.
        server.stop().await;
        server = Server::on(folder.path()).await;
        make(&server, keyframes).await;
        for stale in 1..=newest {
            expect_gone(&server, stale).await;
        }
        assert_eq!(status(&server, "?since=0", None).await, 200);
        let again = numbers(&server, keyframes as usize).await;
        assert!(again.windows(2).all(|pair| pair[0] + 1 == pair[1]), "{again:?}");
        for known in &again {
            assert_eq!(status(&server, "", Some(*known)).await, 200, "{known}");
        }
        newest = again.last().copied().unwrap_or(newest);
    }
    let request = server.request(Method::GET, &format!("{EVENTS}?since=7")).header("last-event-id", "1");
    let answer = Answer::of(request).await;
    assert_eq!(answer.pointers(), ["last-event-id:"], "{answer:#?}");
    assert_eq!(answer.expect(410)["code"], Value::from("gone"));
}

#[tokio::test]
async fn a_stream_ends_with_its_map_and_does_not_go_on_with_another_of_its_name() {
    let server = Server::start().await;
    make(&server, 1).await;
    let mut stream = Connection::open(server.addr()).await;
    stream.send(format!("GET {EVENTS} HTTP/1.1\r\nhost: localhost\r\nconnection: close\r\n\r\n")).await;
    assert!(stream.head().await.contains("200 OK"));
    server.delete(MAP).await.expect(204);
    make(&server, 2).await;
    let heard = stream.rest().await;
    assert!(heard.ends_with("0\r\n\r\n"), "{heard}");
    // The keyframe that only the second map of the name has.
    assert!(!heard.contains("kf-1"), "{heard}");
}
