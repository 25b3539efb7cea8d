//! Copies of maps that other servers own, asked by clients that say which version they have seen.

use std::time::{Duration, Instant};

use reqwest::{Method, StatusCode};
use serde_json::{Value, json};

use crate::support::{Answer, Server, keyframe};

/// Longer than a server needs to learn of others, and an owner that its map is followed.
const SETTLES: Duration = Duration::from_secs(40);

/// Requests that a server answered from copies.
const COPIED: &str = "revisit_forwarded_total{outcome=\"copied\"}";

fn shot(number: usize) -> Value {
    let mut body = keyframe();
    body["stamp"] = json!({"sec": number, "nanosec": 0});
    body["bow"] = json!({"words": [number % 7, 10 + number % 5], "weights": [1, 2]});
    body["detections"] = json!([{"class": "door_number", "confidence": 0.9, "box": [1, 2, 30, 40],
        "position": [0.0, 0.0, 2.0], "text": format!("{}", 900 + number % 9)}]);
    body
}

/// Asks with a minimum version in the header.
async fn asked(server: &Server, method: Method, path: &str, body: Option<&Value>, version: u64) -> Answer {
    let request = server.request(method, path).header("x-revisit-min-version", version);
    Answer::of(match body {
        Some(body) => request.json(body),
        None => request,
    })
    .await
}

/// Two servers, the first of which owns a map with so many keyframes.
async fn owner_and_other(folder: &std::path::Path, keyframes: usize) -> (Server, Server, u64) {
    let (one, two) = Server::two(folder).await;
    one.put("/v1/maps/m", &json!({})).await;
    let owner = Answer::of(one.request(Method::GET, "/v1/maps/m")).await.header("x-revisit-owner").to_owned();
    let (owner, other) = if owner == one.url("") { (one, two) } else { (two, one) };
    let mut version = 1;
    for number in 0..keyframes {
        let written = owner.put(&format!("/v1/maps/m/keyframes/kf-{number}"), &shot(number)).await;
        version = written.body["map_version"].as_u64().expect("a version");
    }
    (owner, other, version)
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs REVISIT_TEST_POSTGRES"]
async fn a_copy_answers_as_the_owner_does_and_says_which_version_it_has_not() {
    let folder = tempfile::tempdir().unwrap();
    let (owner, other, mut version) = owner_and_other(folder.path(), 12).await;
    let query = json!({"keyframe": "kf-3"});
    let reads = [
        (Method::GET, "/v1/maps/m", None),
        (Method::GET, "/v1/maps/m/keyframes?limit=5", None),
        (Method::GET, "/v1/maps/m/keyframes/kf-3", None),
        (Method::GET, "/v1/maps/m/keyframes/kf-3/covisible", None),
        (Method::GET, "/v1/maps/m/keyframes/kf-3/local-anchor-map", None),
        (Method::GET, "/v1/maps/m/trajectory?session=default&format=tum", None),
        (Method::GET, "/v1/maps/m/sessions", None),
        (Method::GET, "/v1/maps/m/loops", None),
        (Method::GET, "/v1/maps/m/anchors?text=903", None),
        (Method::GET, "/v1/maps/m/anchors/a-0", None),
        (Method::POST, "/v1/maps/m/loop-queries", Some(&query)),
    ];
    // Until the owner knows that its map is followed, it is asked itself, or a copy is loaded anew; then a copy takes versions over.
    let begun = Instant::now();
    let mut rounds = 0;
    while other.figure("revisit_followed_versions").await < 5 {
        assert!(begun.elapsed() < SETTLES, "no version was taken over");
        let number = 100 + rounds;
        rounds += 1;
        let written = owner.put(&format!("/v1/maps/m/keyframes/kf-{number}"), &shot(number)).await;
        version = written.body["map_version"].as_u64().expect("a version");
        for (method, path, body) in &reads {
            let copied = asked(&other, method.clone(), path, *body, version).await;
            let owned = asked(&owner, method.clone(), path, *body, version).await;
            assert_eq!(copied.status, owned.status, "{path}: {copied:#?} {owned:#?}");
            assert!(
                copied.status.is_success() || copied.status == StatusCode::NOT_FOUND,
                "{path}: {copied:#?}"
            );
            assert_eq!(copied.bytes, owned.bytes, "{path}");
            assert_eq!(copied.header("x-revisit-owner"), owner.url(""));
        }
    }
    assert_eq!(other.figure("revisit_followed_maps").await, 1);
    assert!(other.figure(COPIED).await > 0);

    // An answer of the copy is read back everywhere.
    let asked_again = asked(&other, Method::POST, "/v1/maps/m/loop-queries", Some(&query), version).await;
    let record = format!("/v1/maps/m/loop-queries/{}", asked_again.body["id"].as_str().expect("an id"));
    for server in [&owner, &other] {
        let begun = Instant::now();
        loop {
            let read = Answer::of(server.request(Method::GET, &record)).await;
            if read.status == 200 {
                assert_eq!(read.bytes, asked_again.bytes);
                break;
            }
            assert!(begun.elapsed() < SETTLES, "{read:#?}");
            tokio::time::sleep(Duration::from_millis(50)).await;
        }
    }

    // A version that nobody has written.
    for server in [&owner, &other] {
        let early = asked(server, Method::GET, "/v1/maps/m", None, version + 1).await;
        assert_eq!(
            (early.status, &early.body["code"]),
            (StatusCode::PRECONDITION_FAILED, &json!("precondition_failed"))
        );
    }
    // What a copy does not answer, the owner does.
    let events = asked(&other, Method::GET, "/v1/maps/m/releases", None, version).await;
    assert_eq!(events.status, 200, "{events:#?}");

    // A map that is deleted is gone in its copy, and another one of its name is another one.
    owner.delete("/v1/maps/m").await;
    let gone = asked(&other, Method::GET, "/v1/maps/m", None, 1).await;
    assert_eq!(gone.status, StatusCode::NOT_FOUND, "{gone:#?}");
    owner.put("/v1/maps/m", &json!({"description": "another"})).await;
    let other_map = asked(&other, Method::GET, "/v1/maps/m", None, 1).await.expect(200);
    assert_eq!((&other_map["description"], &other_map["keyframes"]), (&json!("another"), &json!(0)));
    other.stop().await;
    owner.stop().await;
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs REVISIT_TEST_POSTGRES"]
async fn a_place_is_sought_in_the_maps_of_every_server() {
    let folder = tempfile::tempdir().unwrap();
    let (one, two) = Server::two(folder.path()).await;
    for map in 0..6 {
        one.put(&format!("/v1/maps/m-{map}"), &json!({})).await;
        for number in 0..3 {
            one.put(&format!("/v1/maps/m-{map}/keyframes/kf-{number}"), &shot(map + number)).await;
        }
    }
    let body = json!({"maps": ["m-*"], "keyframe": shot(4)});
    let located = [one.post("/v1/locate", &body).await, two.post("/v1/locate", &body).await];
    assert_eq!(located[0].status, 200, "{:#?}", located[0]);
    assert_eq!(located[0].bytes, located[1].bytes);
    assert_eq!(located[0].body["maps"].as_array().map(Vec::len), Some(6), "{:#?}", located[0]);
    two.stop().await;
    one.stop().await;
}

#[tokio::test]
async fn a_server_alone_waits_for_a_version_and_says_that_it_has_not() {
    let server = Server::start().await;
    server.put("/v1/maps/m", &json!({})).await;
    server.get("/v1/maps/m?min_version=1").await.expect(200);
    let twice = asked(&server, Method::GET, "/v1/maps/m?min_version=1", None, 1).await;
    assert_eq!(twice.status, StatusCode::UNPROCESSABLE_ENTITY, "{twice:#?}");
    let early = asked(&server, Method::GET, "/v1/maps/m", None, 2).await;
    assert_eq!(early.status, StatusCode::PRECONDITION_FAILED, "{early:#?}");
    assert!(early.body["detail"].as_str().expect("a detail").contains("version 1"), "{early:#?}");
    let body = shot(0);
    let (waiting, written) = tokio::join!(
        asked(&server, Method::GET, "/v1/maps/m", None, 2),
        server.put("/v1/maps/m/keyframes/kf-0", &body)
    );
    assert_eq!(written.status, 201, "{written:#?}");
    assert_eq!((waiting.status, &waiting.body["map_version"]), (StatusCode::OK, &json!(2)));
    for (method, path) in
        [(Method::GET, "/v1/maps/m?min_version=x"), (Method::DELETE, "/v1/maps/m?min_version=1")]
    {
        let refused = Answer::of(server.request(method, path)).await;
        assert_eq!(refused.status, StatusCode::UNPROCESSABLE_ENTITY, "{refused:#?}");
        assert_eq!(refused.body["errors"][0]["pointer"], "?min_version", "{refused:#?}");
    }
    server.stop().await;
}
