//! The client against a server that says just what the test wants.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex};

use axum::Router;
use axum::body::Bytes;
use axum::http::{HeaderMap, Method as HttpMethod, Uri};
use axum::response::{IntoResponse, Response as HttpResponse};
use revisit_api::examples;
use revisit_api::keyframe::KeyframeBody;
use revisit_api::loops::LoopBody;
use revisit_core::domain::anchor::AnchorState;
use serde_json::{Value, json};
use tokio::net::TcpListener;

use super::connection::BUSY_ATTEMPTS;
use super::*;

/// A request as it came in: `METHOD /path?query`, authorization, body.
type Seen = Arc<Mutex<Vec<(String, Option<String>, Value)>>>;

/// Answers every request with `answer`, and keeps what it saw.
async fn stub<A, R>(answer: A) -> (Client, Seen)
where
    A: Fn() -> R + Clone + Send + Sync + 'static,
    R: IntoResponse,
{
    let seen = Seen::default();
    let log = Arc::clone(&seen);
    let handler = move |method: HttpMethod, uri: Uri, headers: HeaderMap, body: Bytes| {
        let authorization = headers.get("authorization");
        let authorization = authorization.and_then(|value| value.to_str().ok());
        let body = serde_json::from_slice(&body).unwrap_or(Value::Null);
        let request = (format!("{method} {uri}"), authorization.map(str::to_owned), body);
        log.lock().expect("no test panicked").push(request);
        let answer: HttpResponse = answer().into_response();
        std::future::ready(answer)
    };
    let listener = TcpListener::bind("127.0.0.1:0").await.expect("a port");
    let address = listener.local_addr().expect("an address");
    let router = Router::new().fallback(handler);
    tokio::spawn(async move { axum::serve(listener, router).await });
    let client = Client::new(&format!("http://{address}/")).expect("an address");
    (client, seen)
}

fn seen(seen: &Seen) -> Vec<(String, Option<String>, Value)> {
    seen.lock().expect("no test panicked").clone()
}

/// A body that the stub does not look at.
fn body() -> Recorded {
    Recorded([("a".to_owned(), json!(1))].into_iter().collect())
}

#[tokio::test]
async fn every_operation_asks_what_the_api_document_says() {
    let answers = [
        examples::map(),
        examples::keyframe_answer(),
        examples::keyframe_answer(),
        examples::loop_answer(),
        examples::loop_answer(),
        examples::loop_closed(),
        examples::loop_revoked(),
        examples::poses_answer(),
        examples::keyframes(),
        examples::judgement(),
        examples::judgement(),
        examples::made_key(),
        examples::backup_taken(),
    ];
    let asked = Arc::new(AtomicU32::new(0));
    let next = move || axum::Json(answers[asked.fetch_add(1, Ordering::SeqCst) as usize].clone());
    let (client, log) = stub(next).await;
    let client = client.with_key("secret".to_owned());
    let body = body();
    client.put_map("m", &body).await.expect("an answer");
    client.put_keyframe("m", "k:1", &body, false).await.expect("an answer");
    client.put_keyframe("m", "k/1", &body, true).await.expect("an answer");
    client.loop_query("m", &body).await.expect("an answer");
    client.brief_loop_query("m", &body).await.expect("an answer");
    client.post_loop("m", &body).await.expect("an answer");
    client.delete_loop("m", "l").await.expect("an answer");
    client.post_poses("m", &body).await.expect("an answer");
    client.list_redundant_keyframes("m", &Page::default()).await.expect("an answer");
    client.post_judgement("m", &body).await.expect("an answer");
    client.delete_judgement("m", "j").await.expect("an answer");
    client.post_key(&body).await.expect("an answer");
    client.post_backup(&body).await.expect("an answer");

    let sent = Value::Object(body.0);
    let asked =
        |request: &str, body: &Value| (request.to_owned(), Some("Bearer secret".to_owned()), body.clone());
    assert_eq!(
        seen(&log),
        [
            asked("PUT /v1/maps/m", &sent),
            asked("PUT /v1/maps/m/keyframes/k:1", &sent),
            asked("PUT /v1/maps/m/keyframes/k%2F1?query=loop", &sent),
            asked("POST /v1/maps/m/loop-queries", &sent),
            asked("POST /v1/maps/m/loop-queries?detail=brief", &sent),
            asked("POST /v1/maps/m/loops", &sent),
            asked("DELETE /v1/maps/m/loops/l", &Value::Null),
            asked("POST /v1/maps/m/poses", &sent),
            asked("GET /v1/maps/m/keyframes?redundant=true", &Value::Null),
            asked("POST /v1/maps/m/judgements", &sent),
            asked("DELETE /v1/maps/m/judgements/j", &Value::Null),
            asked("POST /v1/keys", &sent),
            asked("POST /v1/backups", &sent),
        ]
    );
}

#[tokio::test]
async fn a_search_is_sent_as_parameters_and_a_typed_body_as_its_shape() {
    let (client, log) = stub(|| axum::Json(examples::anchors())).await;
    let search = AnchorSearch {
        text: Some("a b".to_owned()),
        state: Some(AnchorState::Valid.into()),
        page: Page { limit: Some(2), cursor: None },
        ..AnchorSearch::default()
    };
    client.list_anchors("m", &search).await.expect("an answer");
    let new = LoopBody::found("l", "k2", "k1", "q".to_owned()).expect("ids");
    client.post_loop("m", &new).await.expect_err("not its answer");
    let seen = seen(&log);
    assert_eq!(seen[0].0, "GET /v1/maps/m/anchors?text=a%20b&state=valid&limit=2");
    assert_eq!(seen[1].2, json!({"id": "l", "keyframe": "k2", "candidate": "k1", "query": "q"}));
}

#[tokio::test]
async fn an_answer_without_a_body_is_enough_where_nothing_is_read() {
    let (client, _) = stub(|| axum::http::StatusCode::NO_CONTENT).await;
    client.delete_map("m").await.expect("an answer");
    client.delete_key("key-1", false).await.expect("an answer");
}

#[tokio::test]
async fn the_example_of_an_answer_is_understood() {
    let (client, _) = stub(|| axum::Json(examples::loop_answer())).await;
    let answer = client.loop_query("m", &body()).await.expect("an answer");
    assert_eq!(serde_json::to_value(&answer).expect("JSON"), examples::loop_answer());
    let candidate = answer.leading().expect("a candidate");
    assert_eq!(Some(&candidate.keyframe), answer.best.as_ref());
    assert_eq!(Some(candidate.bow_score()), candidate.bow.as_ref().map(|bow| bow.score));
    assert_eq!(candidate.inliers(), candidate.geometry.inliers.map(u64::from));
}

#[tokio::test]
async fn a_replayed_write_is_told_apart() {
    let replayed = ("idempotent-replayed", "true");
    let (client, _) = stub(move || ([replayed], axum::Json(examples::keyframe_answer()))).await;
    let answer = client.put_keyframe("m", "k", &body(), false).await;
    assert!(answer.expect("an answer").replayed);
    let (client, _) = stub(|| axum::Json(examples::keyframe_answer())).await;
    let answer = client.put_keyframe("m", "k", &body(), false).await;
    assert!(!answer.expect("an answer").replayed);
}

#[tokio::test]
async fn many_keyframes_are_lines_and_so_are_their_answers() {
    let line = examples::bulk_line();
    let answer = format!("{line}\n{line}\n");
    let (client, log) = stub(move || answer.clone()).await;
    let keyframe: KeyframeBody = serde_json::from_value(examples::keyframe_body()).expect("a keyframe");
    let named = NamedKeyframe { id: "kf-1".to_owned(), keyframe };
    let lines = client.put_keyframes("m", std::slice::from_ref(&named)).await.expect("two lines");
    assert_eq!(lines.len(), 2);
    let (request, _, body) = &seen(&log)[0];
    assert_eq!((request.as_str(), &body["id"]), ("POST /v1/maps/m/keyframes", &json!("kf-1")));
    assert_eq!(body["pose"], examples::keyframe_body()["pose"]);
}

#[tokio::test]
async fn events_are_heard_until_the_listener_has_enough() {
    let event = examples::event();
    let stream = format!(": alive\n\nid: 1\nevent: a\ndata: {event}\n\nid: 2\nevent: a\ndata: {event}\n\n");
    let (client, log) = stub(move || stream.clone()).await;
    let mut heard = Vec::new();
    let one = |event| {
        heard.push(event);
        ControlFlow::Break(())
    };
    client.listen("m", 7, one).await.expect("an event");
    assert_eq!(serde_json::to_value(&heard).expect("JSON"), json!([examples::event()]));
    assert_eq!(seen(&log)[0].0, "GET /v1/maps/m/events?since=7");
}

#[tokio::test]
async fn a_problem_is_a_line_and_a_line_for_every_fault() {
    let problem = json!({"type": "about:blank", "title": "Unprocessable", "status": 422, "detail": "2 faults",
        "code": "invalid", "request_id": "r-1", "errors": [
            {"pointer": "/detections/0/box", "detail": "x1 < x0", "got": [2, 0, 1, 1], "limit": null},
            {"pointer": "", "detail": "too many words", "got": "9", "limit": 8}]});
    let status = axum::http::StatusCode::UNPROCESSABLE_ENTITY;
    let (client, _) = stub(move || (status, axum::Json(problem.clone()))).await;
    let error = client.put_map("m", &body()).await.expect_err("refused");
    assert_eq!(error.problem().map(|problem| problem.status), Some(422));
    assert_eq!(
        error.to_string(),
        format!(
            "422 Unprocessable: 2 faults ({}/v1/maps/m, request r-1)\n  \
             /detections/0/box: x1 < x0 (got [2,0,1,1])\n  \
             /: too many words (got 9, limit 8)",
            client.base_url()
        )
    );
}

#[tokio::test]
async fn a_page_of_a_proxy_is_a_problem_too() {
    let status = axum::http::StatusCode::BAD_GATEWAY;
    let (client, _) = stub(move || (status, "<h1>no\n upstream</h1>")).await;
    let error = client.put_map("m", &body()).await.expect_err("refused");
    let error = error.to_string();
    assert!(error.starts_with("502 Bad Gateway: <h1>no upstream</h1> ("), "{error}");
}

#[tokio::test]
async fn an_answer_off_the_api_document_is_said_with_its_place() {
    let mut answer = examples::loop_answer();
    answer["candidates"][0]["verdict"] = json!("perhaps");
    let (client, _) = stub(move || axum::Json(answer.clone())).await;
    let error = client.loop_query("m", &body()).await.expect_err("off");
    let error = error.to_string();
    assert!(error.contains("/v1/maps/m/loop-queries is not understood"), "{error}");
    assert!(error.contains("candidates[0].verdict"), "{error}");
}

/// A map as a server answers it.
const MAP: &str = r#"{"id":"m","map_version":1,"description":"","metric":true,"anchor_classes":[],"code_classes":[],"settings":{},
    "keyframes":0,"anchors":0,"sessions":0,"loops":0,"bytes":0,"numbering":{},"twins":[]}"#;

#[tokio::test]
async fn a_busy_server_is_asked_again_when_it_says_so() {
    let asked = Arc::new(AtomicU32::new(0));
    let counter = Arc::clone(&asked);
    let (client, _) = stub(move || match counter.fetch_add(1, Ordering::SeqCst) {
        0 => (axum::http::StatusCode::SERVICE_UNAVAILABLE, [("retry-after", "0")], "{}"),
        1 => (axum::http::StatusCode::TOO_MANY_REQUESTS, [("retry-after", "0")], "{}"),
        _ => (axum::http::StatusCode::OK, [("retry-after", "0")], MAP),
    })
    .await;
    client.put_map("m", &body()).await.expect("an answer");
    assert_eq!(asked.load(Ordering::SeqCst), 3);
}

#[tokio::test]
async fn a_server_that_stays_busy_or_names_no_time_is_a_problem() {
    let busy = axum::http::StatusCode::SERVICE_UNAVAILABLE;
    let (client, log) = stub(move || (busy, [("retry-after", "0")])).await;
    client.put_map("m", &body()).await.expect_err("busy");
    assert_eq!(seen(&log).len(), BUSY_ATTEMPTS as usize);
    for retry_after in ["3600", "Fri, 31 Dec 1999 23:59:59 GMT"] {
        let (client, log) = stub(move || (busy, [("retry-after", retry_after)])).await;
        client.put_map("m", &body()).await.expect_err("busy");
        assert_eq!(seen(&log).len(), 1);
    }
}

#[tokio::test]
async fn a_server_that_is_not_there_is_said_with_the_url_and_the_cause() {
    let listener = TcpListener::bind("127.0.0.1:0").await.expect("a port");
    let address = listener.local_addr().expect("an address");
    drop(listener);
    let client = Client::new(&format!("http://{address}")).expect("an address");
    let error = client.put_map("m", &body()).await.expect_err("nobody there");
    let error = error.to_string();
    assert!(error.starts_with(&format!("http://{address}/v1/maps/m: ")), "{error}");
    assert!(error.to_lowercase().contains("refused"), "{error}");
    assert!(error.lines().count() == 1, "{error}");
}
