//! Retries across an upgrade: a keyframe that a server of the former rule stored is told from another one as before.

use reqwest::Method;
use revisit::api::decoding::digest;
use revisit::api::decoding::document::Document;
use serde_json::{Value, json};

use super::checks::run_sql;
use super::keyframe;
use crate::support::{Answer, Server};

#[tokio::test(flavor = "multi_thread")]
async fn a_retry_of_what_an_earlier_version_stored_is_no_conflict_and_another_keyframe_is() {
    let folder = tempfile::tempdir().unwrap();
    let server = Server::on(folder.path()).await;
    server.put("/v1/maps/m", &json!({})).await.expect(201);
    let body = keyframe("day-1", 1);
    server.put("/v1/maps/m/keyframes/kf", &body).await.expect(201);
    server.stop().await;
    let former = digest::of(Document::from(&body).root(), None);
    let hex = former.iter().fold(String::new(), |hex, byte| format!("{hex}{byte:02x}"));
    let database = folder.path().join("test.db");
    run_sql(&database, &format!("update keyframes set digest = x'{hex}'")).await;

    let server = Server::on(folder.path()).await;
    server.put("/v1/maps/m/keyframes/kf", &body).await.expect(200);
    let mut line = body.clone();
    line["id"] = json!("kf");
    let bulk =
        server.request(Method::POST, "/v1/maps/m/keyframes").header("content-type", "application/x-ndjson");
    let answer: Value = serde_json::from_str(&Answer::text(bulk.body(line.to_string())).await).unwrap();
    assert_eq!(answer["status"], 200, "{answer}");
    let mut other = body;
    other["stamp"]["nanosec"] = json!(999);
    server.put("/v1/maps/m/keyframes/kf", &other).await.expect(409);
    server.stop().await;
}
