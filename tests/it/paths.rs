//! Paths and framing: however a request is dressed up, it reaches what its matched route and names say, or nothing.
//!
//! Rights will hang on the matched route, so nothing may look like one route to the router and like another to the rest.

use reqwest::Method;
use serde_json::json;

use crate::raw::{Connection, statuses};
use crate::support::{Server, keyframe};

const KEYFRAME: &str = "/v1/maps/m/keyframes/kf-1";

async fn server() -> Server {
    // Half a request is not waited for.
    let (server, _) = Server::within(&["--header-timeout", "0.3", "--keep-alive", "0.5"]).await;
    for map in ["m", "other"] {
        server.put(&format!("/v1/maps/{map}"), &json!({})).await.expect(201);
    }
    server.put(KEYFRAME, &keyframe()).await.expect(201);
    server
}

/// Sends raw bytes on a connection of their own; the statuses of all that was answered.
async fn sent(server: &Server, bytes: impl AsRef<[u8]>) -> Vec<u16> {
    let mut connection = Connection::open(server.addr()).await;
    connection.send(bytes).await;
    statuses(&connection.rest().await)
}

fn request(method: &str, target: &[u8]) -> Vec<u8> {
    let tail = b" HTTP/1.1\r\nhost: localhost\r\nconnection: close\r\n\r\n".as_slice();
    [method.as_bytes(), b" ", target, tail].concat()
}

#[tokio::test]
async fn no_trick_with_a_path_reaches_what_the_path_does_not_name() {
    let server = server().await;
    let long = [b"/v1/maps/m/keyframes/".as_slice(), &b"x".repeat(40_000)].concat();
    let dots = [b"/v1/maps/m/keyframes/".as_slice(), &b"%2e%2e%2f".repeat(2000), b"kf-1"].concat();
    let tricks: &[&[u8]] = &[
        b"//v1/maps/m/keyframes/kf-1",
        b"/v1//maps/m/keyframes/kf-1",
        b"/v1/maps//m/keyframes/kf-1",
        b"/v1/maps/m/keyframes//kf-1",
        b"/./v1/maps/m/keyframes/kf-1",
        b"/v1/./maps/m/keyframes/kf-1",
        b"/v1/maps/m/./keyframes/kf-1",
        b"/v1/maps/m/keyframes/./kf-1",
        b"/v1/maps/other/../m/keyframes/kf-1",
        b"/v1/maps/m/keyframes/x/../kf-1",
        b"/v1/maps/other/%2e%2e/m/keyframes/kf-1",
        b"/v1/maps/m/keyframes/x/%2E%2E/kf-1",
        b"/v1/maps/other/..%2fm/keyframes/kf-1",
        b"/v1/maps/other/..%5cm/keyframes/kf-1",
        b"/v1/maps/other%2f..%2fm/keyframes/kf-1",
        b"/v1/maps/m%2fkeyframes%2fkf-1",
        b"/v1/maps/m/keyframes%2fkf-1",
        b"/v1%2fmaps%2fm%2fkeyframes%2fkf-1",
        b"/v1/maps/m%252fkeyframes%252fkf-1",
        b"/v1/maps/m/keyframes/%256bf-1",
        b"/v1/maps/m/keyframes/kf-1/",
        b"/v1/maps/m/keyframes/kf-1/.",
        b"/v1/maps/m/keyframes/kf-1/..",
        b"/v1/maps/m/keyframes/kf-1%2f",
        b"/v1/maps/m/keyframes/kf-1%00",
        b"/v1/maps/m/keyframes/%00kf-1",
        b"/v1/maps/m/keyframes/kf-1%0d%0a",
        b"/v1/maps/m/keyframes/kf-1%ff",
        b"/v1/maps/m/keyframes/kf-1%c0%af",
        b"/v1/maps/m/keyframes/kf-1%ed%a0%80",
        b"/v1/maps/m/keyframes/kf-1%f4%90%80%80",
        b"/v1/maps/m/keyframes/%EF%BD%8B%EF%BD%86-1",
        b"/v1/maps/m/keyframes/kf-1%",
        b"/v1/maps/m/keyframes/kf-1%2",
        b"/v1/maps/m/keyframes/%zz",
        b"/v1/maps/m/keyframes/kf-1%u002f",
        b"/v1/maps/m/keyframes/kf-1;x=1",
        b"/v1/maps/m;x=1/keyframes/kf-1",
        b"/v1/maps/m/keyframes/kf-1%3fx",
        b"/v1/maps/m/keyframes/kf-1%23x",
        b"/v1/maps/m/keyframes/kf-1\\",
        b"/v1/maps/m/keyframes\\kf-1",
        b"/v1/maps/m/keyframes/kf-1\x00",
        b"/v1/maps/m/keyframes/kf-1\xff",
        b"/v1/maps/m/keyframes/ kf-1",
        b"/V1/maps/m/keyframes/kf-1",
        b"/v1/MAPS/m/keyframes/kf-1",
        b"/v1/maps/M/keyframes/kf-1",
        b"/v1/maps/m/keyframes/KF-1",
        b"v1/maps/m/keyframes/kf-1",
        b"*",
        b"?/v1/maps/m/keyframes/kf-1",
        b"/?/v1/maps/m/keyframes/kf-1",
        b"http://v1/maps/m/keyframes/kf-1",
        b"http:/v1/maps/m/keyframes/kf-1",
        b"http://x//v1/maps/m/keyframes/kf-1",
        b"file:///v1/maps/m/keyframes/kf-1x",
        b"/healthz/../v1/maps/m/keyframes/kf-1",
        b"/healthz%2f..%2fv1/maps/m/keyframes/kf-1",
        &long,
        &dots,
    ];
    for trick in tricks {
        let shown: String = String::from_utf8_lossy(trick).chars().take(80).collect();
        for method in ["DELETE", "GET", "PUT"] {
            let statuses = sent(&server, request(method, trick)).await;
            let refused = matches!(statuses.as_slice(), [400..500]);
            // The root is the viewer's, whatever its query.
            let viewer = method == "GET" && shown.starts_with("/?");
            assert!(refused || viewer, "{method} {shown}: {statuses:?}");
        }
        server.get(KEYFRAME).await.expect(200);
    }
    let maps = server.get("/v1/maps").await.expect(200);
    assert_eq!(maps["items"].as_array().map(Vec::len), Some(2), "{maps:#}");
}

#[tokio::test]
async fn other_spellings_of_the_same_names_reach_the_same() {
    let server = server().await;
    for same in [
        "/v1/maps/m/keyframes/kf%2d1",
        "/v1/maps/%6d/keyframes/%6b%66-1",
        "http://127.0.0.1:1/v1/maps/m/keyframes/kf-1",
        "HTTP://127.0.0.1:99/v1/maps/m/keyframes/kf-1",
    ] {
        assert_eq!(sent(&server, request("GET", same.as_bytes())).await, [200], "{same}");
    }
    // Dots are no names, and no way up.
    for dots in [
        "/v1/maps/m/keyframes/%2e%2e",
        "/v1/maps/m/keyframes/..",
        "/v1/maps/m/keyframes/%2E",
        "/v1/maps/..",
        "/v1/maps/.",
        "/v1/maps/%2e%2E/anchors/a-1",
        "/v1/maps/m/anchors/..",
        "/v1/maps/m/loops/.%2e",
        "/v1/keys/..",
    ] {
        assert_eq!(sent(&server, request("DELETE", dots.as_bytes())).await, [422], "{dots}");
    }
    server.get(KEYFRAME).await.expect(200);
}

#[tokio::test]
async fn headers_that_name_another_path_or_method_are_not_listened_to() {
    let server = server().await;
    for header in [
        "x-http-method-override: DELETE",
        "x-http-method: DELETE",
        "x-method-override: DELETE",
        "x-original-url: /healthz",
        "x-rewrite-url: /healthz",
        "x-forwarded-prefix: /v1/maps/m",
        "x-forwarded-host: other",
    ] {
        let text =
            format!("GET {KEYFRAME} HTTP/1.1\r\nhost: localhost\r\n{header}\r\nconnection: close\r\n\r\n");
        let mut connection = Connection::open(server.addr()).await;
        connection.send(text).await;
        let answer = connection.rest().await;
        assert_eq!(statuses(&answer), [200], "{header}");
        assert!(answer.contains(r#""map_version""#), "{header}: {answer}");
    }
    server.get(KEYFRAME).await.expect(200);
}

#[tokio::test]
async fn no_trick_with_framing_smuggles_a_request_or_breaks_the_server() {
    let server = server().await;
    let hidden = format!("DELETE {KEYFRAME} HTTP/1.1\r\nhost: localhost\r\n\r\n");
    let ask =
        "POST /v1/semantics/information HTTP/1.1\r\nhost: localhost\r\ncontent-type: application/json\r\n";
    let length = hidden.len();
    let chunked = "transfer-encoding: chunked\r\n";
    let head = |line: &str| format!("GET {KEYFRAME} HTTP/1.1\r\n{line}\r\nconnection: close\r\n\r\n");
    let many = "x-a: y\r\n".repeat(200);
    let mut cases: Vec<(&str, String)> = vec![
        ("a length, then chunks", format!("{ask}content-length: {length}\r\n{chunked}\r\n0\r\n\r\n{hidden}")),
        ("chunks, then a length", format!("{ask}{chunked}content-length: {length}\r\n\r\n0\r\n\r\n{hidden}")),
        ("two lengths", format!("{ask}content-length: 0\r\ncontent-length: {length}\r\n\r\n{hidden}")),
        ("a list of lengths", format!("{ask}content-length: 0, {length}\r\n\r\n{hidden}")),
        ("a negative length", format!("{ask}content-length: -1\r\n\r\n{hidden}")),
        ("a length with a sign", format!("{ask}content-length: +0\r\n\r\n{hidden}")),
        ("a length beyond 64 bits", format!("{ask}content-length: 99999999999999999999\r\n\r\n{hidden}")),
        ("chunks that are none", format!("{ask}transfer-encoding: xchunked\r\n\r\n0\r\n\r\n{hidden}")),
        (
            "chunks, then identity",
            format!("{ask}transfer-encoding: chunked, identity\r\n\r\n0\r\n\r\n{hidden}"),
        ),
        ("chunks under a broken name", format!("{ask}transfer-encoding : chunked\r\n\r\n0\r\n\r\n{hidden}")),
        (
            "chunks under a folded line",
            format!("{ask}transfer-encoding:\r\n chunked\r\n\r\n0\r\n\r\n{hidden}"),
        ),
        ("a chunk's size beyond 64 bits", format!("{ask}{chunked}\r\nfffffffffffffffff\r\n{hidden}")),
        ("a chunk's size that is none", format!("{ask}{chunked}\r\n0x0\r\n\r\n{hidden}")),
        ("a chunk longer than it says", format!("{ask}{chunked}\r\n1\r\n{{}}\r\n0\r\n\r\n{hidden}")),
        (
            "a folded header",
            format!("GET /healthz HTTP/1.1\r\nhost: localhost\r\nx-a: b\r\n {hidden}\r\n\r\n"),
        ),
        ("a space before the colon", format!("GET /healthz HTTP/1.1\r\nhost : x\r\n\r\n{hidden}")),
        (
            "a line of its own in a header",
            format!("GET /healthz HTTP/1.1\r\nhost: localhost\r\nx-a: b\r{hidden}\r\n"),
        ),
        ("NUL in a header", "GET /healthz HTTP/1.1\r\nhost: localhost\r\nx-a: \0\r\n\r\n".to_owned()),
        ("NUL in a header's name", "GET /healthz HTTP/1.1\r\nhost: localhost\r\nx\0a: b\r\n\r\n".to_owned()),
        ("a header without a name", "GET /healthz HTTP/1.1\r\n: x\r\n\r\n".to_owned()),
        ("200 headers", format!("GET /healthz HTTP/1.1\r\nhost: localhost\r\n{many}\r\n")),
        (
            "a head of 100 kB",
            format!("GET /healthz HTTP/1.1\r\nhost: localhost\r\nx-a: {}\r\n\r\n", "y".repeat(100_000)),
        ),
        ("a line of 100 kB", format!("GET /{} HTTP/1.1\r\nhost: localhost\r\n\r\n", "y".repeat(100_000))),
        ("HTTP/2", "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n".to_owned()),
        ("HTTP/3.7", head("host: localhost").replace("1.1", "3.7")),
        ("HTTP/0.9", format!("DELETE {KEYFRAME}\r\n")),
        ("no method", format!(" {KEYFRAME} HTTP/1.1\r\nhost: localhost\r\n\r\n")),
        ("a method of its own", head("host: localhost").replace("GET", "GETDELETE")),
        ("a method in lower case", head("host: localhost").replace("GET", "delete")),
        ("CONNECT", "CONNECT x:1 HTTP/1.1\r\nhost: localhost\r\n\r\n".to_owned()),
        ("TRACE", head("host: localhost").replace("GET", "TRACE")),
        ("TLS", "\u{16}\u{3}\u{1}\u{2}\0\u{1}\0\u{1}".to_owned()),
    ];
    cases.push(("nothing but new lines", "\r\n".repeat(5000)));
    for (what, bytes) in cases {
        let statuses = sent(&server, bytes).await;
        assert!(statuses.iter().all(|status| (400..500).contains(status)), "{what}: {statuses:?}");
        assert!(statuses.len() <= 1, "{what}: {statuses:?}");
        server.get(KEYFRAME).await.expect(200);
    }
}

#[tokio::test]
async fn old_and_odd_requests_that_are_allowed_are_answered() {
    let server = server().await;
    for (what, bytes) in [
        ("HTTP/1.0", format!("GET {KEYFRAME} HTTP/1.0\r\n\r\n")),
        ("no host", format!("GET {KEYFRAME} HTTP/1.1\r\nconnection: close\r\n\r\n")),
        (
            "two hosts",
            format!(
                "GET {KEYFRAME} HTTP/1.1\r\nhost: localhost\r\nhost: localhost\r\nconnection: close\r\n\r\n"
            ),
        ),
        ("bare line feeds", format!("GET {KEYFRAME} HTTP/1.1\nhost: localhost\nconnection: close\n\n")),
    ] {
        let statuses = sent(&server, bytes).await;
        assert!(matches!(statuses.as_slice(), [200 | 400]), "{what}: {statuses:?}");
    }
    let two = format!(
        "GET {KEYFRAME} HTTP/1.1\r\nhost: localhost\r\n\r\nGET /nowhere HTTP/1.1\r\nhost: localhost\r\nconnection: close\r\n\r\n"
    );
    assert_eq!(sent(&server, two).await, [200, 404], "two requests in one go");
    server.send(Method::DELETE, KEYFRAME, "text/plain", "a body that nobody wants").await.expect(200);
}
