//! How often a key may ask.

use reqwest::Method;
use serde_json::json;

use crate::support::{Answer, Server, keyframe};

#[tokio::test]
async fn a_key_that_asks_too_often_is_told_when_to_come_back_and_others_are_served() {
    let server = Server::start().await;
    let body = json!({"actions": ["read", "write", "query", "admin"]});
    let free = server.post("/v1/keys", &body).await.expect(201);
    let free = free["secret"].as_str().expect("a secret");
    let body = json!({"actions": ["read", "write"], "rate_per_s": 1});
    let slow =
        Answer::of(server.request(Method::POST, "/v1/keys").bearer_auth(free).json(&body)).await.expect(201);
    let slow = slow["secret"].as_str().expect("a secret");
    let get =
        async |secret: &str| Answer::of(server.request(Method::GET, "/v1/maps").bearer_auth(secret)).await;
    // Its share of a second, and then no more; a second may pass while this is tried.
    let mut answers = Vec::new();
    while answers.last() != Some(&429) {
        let answer = get(slow).await;
        if answer.status == 429 {
            assert_eq!(answer.header("retry-after"), "1");
            assert_eq!(answer.body["code"], "too_many_requests");
        }
        answers.push(answer.status.as_u16());
    }
    assert!(answers[0] == 200 && answers.iter().all(|status| [200, 429].contains(status)), "{answers:?}");
    get(free).await.expect(200);
    server.get("/healthz").await.expect(200);
}

#[tokio::test]
async fn a_bulk_upload_is_slowed_down_rather_than_refused() {
    let server = Server::start().await;
    let made =
        server.post("/v1/keys", &json!({"actions": ["write", "admin"], "rate_per_s": 50})).await.expect(201);
    let secret = made["secret"].as_str().expect("a secret");
    let put = server.request(Method::PUT, "/v1/maps/m").bearer_auth(secret).json(&json!({}));
    Answer::of(put).await.expect(201);
    let lines: Vec<String> = (0..120)
        .map(|number| {
            let mut line = keyframe();
            line["id"] = json!(format!("kf-{number}"));
            format!("{line}\n")
        })
        .collect();
    let bulk = server.request(Method::POST, "/v1/maps/m/keyframes").bearer_auth(secret);
    let bulk = bulk.header("content-type", "application/x-ndjson").body(lines.concat());
    let started = std::time::Instant::now();
    Answer::of(bulk).await.expect(200);
    // 120 lines at 50 a second, of which 50 may come at once: not sooner than the key may ask.
    assert!(started.elapsed().as_secs_f64() > 1.0, "{:?}", started.elapsed());
}
