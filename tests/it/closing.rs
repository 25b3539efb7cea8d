//! Closing: a refusal never breaks a connection without a word. Either the next request on it is answered, or the refusal
//! says `connection: close`.

use crate::raw::{Connection, statuses};
use crate::support::Server;

/// Requests that are refused before their body is read, each with its status.
const REFUSED: [(&str, &str, u16); 8] = [
    ("another type", "PUT /v1/maps/m HTTP/1.1\r\ncontent-type: text/plain\r\n", 415),
    ("another encoding", "PUT /v1/maps/m HTTP/1.1\r\ncontent-encoding: br\r\n", 415),
    ("no such method", "PATCH /v1/maps HTTP/1.1\r\n", 405),
    ("no such path", "POST /v1/mops HTTP/1.1\r\n", 404),
    ("a bad id", "PUT /v1/maps/a%20b HTTP/1.1\r\n", 422),
    ("dots for an id", "PUT /v1/maps/m/keyframes/%2e%2e HTTP/1.1\r\n", 422),
    ("a bad parameter", "PUT /v1/maps/m/keyframes/kf-1?query=x HTTP/1.1\r\n", 422),
    ("another host", "PUT /v1/maps/m HTTP/1.1\r\nhost: elsewhere.example\r\n", 403),
];

const NEXT: &str = "GET /healthz HTTP/1.1\r\nhost: localhost\r\nconnection: close\r\n\r\n";

fn with_length(head: &str, length: usize) -> String {
    format!("{head}content-length: {length}\r\n\r\n{}", "x".repeat(length))
}

fn chunked(head: &str, length: usize) -> String {
    let body = "x".repeat(length);
    format!("{head}transfer-encoding: chunked\r\n\r\n{length:x}\r\n{body}\r\n0\r\n\r\n")
}

fn head_of(answers: &str) -> &str {
    answers.split_once("\r\n\r\n").map_or(answers, |(head, _)| head)
}

#[tokio::test(flavor = "multi_thread")]
async fn after_a_refusal_the_next_request_is_answered_or_the_connection_was_said_to_close() {
    let server = Server::with_map("m").await;
    for (what, head, status) in REFUSED {
        for (size, length) in [("no", 0), ("a small", 300), ("a large", 300_000), ("a huge", 5_000_000)] {
            for (form, sent) in
                [("with a length", with_length(head, length)), ("in chunks", chunked(head, length))]
            {
                if length == 0 && form == "in chunks" {
                    continue;
                }
                let what = format!("{what}, {size} body {form}");
                let mut pipelined = Connection::open(server.addr()).await;
                pipelined.send(format!("{sent}{NEXT}")).await;
                let answers = pipelined.rest().await;
                let closes = head_of(&answers).contains("connection: close");
                let expected: &[u16] = if closes { &[status] } else { &[status, 200] };
                assert_eq!(statuses(&answers), expected, "{what}: {answers}");
                // A small body is worth a connection.
                assert!(!closes || length > 300, "{what}: {answers}");

                let mut kept = Connection::open(server.addr()).await;
                kept.send(&sent).await;
                let answer = kept.head().await;
                assert_eq!(statuses(&answer), [status], "{what}: {answer}");
                if !head_of(&answer).contains("connection: close") {
                    kept.send(NEXT).await;
                    let next = kept.rest().await;
                    assert!(next.contains("HTTP/1.1 200 OK"), "{what}: {next}");
                }
            }
        }
    }
}

#[tokio::test]
async fn a_client_that_asks_before_it_sends_is_refused_without_its_body_and_told_that_the_connection_closes()
{
    let server = Server::with_map("m").await;
    for (what, head, status) in REFUSED {
        let mut connection = Connection::open(server.addr()).await;
        connection.send(format!("{head}expect: 100-continue\r\ncontent-length: 300\r\n\r\n")).await;
        let answer = connection.rest().await;
        assert_eq!(statuses(&answer), [status], "{what}: {answer}");
        assert!(head_of(&answer).contains("connection: close"), "{what}: {answer}");
    }
}

#[tokio::test]
async fn every_answer_keeps_browsers_from_guessing_what_it_is() {
    let server = Server::with_map("m").await;
    for path in [
        "/",
        "/docs",
        "/healthz",
        "/metrics",
        "/openapi.json",
        "/v1/maps",
        "/v1/maps/m",
        "/v1/mops",
        "/v1/maps/..",
    ] {
        let answer = server.get(path).await;
        assert_eq!(answer.header("x-content-type-options"), "nosniff", "{path}: {answer:#?}");
    }
    let mut connection = Connection::open(server.addr()).await;
    connection.send("no HTTP\r\n\r\n").await;
    assert!(connection.rest().await.contains("x-content-type-options: nosniff\r\n"));
}
