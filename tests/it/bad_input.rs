//! Bad input: refused with every offending field named, and the map stays as it is.

use reqwest::Method;
use serde_json::{Value, json};

use crate::raw::{Connection, statuses};
use crate::support::{Answer, Server, keyframe};

const MAP: &str = "/v1/maps/tower";
const JSON: &str = "application/json";

/// A server with a map and one keyframe in it.
async fn server() -> Server {
    let server = Server::start().await;
    server.put(MAP, &json!({"anchor_classes": ["door_number"]})).await.expect(201);
    server.put(&format!("{MAP}/keyframes/kf-1"), &keyframe()).await.expect(201);
    server
}

/// The refusal is of this status, a problem document, and names exactly these places.
#[track_caller]
fn check(what: &str, answer: &Answer, status: u16, pointers: &[&str]) {
    assert_eq!(answer.status.as_u16(), status, "{what}: {answer:#?}");
    assert_eq!(answer.header("content-type"), "application/problem+json", "{what}");
    assert_eq!(answer.header("x-content-type-options"), "nosniff", "{what}");
    let body = &answer.body;
    for member in ["type", "title", "detail", "code", "request_id"] {
        assert!(
            body[member].as_str().is_some_and(|text| !text.is_empty()),
            "{what}: no {member} in {body:#}"
        );
    }
    assert_eq!(body["status"], status, "{what}");
    assert_eq!(body["request_id"], answer.header("x-request-id"), "{what}");
    assert_eq!(answer.pointers(), pointers, "{what}: {body:#}");
}

/// The smallest keyframe with these members put in.
fn with(members: &Value) -> Value {
    let mut body = keyframe();
    for (name, value) in members.as_object().expect("members") {
        body[name] = value.clone();
    }
    body
}

fn detection(members: &Value) -> Value {
    let mut detection = json!({"class": "door_number", "confidence": 0.9, "box": [0, 0, 10, 10]});
    for (name, value) in members.as_object().expect("members") {
        detection[name] = value.clone();
    }
    with(&json!({"detections": [detection]}))
}

/// Bodies that are JSON and mean nothing good, each with the places at fault.
fn meaningless() -> Vec<(&'static str, Value, &'static [&'static str])> {
    let rotation = |w: f64| json!({"translation": {"x": 0, "y": 0, "z": 0}, "rotation": {"x": 0, "y": 0, "z": 0, "w": w}});
    let at = |x: Value| json!({"translation": {"x": x, "y": 0, "z": 0}, "rotation": {"x": 0, "y": 0, "z": 0, "w": 1}});
    let features = |bytes: Value, descriptors: &str| {
        with(
            &json!({"features": {"descriptor_bytes": bytes, "descriptors": descriptors, "keypoints": [[1, 2]]}}),
        )
    };
    vec![
        ("no object", json!([]), &[""]),
        ("nothing", json!({}), &["/stamp", "/pose"]),
        ("an unknown field", with(&json!({"weather": "fine"})), &["/weather"]),
        (
            "an unknown field below",
            with(&json!({"stamp": {"sec": 1, "nanosec": 0, "usec": 1}})),
            &["/stamp/usec"],
        ),
        ("text for a number", with(&json!({"stamp": {"sec": "1", "nanosec": 0}})), &["/stamp/sec"]),
        ("a number for a list", with(&json!({"observes": 12})), &["/observes"]),
        (
            "a range by another name",
            detection(&json!({"position": [0, 0, 2], "range": "guessed"})),
            &["/detections/0/range"],
        ),
        ("null for an object", with(&json!({"camera": null})), &["/camera"]),
        ("a fraction for a count", with(&json!({"observes": [1.5]})), &["/observes/0"]),
        ("1e39", with(&json!({"pose": at(json!(1e39))})), &["/pose/translation/x"]),
        ("a zero quaternion", with(&json!({"pose": rotation(0.0)})), &["/pose/rotation"]),
        ("half a quaternion", with(&json!({"pose": rotation(0.5)})), &["/pose/rotation"]),
        (
            "a quaternion of norm 2",
            with(&json!({"pose": rotation(2.0)})),
            &["/pose/rotation/w", "/pose/rotation"],
        ),
        (
            "a duplicate word",
            with(&json!({"bow": {"words": [3, 7, 3], "weights": [1, 1, 1]}})),
            &["/bow/words/2"],
        ),
        ("unequal lists", with(&json!({"bow": {"words": [3, 7], "weights": [1]}})), &["/bow/weights"]),
        ("a negative weight", with(&json!({"bow": {"words": [3], "weights": [-1]}})), &["/bow/weights/0"]),
        (
            "too large a word",
            with(&json!({"bow": {"words": [4_294_967_296_u64], "weights": [1]}})),
            &["/bow/words/0"],
        ),
        (
            "unequal points",
            with(&json!({"map_points": {"ids": [1], "positions": []}})),
            &["/map_points/positions"],
        ),
        ("bad base64", features(json!(8), "!!"), &["/features/descriptors"]),
        ("too few descriptors", features(json!(8), "AAAA"), &["/features/descriptors"]),
        ("odd descriptors", features(json!(12), ""), &["/features/descriptor_bytes"]),
        ("swapped corners", detection(&json!({"box": [10, 0, 0, 10]})), &["/detections/0/box"]),
        ("confidence above one", detection(&json!({"confidence": 1.5})), &["/detections/0/confidence"]),
        ("a crop that is no image", detection(&json!({"crop": "AAAA"})), &["/detections/0/crop"]),
        (
            "itself covisible",
            with(&json!({"covisible": [{"keyframe": "kf-2", "shared": 9}]})),
            &["/covisible/0/keyframe"],
        ),
        (
            "nobody covisible",
            with(&json!({"covisible": [{"keyframe": "kf-9", "shared": 9}]})),
            &["/covisible/0/keyframe"],
        ),
        (
            "nobody covisible, and more",
            with(&json!({"weather": "fine", "covisible": [{"keyframe": "kf-1", "shared": 9},
                {"keyframe": "kf-9", "shared": -1}, {"keyframe": "kf-8", "shared": 9}]})),
            &["/weather", "/covisible/1/shared", "/covisible/1/keyframe", "/covisible/2/keyframe"],
        ),
        ("a bad id", with(&json!({"session": "a/b"})), &["/session"]),
        ("dots for an id", with(&json!({"session": ".."})), &["/session"]),
        (
            "a dot for a keyframe",
            with(&json!({"covisible": [{"keyframe": ".", "shared": 9}]})),
            &["/covisible/0/keyframe"],
        ),
        (
            "several at once",
            json!({
                "pose": rotation(0.0), "bow": {"words": [1, 1], "weights": [1]},
                "detections": [{"class": "", "confidence": 2, "box": [0, 0, 1]}], "weather": "fine"
            }),
            &[
                "/weather",
                "/stamp",
                "/pose/rotation",
                "/bow/words/1",
                "/bow/weights",
                "/detections/0/class",
                "/detections/0/confidence",
                "/detections/0/box",
            ],
        ),
    ]
}

#[tokio::test]
async fn a_meaningless_body_names_every_field_and_changes_nothing() {
    let server = server().await;
    let before = server.get(MAP).await.expect(200);
    for (what, body, pointers) in meaningless() {
        check(what, &server.put(&format!("{MAP}/keyframes/kf-2"), &body).await, 422, pointers);
        let line = format!("{}\n", {
            let mut line = body.clone();
            if line.is_object() {
                line["id"] = json!("kf-2");
            }
            line
        });
        let bulk = server
            .send(Method::POST, &format!("{MAP}/keyframes"), "application/x-ndjson", line)
            .await
            .expect(207);
        assert_eq!(bulk["problem"]["status"], 422, "{what} in bulk: {bulk:#}");
        if body.is_object() {
            let faults = bulk["problem"]["errors"].as_array().expect("faults");
            let told: Vec<&str> = faults.iter().filter_map(|fault| fault["pointer"].as_str()).collect();
            assert_eq!(told, pointers, "{what} in bulk");
        }
    }
    assert_eq!(server.get(MAP).await.expect(200), before);
}

#[tokio::test]
async fn a_body_that_is_not_json_is_refused_with_its_place_and_changes_nothing() {
    let server = server().await;
    let before = server.get(MAP).await.expect(200);
    let path = format!("{MAP}/keyframes/kf-2");
    let nesting = format!(r#"{{"stamp":{}"#, "[".repeat(1 << 20));
    let deep = format!("/stamp{}", "/0".repeat(126));
    let cases: [(&str, &str, &str); 8] = [
        ("an empty body", "", ""),
        ("NaN", r#"{"stamp":{"sec":NaN}}"#, "/stamp/sec"),
        ("-Infinity", r#"{"pose":{"translation":{"x":-Infinity}}}"#, "/pose/translation/x"),
        ("Infinity", r#"{"bow":{"words":[1],"weights":[Infinity]}}"#, "/bow/weights/0"),
        ("1e400", r#"{"pose":{"translation":{"x":1e400}}}"#, "/pose/translation/x"),
        ("half a body", r#"{"stamp":{"sec":1"#, "/stamp"),
        ("a name twice", r#"{"stamp":{"sec":1,"sec":2}}"#, "/stamp"),
        ("1 MB of nesting", &nesting, &deep),
    ];
    for (what, body, pointer) in cases {
        let answer = server.send(Method::PUT, &path, JSON, body.to_owned()).await;
        check(what, &answer, 400, &[pointer]);
        let detail = answer.body["detail"].as_str().expect("a detail");
        let is_told = match what {
            "an empty body" => detail.contains("the body is empty"),
            "NaN" | "Infinity" | "-Infinity" => detail.starts_with(&format!("{what} is not JSON")),
            _ => true,
        };
        assert!(is_told, "{what}: {detail}");
    }
    assert_eq!(server.get(MAP).await.expect(200), before);
}

#[tokio::test]
async fn ids_sizes_types_and_encodings_are_checked_and_nothing_changes() {
    let server = server().await;
    let before = server.get(MAP).await.expect(200);
    let long = "x".repeat(129);
    check(
        "an id of 129 characters",
        &server.put(&format!("{MAP}/keyframes/{long}"), &keyframe()).await,
        422,
        &["{keyframe}"],
    );
    check(
        "two bad ids",
        &server.put(&format!("/v1/maps/{long}/keyframes/a%20b"), &keyframe()).await,
        422,
        &["{map}", "{keyframe}"],
    );
    let path = format!("{MAP}/keyframes/kf-2");
    let large = vec![b' '; (32 << 20) + 1];
    check("a body over the limit", &server.send(Method::PUT, &path, JSON, large).await, 413, &[]);
    let many = format!("[{}0]", "0,".repeat(4_000_000));
    check("more values than fit", &server.send(Method::PUT, &path, JSON, many).await, 413, &[]);
    check("XML", &server.send(Method::PUT, &path, "application/xml", "<kf/>").await, 415, &[]);
    let brotli = server.request(Method::PUT, &path).header("content-encoding", "br").body("x");
    check("an unknown encoding", &Answer::of(brotli).await, 415, &[]);
    let gzip = server.request(Method::PUT, &path).header("content-encoding", "gzip").body("no gzip");
    check("a wrong encoding", &Answer::of(gzip).await, 400, &[]);
    assert_eq!(server.get(MAP).await.expect(200), before);
}

#[tokio::test]
async fn parameters_paths_and_methods_are_checked() {
    let server = server().await;
    let list = format!("{MAP}/anchors");
    check("a limit of 0", &server.get(&format!("{list}?limit=0")).await, 422, &["?limit"]);
    check(
        "two bad parameters",
        &server.get(&format!("{list}?limit=x&state=odd")).await,
        422,
        &["?limit", "?state"],
    );
    check("an unknown parameter", &server.get(&format!("{list}?colour=red")).await, 422, &["?colour"]);
    check("a parameter twice", &server.get(&format!("{list}?limit=1&limit=2")).await, 422, &["?limit"]);
    check(
        "an unknown question",
        &server.put(&format!("{MAP}/keyframes/kf-2?query=x"), &keyframe()).await,
        422,
        &["?query"],
    );
    let missing = server.get("/v1/maps/nowhere").await;
    check("no such map", &missing, 404, &[]);
    let detail = missing.body["detail"].as_str().expect("a detail");
    assert!(detail.contains("`PUT /v1/maps/nowhere`"), "{detail}");
    check("no such path", &server.get("/v1/mops").await, 404, &[]);
    let wrong = server.delete("/v1/maps").await;
    check("no such method", &wrong, 405, &[]);
    assert!(wrong.header("allow").contains("GET"), "{wrong:#?}");
    let broken = server.request(Method::DELETE, &format!("{MAP}/anchors/a-0")).header("if-match", "4");
    check("a malformed if-match", &Answer::of(broken).await, 400, &["if-match:"]);
}

#[tokio::test]
async fn a_map_and_a_query_are_checked_like_a_keyframe() {
    let server = server().await;
    let settings = json!({"settings": {"candidates_max": 0, "building_repeats": 1, "sigma": 0.2, "without_anchors": "maybe"}});
    let places = [
        "/settings/sigma",
        "/settings/building_repeats",
        "/settings/candidates_max",
        "/settings/without_anchors",
    ];
    check("bad settings", &server.put("/v1/maps/other", &settings).await, 422, &places);
    check("a patch of nothing known", &server.patch(MAP, &json!({"name": "x"})).await, 422, &["/name"]);
    let queries = format!("{MAP}/loop-queries");
    check("no subject", &server.post(&queries, &json!({})).await, 422, &[""]);
    check(
        "two subjects",
        &server.post(&queries, &json!({"keyframe": "kf-1", "inline": keyframe()})).await,
        422,
        &[""],
    );
    let inline = json!({"inline": {"stamp": {"sec": 1, "nanosec": -1}}, "verify": "always", "seed": 0.5});
    let places = ["/inline/stamp/nanosec", "/inline/pose", "/verify", "/seed"];
    check("a bad inline keyframe", &server.post(&queries, &inline).await, 422, &places);
    let unknown =
        json!({"inline": with(&json!({"covisible": [{"keyframe": "kf-9", "shared": 9}]})), "seed": 0.5});
    let places = ["/seed", "/inline/covisible/0/keyframe"];
    check("an unknown keyframe, and more", &server.post(&queries, &unknown).await, 422, &places);
}

#[tokio::test]
async fn a_request_whose_host_is_empty_is_refused() {
    let server = Server::start().await;
    let mut connection = Connection::open(server.addr()).await;
    connection.send("GET /v1/maps HTTP/1.1\r\nhost:\r\nconnection: close\r\n\r\n").await;
    let answer = connection.rest().await;
    assert_eq!(statuses(&answer), [400], "{answer}");
    assert!(answer.contains("`host` is empty"), "{answer}");
}

#[tokio::test]
async fn bytes_that_are_not_http_are_answered_with_a_problem() {
    let server = Server::start().await;
    let many = "x: a\r\n".repeat(200);
    let long = "a".repeat(70_000);
    for (what, head, status) in [
        ("a name with a space", "GET / HTTP/1.1\r\nx y: a\r\n\r\n".to_owned(), 400),
        ("no HTTP", "hello there, server\r\n\r\n".to_owned(), 400),
        ("another version", "GET / HTTP/3.0\r\n\r\n".to_owned(), 400),
        ("TLS", "\u{16}\u{3}\u{1}\u{2}\u{0}\u{1}\u{0}\u{1}".to_owned(), 400),
        ("many headers", format!("GET / HTTP/1.1\r\n{many}\r\n"), 431),
        ("a long header", format!("GET / HTTP/1.1\r\nx: {long}\r\n\r\n"), 431),
        ("a long path", format!("GET /{long} HTTP/1.1\r\n\r\n"), 431),
    ] {
        // Alone, and after requests that were answered, one by one and in one go.
        let sane = "GET /version HTTP/1.1\r\nhost: localhost\r\n\r\n";
        for before in [&[][..], &[sane], &[sane, sane]] {
            for in_one_go in [false, true] {
                let mut connection = Connection::open(server.addr()).await;
                let mut sent = String::new();
                for request in before {
                    if in_one_go {
                        sent += request;
                    } else {
                        connection.send(request).await;
                        assert!(connection.head().await.contains("200 OK"), "{what}");
                    }
                }
                connection.send(sent + &head).await;
                let answers = connection.rest().await;
                let mut expected = vec![200; if in_one_go { before.len() } else { 0 }];
                expected.push(status);
                assert_eq!(statuses(&answers), expected, "{what} after {before:?}: {answers}");
                let (_, answer) = answers.rsplit_once("HTTP/1.1 ").expect("an answer");
                let (head, body) = answer.split_once("\r\n\r\n").expect("a body");
                let problem: Value = serde_json::from_str(body).expect("a problem");
                assert_eq!(problem["status"], status, "{what}: {answer}");
                let id = problem["request_id"].as_str().expect("an id");
                for header in [
                    "content-type: application/problem+json".to_owned(),
                    "connection: close".to_owned(),
                    format!("content-length: {}", body.len()),
                    format!("x-request-id: {id}"),
                ] {
                    assert!(head.lines().any(|line| line == header), "{what}: {header}\n{head}");
                }
            }
        }
    }
}
