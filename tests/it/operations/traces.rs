//! Traces: a collector is sent a span for each request, under its caller's.

use std::sync::{Arc, Mutex};

use axum::Router;
use axum::body::Bytes;
use axum::extract::State;
use axum::routing::post;
use reqwest::Method;
use serde_json::json;
use tokio::net::TcpListener;

use crate::crash::server::Server;

type Journal = Arc<Mutex<Vec<Bytes>>>;

/// A collector that keeps what it is sent to `/v1/traces`.
async fn collector() -> (String, Journal) {
    let journal = Journal::default();
    let keep =
        |State(journal): State<Journal>, body: Bytes| async move { journal.lock().unwrap().push(body) };
    let router = Router::new().route("/v1/traces", post(keep)).with_state(journal.clone());
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let url = format!("http://{}", listener.local_addr().unwrap());
    tokio::spawn(async move { axum::serve(listener, router).await });
    (url, journal)
}

#[derive(Debug, PartialEq)]
enum Field<'a> {
    Number(u64),
    Bytes(&'a [u8]),
}

fn varint(bytes: &mut &[u8]) -> u64 {
    let mut value = 0;
    for shift in (0..64).step_by(7) {
        let (byte, rest) = bytes.split_first().unwrap();
        *bytes = rest;
        value |= u64::from(byte & 0x7f) << shift;
        if byte & 0x80 == 0 {
            break;
        }
    }
    value
}

/// The fields of a protobuf message, by number.
fn fields(mut bytes: &[u8]) -> Vec<(u64, Field<'_>)> {
    let mut found = Vec::new();
    while !bytes.is_empty() {
        let tag = varint(&mut bytes);
        let length = match tag & 7 {
            0 => {
                found.push((tag >> 3, Field::Number(varint(&mut bytes))));
                continue;
            }
            1 => 8,
            2 => varint(&mut bytes) as usize,
            5 => 4,
            other => panic!("wire type {other}"),
        };
        let (field, rest) = bytes.split_at(length);
        found.push((tag >> 3, Field::Bytes(field)));
        bytes = rest;
    }
    found
}

/// The messages in a field.
fn inner(message: &[u8], number: u64) -> Vec<&[u8]> {
    let wanted = fields(message).into_iter().filter(|(found, _)| *found == number);
    wanted
        .filter_map(|(_, field)| match field {
            Field::Bytes(bytes) => Some(bytes),
            Field::Number(_) => None,
        })
        .collect()
}

/// Every span of `ExportTraceServiceRequest`s: resource_spans (1), scope_spans (2), spans (2).
fn spans(requests: &[Bytes]) -> Vec<&[u8]> {
    let resources = requests.iter().flat_map(|request| inner(request, 1));
    resources.flat_map(|resource| inner(resource, 2)).flat_map(|scope| inner(scope, 2)).collect()
}

fn text(span: &[u8], number: u64) -> String {
    String::from_utf8(inner(span, number)[0].to_vec()).unwrap()
}

fn hex(bytes: &[u8]) -> String {
    bytes
        .iter()
        .flat_map(|byte| [byte >> 4, byte & 0xf])
        .filter_map(|half| char::from_digit(half.into(), 16))
        .collect()
}

#[tokio::test(flavor = "multi_thread")]
async fn each_request_is_a_span_under_its_callers() {
    let (url, journal) = collector().await;
    let folder = tempfile::tempdir().unwrap();
    let database = folder.path().join("revisit.db");
    let mut server = Server::start_with(&database, &["--otlp-endpoint", &url, "--log", "info"]);
    let (trace, parent) = ("0af7651916cd43dd8448eb211c80319c", "b7ad6b7169203331");
    let request = server.api().request(Method::PUT, "/v1/maps/tower").json(&json!({}));
    let request = request.header("traceparent", format!("00-{trace}-{parent}-01"));
    assert_eq!(request.send().await.unwrap().status(), 201);
    assert_eq!(server.api().get("/v1/maps/elsewhere/loops").await.status, 404);
    // What was not sent yet is sent when the server stops.
    assert!(server.terminate().success());
    let journal = journal.lock().unwrap();
    assert!(
        journal.iter().any(|body| body.windows(7).any(|window| window == b"revisit")),
        "the service's name"
    );
    // Kind 2 is a server's.
    let (spans, parts): (Vec<&[u8]>, Vec<&[u8]>) =
        spans(&journal).into_iter().partition(|span| fields(span).contains(&(6, Field::Number(2))));
    let names: Vec<String> = spans.iter().map(|span| text(span, 5)).collect();
    assert_eq!(names, ["PUT /v1/maps/{map}", "GET /v1/maps/{map}/loops"]);
    assert_eq!(
        (hex(inner(spans[0], 1)[0]), hex(inner(spans[0], 4)[0])),
        (trace.to_owned(), parent.to_owned())
    );
    assert_ne!(hex(inner(spans[1], 1)[0]), trace);
    // What a request took its time for stands under it.
    assert!(!parts.is_empty());
    for part in parts {
        assert!(["load", "read", "decide", "commit"].contains(&&*text(part, 5)));
        assert_eq!((hex(inner(part, 1)[0]), inner(part, 4)[0]), (trace.to_owned(), inner(spans[0], 2)[0]));
    }
    let attributes: Vec<String> = inner(spans[0], 9).iter().map(|attribute| text(attribute, 1)).collect();
    for expected in ["http.request.method", "http.route", "http.response.status_code", "request_id"] {
        assert!(attributes.iter().any(|name| name == expected), "{attributes:?}");
    }
    // The log is as it is without traces.
    let log = std::fs::read_to_string(database.with_extension("log")).unwrap();
    assert!(!log.contains("otel"), "{log}");
}

#[tokio::test(flavor = "multi_thread")]
async fn a_collector_that_is_away_stops_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let database = folder.path().join("revisit.db");
    let mut server = Server::start_with(&database, &["--otlp-endpoint", "http://127.0.0.1:1"]);
    assert_eq!(server.api().put("/v1/maps/tower", &json!({})).await.status, 201);
    assert!(server.terminate().success());
}
