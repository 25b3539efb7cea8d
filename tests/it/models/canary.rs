//! Canary: a key appears in no log, no row, no answer and no error, whatever the server does with it.

use std::process::Command;

use serde_json::json;

use super::stub::{Reply, Stub, level};
use crate::support::Server;

const CANARY: &str = "sk-canary-7f3a9b2c5d8e";

#[tokio::test(flavor = "multi_thread")]
async fn the_key_goes_to_the_model_and_nowhere_else() {
    let directory = tempfile::tempdir().unwrap();
    let key = directory.path().join("key");
    std::fs::write(&key, format!("{CANARY}\n")).unwrap();
    // It echoes what it was sent, as careless servers do.
    let echo = Stub::start(|asked| {
        let header =
            asked.headers.get("authorization").and_then(|value| value.to_str().ok()).unwrap_or_default();
        let body = json!({"error": {"message": format!("Incorrect API key provided: {header}")}}).to_string();
        Reply::Raw { status: 401, headers: vec![], body }
    })
    .await;
    let flags = ["--model-key-file", key.to_str().unwrap()];
    let choice = echo.choice(&flags);
    assert!(!format!("{choice:?}").contains(CANARY));
    let server = Server::with_models_on(directory.path(), choice).await;
    let body = json!({"a": "a red boat at sea", "b": "a ship in a storm"});
    let answer = server.post("/v1/semantics/similarity", &body).await;
    assert!(echo.journal()[0].headers["authorization"].to_str().unwrap().contains(CANARY), "the key is sent");
    assert!(
        echo.journal()[0].headers["authorization"].is_sensitive() || !format!("{answer:?}").contains(CANARY)
    );
    assert!(!format!("{answer:?}").contains(CANARY));
    echo.script(|_| level(2));
    for path in ["/v1/usage", "/metrics", "/version"] {
        assert!(!format!("{:?}", server.get(path).await).contains(CANARY), "{path}");
    }
    server.stop().await;
    for entry in std::fs::read_dir(directory.path()).unwrap() {
        let path = entry.unwrap().path();
        if path != key {
            let bytes = std::fs::read(&path).unwrap();
            let found = bytes.windows(CANARY.len()).any(|window| window == CANARY.as_bytes());
            assert!(!found, "{}", path.display());
        }
    }
}

#[test]
fn no_log_and_no_error_of_the_program_shows_the_key() {
    let directory = tempfile::tempdir().unwrap();
    let database = format!("sqlite://{}", directory.path().join("test.db").display());
    // A model without a name stops the start; the loudest log tells all it knows.
    for arguments in [
        vec!["serve", "--model-url", "http://127.0.0.1:1/v1", "--log", "trace"],
        vec!["serve", "--model-url", "nonsense", "--model-name", "m", "--log", "trace"],
        vec!["serve", "--help"],
    ] {
        let output = Command::new(env!("CARGO_BIN_EXE_revisit"))
            .args(&arguments)
            .env("REVISIT_MODEL_KEY", CANARY)
            .env("REVISIT_LISTEN", "127.0.0.1:0")
            .env("REVISIT_DATABASE", &database)
            .output()
            .unwrap();
        let said = [output.stdout, output.stderr].concat();
        assert!(!String::from_utf8_lossy(&said).contains(CANARY), "{arguments:?}");
        assert!(!said.is_empty(), "{arguments:?}");
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn the_loudest_log_of_a_call_does_not_show_the_key() {
    let (directory, secrets) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let key = secrets.path().join("key");
    std::fs::write(&key, CANARY).unwrap();
    let stub = Stub::start(|_| level(5)).await;
    let (url, database) = (stub.url(), directory.path().join("revisit.db"));
    let flags = [
        "--model-url",
        &url,
        "--model-name",
        "stub",
        "--log",
        "trace",
        "--model-key-file",
        key.to_str().unwrap(),
    ];
    let mut server = crate::crash::server::Server::start_with(&database, &flags);
    let body = json!({"a": "a red boat at sea", "b": "a ship in a storm"});
    let answer = server.api().post("/v1/semantics/similarity", &body).await;
    assert!(answer.text().contains("model:stub"), "{}", answer.text());
    assert!(stub.journal()[0].headers["authorization"].to_str().unwrap().contains(CANARY));
    server.kill();
    for entry in std::fs::read_dir(directory.path()).unwrap() {
        let path = entry.unwrap().path();
        let text = String::from_utf8_lossy(&std::fs::read(&path).unwrap()).into_owned();
        assert!(!text.contains(CANARY), "{}", path.display());
    }
    let log = std::fs::read_to_string(database.with_extension("log")).unwrap();
    assert!(log.contains("TRACE"), "the log is not at its loudest");
}
