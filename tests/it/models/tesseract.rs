//! Tesseract: a plain machine reads a door plate. A stand-in on PATH speaks as the real one does; where the real one is
//! installed it reads, too.

use std::os::unix::fs::PermissionsExt as _;
use std::path::Path;
use std::process::Command;

use serde_json::json;

use super::scene::{crop, describes, hear_stream, keyframe};
use super::stub::{Reply, Stub};
use crate::crash::server::Server;

/// Reads `901` off whatever PNG it is given, as long as it is called as the real one is.
const STAND_IN: &str = r#"#!/bin/sh
if [ "$1" = "--version" ]; then echo "tesseract 5.3.0 (stand-in)"; exit 0; fi
[ "$*" = "stdin stdout --psm 7 --oem 1" ] || exit 2
head -c 8 | od -An -c | grep -q "P *N *G" || exit 3
cat > /dev/null
echo "901"
"#;

fn stand_in(directory: &Path) -> String {
    let program = directory.join("tesseract");
    std::fs::write(&program, STAND_IN).unwrap();
    std::fs::set_permissions(&program, std::fs::Permissions::from_mode(0o755)).unwrap();
    format!("{}:{}", directory.display(), std::env::var("PATH").unwrap_or_default())
}

async fn described(server: &Server) -> serde_json::Value {
    server.api().put("/v1/maps/m", &json!({})).await;
    let body = keyframe(1, 0.0, &[crop("door_number", [0.0, 0.0, 2.0], [7, 7, 7])]);
    let stored = server.api().put("/v1/maps/m/keyframes/kf-1", &body).await;
    assert!(stored.is_success(), "{}", stored.text());
    let listen = server.api().request(reqwest::Method::GET, "/v1/maps/m/events?since=0");
    hear_stream(listen, describes("a-0")).await;
    server.api().get("/v1/maps/m/anchors/a-0/transcript").await.json()
}

#[tokio::test(flavor = "multi_thread")]
async fn without_any_model_a_reader_reads_the_plate() {
    let directory = tempfile::tempdir().unwrap();
    let path = stand_in(directory.path());
    let database = directory.path().join("revisit.db");
    let server = Server::start_on_path(&database, &["--reader", "tesseract"], Some(&path));
    let transcript = described(&server).await;
    assert_eq!(
        (&transcript["items"][0]["text"], &transcript["items"][0]["source"]),
        (&json!("901"), &json!("tesseract"))
    );
    let anchor = server.api().get("/v1/maps/m/anchors/a-0").await.json();
    assert_eq!((&anchor["state"], &anchor["description"]), (&json!("valid"), &json!("901")));
}

#[tokio::test(flavor = "multi_thread")]
async fn a_reading_of_the_reader_is_a_hint_and_stands_in_while_the_model_is_away() {
    let directory = tempfile::tempdir().unwrap();
    let path = stand_in(directory.path());
    let stub = Stub::start(|_| Reply::Raw { status: 500, headers: vec![], body: String::new() }).await;
    let url = stub.url();
    let flags = [
        "--reader",
        "tesseract",
        "--model-url",
        &url,
        "--model-name",
        "stub",
        "--model-retries",
        "0",
        "--model-breaker-pause-ms",
        "20",
    ];
    let server = Server::start_on_path(&directory.path().join("revisit.db"), &flags, Some(&path));
    let transcript = described(&server).await;
    let item = &transcript["items"][0];
    assert_eq!((&item["source"], &item["degraded"]), (&json!("tesseract"), &json!(true)), "{transcript}");
    let look = &stub.journal()[0];
    assert!(look.data.as_str().is_some_and(|data| data.contains("read \"901\"")), "{}", look.data);

    // The model is back: it reads the crop again, and its word counts.
    stub.script(|_| Reply::Say("room 901".to_owned()));
    let listen = server.api().request(reqwest::Method::GET, "/v1/maps/m/events?since=0");
    hear_stream(listen, |event| event["detail"] == "room 901").await;
    let transcript = server.api().get("/v1/maps/m/anchors/a-0/transcript").await.json();
    assert_eq!(transcript["items"][0]["degraded"], false, "{transcript}");
}

#[test]
fn a_reader_that_is_not_installed_is_told_at_the_start() {
    let directory = tempfile::tempdir().unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_revisit"))
        .args(["serve", "--listen", "127.0.0.1:0", "--reader", "tesseract", "--database"])
        .arg(format!("sqlite://{}", directory.path().join("test.db").display()))
        .env("PATH", directory.path())
        .output()
        .unwrap();
    assert!(!output.status.success());
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(said.contains("tesseract does not run"), "{said}");
}
