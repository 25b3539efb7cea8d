//! Lockout: over HTTP a server keeps a key that may administer, and a first key says what it changes.

use std::path::Path;
use std::process::Command;

use reqwest::Method;
use serde_json::json;

use crate::support::{Answer, Server};

#[tokio::test]
async fn rejects_a_first_key_that_could_not_administer_and_stays_open() {
    let server = Server::start().await;
    for (body, lacks) in [
        (json!({"actions": ["read", "write", "query"]}), &["admin"][..]),
        (json!({"actions": ["read", "write", "query"], "maps": ["tower", "tower-*"]}), &["admin", "maps"]),
        (json!({"actions": ["read", "admin"], "maps": ["tower"]}), &["maps"]),
        (
            json!({"actions": ["read", "admin"], "expires": {"sec": 4_000_000_000_i64, "nanosec": 0}}),
            &["expires"],
        ),
    ] {
        let refused = server.post("/v1/keys", &body).await.expect(409);
        assert_eq!(refused["code"], "first_key_must_administer", "{body}");
        let detail = refused["detail"].as_str().expect("a text");
        assert!(lacks.iter().all(|word| detail.contains(word)), "{body}: {detail}");
    }
    // What is wrong by itself is told as ever, and nothing has been locked.
    server.post("/v1/keys", &json!({"actions": []})).await.expect(422);
    server.get("/v1/maps").await.expect(200);
    assert_eq!(server.get("/v1/keys").await.expect(200)["items"], json!([]));
}

#[tokio::test]
async fn the_first_key_says_what_changes_and_the_second_changes_nothing() {
    let server = Server::start().await;
    let made = server.post("/v1/keys", &json!({"actions": ["read", "admin"]})).await.expect(201);
    let notice = made["notice"].as_str().expect("a notice");
    assert!(notice.contains("from now on every request needs a key"), "{notice}");
    let root = made["secret"].as_str().expect("a secret");
    let body = json!({"actions": ["read"], "maps": ["tower"]});
    let second = Answer::of(server.request(Method::POST, "/v1/keys").bearer_auth(root).json(&body)).await;
    assert!(second.expect(201).get("notice").is_none());
    // With a key there, an administrator's key of some maps is what it always was: meaningless.
    let body = json!({"actions": ["admin"], "maps": ["tower"]});
    let some = Answer::of(server.request(Method::POST, "/v1/keys").bearer_auth(root).json(&body)).await;
    some.expect(422);
}

#[tokio::test]
async fn keeps_the_last_key_that_may_administer_unless_the_request_says_so() {
    let server = Server::start().await;
    let made = server.post("/v1/keys", &json!({"actions": ["read", "admin"]})).await.expect(201);
    let root = made["secret"].as_str().expect("a secret").to_owned();
    let make = async |body| {
        Answer::of(server.request(Method::POST, "/v1/keys").bearer_auth(&root).json(&body)).await.expect(201)
    };
    let revoke = async |id: &str, secret: &str| {
        Answer::of(server.request(Method::DELETE, &format!("/v1/keys/{id}")).bearer_auth(secret)).await
    };
    make(json!({"actions": ["read", "write"]})).await;
    let passing = json!({"actions": ["admin"], "expires": {"sec": 4_000_000_000_i64, "nanosec": 0}});
    make(passing).await;
    let refused = revoke("key-1", &root).await.expect(409);
    assert_eq!(refused["code"], "last_admin_key");
    assert!(refused["detail"].as_str().expect("a text").contains("last_admin=true"), "{refused}");

    let other = make(json!({"actions": ["admin"]})).await;
    let other = other["secret"].as_str().expect("a secret");
    revoke("key-1", other).await.expect(204);
    revoke("key-2", other).await.expect(204);
    revoke("key-3", other).await.expect(204);
    revoke("key-4", other).await.expect(409);
    revoke("key-4?last_admin=perhaps", other).await.expect(422);
    revoke("key-4?last_admin=true", other).await.expect(204);
    server.get("/v1/keys").await.expect(401);
}

#[test]
fn the_command_line_makes_and_revokes_any_key_and_says_what_that_means() {
    let directory = tempfile::tempdir().expect("a directory");
    let database = directory.path().join("test.db");
    let first = keys(&database, &["create", "--actions", "read,write"]);
    assert!(first.contains("from now on every request needs a key"), "{first}");
    assert!(first.contains("No administrator key") && first.contains("revisit keys create"), "{first}");
    let second = keys(&database, &["create", "--actions", "admin"]);
    assert!(!second.contains("from now on") && !second.contains("No administrator key"), "{second}");
    let revoked = keys(&database, &["revoke", "key-2"]);
    assert!(revoked.contains("No administrator key"), "{revoked}");
}

/// What `revisit keys` says to a person.
fn keys(database: &Path, arguments: &[&str]) -> String {
    let mut command = Command::new(env!("CARGO_BIN_EXE_revisit"));
    for (name, _) in std::env::vars().filter(|(name, _)| name.starts_with("REVISIT_")) {
        command.env_remove(name);
    }
    let url = format!("sqlite://{}", database.display());
    let output =
        command.arg("keys").args(arguments).args(["--database", &url]).output().expect("the binary runs");
    assert!(output.status.success(), "{output:?}");
    String::from_utf8(output.stderr).expect("text")
}
