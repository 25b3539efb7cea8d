//! Logs: every request leaves one line that tells its id, and no line tells a key.

use std::collections::HashMap;

use reqwest::Method;
use serde_json::{Value, json};

use super::keyframe;
use crate::crash::server::Server;

#[tokio::test(flavor = "multi_thread")]
async fn every_request_leaves_a_line_with_its_id_and_no_line_shows_its_key() {
    let folder = tempfile::tempdir().unwrap();
    let (database, backups) = (folder.path().join("revisit.db"), folder.path().join("backups"));
    let folder_of_backups = backups.display().to_string();
    let flags = ["--log", "trace", "--log-format", "json", "--backups", &folder_of_backups];
    let mut server = Server::start_with(&database, &flags);
    // A failure of ours, too: the folder is gone.
    std::fs::remove_dir(&backups).unwrap();
    let requests = [
        (Method::PUT, "/v1/maps/tower", json!({}), 201, "/v1/maps/{map}"),
        (
            Method::PUT,
            "/v1/maps/tower/keyframes/kf-1?query=loop",
            keyframe("a", 1),
            201,
            "/v1/maps/{map}/keyframes/{keyframe}",
        ),
        (Method::GET, "/v1/maps/nowhere", Value::Null, 404, "/v1/maps/{map}"),
        (Method::GET, "/no/such/path", Value::Null, 404, "unmatched"),
        (Method::POST, "/v1/maps/tower", json!({}), 405, "/v1/maps/{map}"),
        (Method::PUT, "/v1/maps/a%20b", json!([]), 422, "/v1/maps/{map}"),
        (Method::POST, "/v1/backups", json!({}), 500, "/v1/backups"),
    ];
    // The secret of a key that is good: what must not be seen is what would be worth seeing.
    let make = server
        .api()
        .request(Method::POST, "/v1/keys")
        .json(&json!({"actions": ["read", "write", "query", "admin"]}));
    let made: Value = make.send().await.unwrap().json().await.unwrap();
    let canary = made["secret"].as_str().unwrap();
    let mut sent = HashMap::new();
    for (method, path, body, status, route) in requests {
        let mut request = server.api().request(method.clone(), path);
        request = request.header("authorization", format!("Bearer {canary}"));
        let request = if body.is_null() { request } else { request.json(&body) };
        let answer = request.send().await.unwrap();
        assert_eq!(answer.status(), status, "{method} {path}");
        let id = answer.headers()["x-request-id"].to_str().unwrap().to_owned();
        assert!(!answer.text().await.unwrap().contains(canary));
        sent.insert(id, (method, status, route));
    }
    assert!(server.terminate().success());
    let log = std::fs::read_to_string(database.with_extension("log")).unwrap();
    assert!(log.contains("\"DEBUG\""), "the log is not loud");
    assert!(!log.contains(canary));
    let lines: Vec<Value> = log.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    for (id, (method, status, route)) in sent {
        let of_request = |line: &&Value| line["spans"][0]["request_id"] == *id;
        let line = lines.iter().filter(of_request).find(|line| line["target"] == "revisit::access").unwrap();
        let told = (&line["spans"][0]["method"], &line["spans"][0]["route"], &line["status"]);
        assert_eq!(told, (&json!(method.as_str()), &json!(route), &json!(status)));
        assert!(line["duration_ms"].as_f64().unwrap() > 0.0);
        if status == 500 {
            let failed = lines.iter().filter(of_request).find(|line| line["level"] == "ERROR").unwrap();
            assert!(failed["cause"].as_str().unwrap().contains("backups"), "{failed}");
        }
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_quiet_log_tells_failures_with_their_ids_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let (database, backups) = (folder.path().join("revisit.db"), folder.path().join("backups"));
    let mut server =
        Server::start_with(&database, &["--log", "error", "--backups", &backups.display().to_string()]);
    std::fs::remove_dir(&backups).unwrap();
    assert_eq!(server.api().put("/v1/maps/tower", &json!({})).await.status, 201);
    let request = server.api().request(Method::POST, "/v1/backups").json(&json!({}));
    assert_eq!(request.header("x-request-id", "my-own-id").send().await.unwrap().status(), 500);
    assert!(server.terminate().success());
    let log = std::fs::read_to_string(database.with_extension("log")).unwrap();
    assert_eq!(log.lines().count(), 1, "{log}");
    assert!(log.contains("ERROR request{request_id=my-own-id method=POST route=/v1/backups}"), "{log}");
}
