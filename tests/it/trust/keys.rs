//! Keys: their life from the command line and over HTTP.

use std::path::Path;
use std::process::Output;

use reqwest::Method;
use serde_json::{Value, json};
use tokio::process::Command;

use crate::support::{Answer, Server, keyframe};

/// Runs `revisit keys`. The test's own server keeps running meanwhile: stopped within a transaction, it would lock
/// the database for as long as the command waits.
async fn revisit(database: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_revisit"));
    for (name, _) in std::env::vars().filter(|(name, _)| name.starts_with("REVISIT_")) {
        command.env_remove(name);
    }
    let url = format!("sqlite://{}", database.display());
    command.arg("keys").args(arguments).args(["--database", &url]).output().await.expect("the binary runs")
}

/// Makes a key on the command line; its secret is all that standard output says.
async fn create(database: &Path, arguments: &[&str]) -> String {
    let made = revisit(database, &[&["create"], arguments].concat()).await;
    assert!(made.status.success(), "{made:?}");
    String::from_utf8(made.stdout).expect("text").trim_end().to_owned()
}

async fn get(server: &Server, path: &str, secret: &str) -> Answer {
    Answer::of(server.request(Method::GET, path).bearer_auth(secret)).await
}

#[tokio::test]
async fn a_key_made_beside_a_running_server_opens_it_and_closes_it_to_everybody_else() {
    let directory = tempfile::tempdir().expect("a directory");
    let database = directory.path().join("test.db");
    let server = Server::on(directory.path()).await;
    server.get("/v1/maps").await.expect(200);

    let secret =
        create(&database, &["--name", "fleet", "--maps", "hotel-*,lobby", "--rate-per-s", "500"]).await;
    get(&server, "/v1/maps", &secret).await.expect(200);
    let refused = server.get("/v1/maps").await;
    assert_eq!(refused.header("www-authenticate"), "Bearer");
    refused.expect(401);

    let listed = String::from_utf8(revisit(&database, &["list"]).await.stdout).expect("text");
    assert!(listed.contains("key-1") && listed.contains("hotel-* lobby"), "{listed}");
    assert!(!listed.contains(&secret), "a secret is shown once");
    assert!(revisit(&database, &["revoke", "key-1"]).await.status.success());
    // The server glances at what other processes did; nothing opens it again.
    while get(&server, "/v1/maps", &secret).await.status != 401 {
        tokio::task::yield_now().await;
    }
    server.get("/v1/maps").await.expect(401);
    let unknown = revisit(&database, &["revoke", "key-9"]).await;
    assert!(
        !unknown.status.success() && String::from_utf8_lossy(&unknown.stderr).contains("key-9"),
        "{unknown:?}"
    );
    let elsewhere = revisit(&directory.path().join("none.db"), &["list"]).await;
    assert!(!elsewhere.status.success(), "{elsewhere:?}");
    assert!(!directory.path().join("none.db").exists(), "looking makes no database");
}

#[tokio::test]
async fn a_key_made_beside_a_running_server_opens_it_also_in_a_flood_of_nonsense() {
    let directory = tempfile::tempdir().expect("a directory");
    let database = directory.path().join("test.db");
    let server = Server::on(directory.path()).await;
    let flood = futures_util::future::join_all((0..100).map(async |_| {
        loop {
            get(&server, "/v1/maps", "nonsense").await.expect(401);
        }
    }));
    let made = async {
        let secret = create(&database, &["--actions", "read"]).await;
        while get(&server, "/v1/maps", &secret).await.status != 200 {
            tokio::task::yield_now().await;
        }
    };
    tokio::select! {
        _ = flood => unreachable!("it has no end"),
        () = made => {}
    }
}

#[tokio::test]
async fn keys_outlive_a_restart_and_no_secret_is_in_the_database() {
    let directory = tempfile::tempdir().expect("a directory");
    let database = directory.path().join("test.db");
    let secret = create(&database, &["--actions", "read,admin"]).await;
    let server = Server::on(directory.path()).await;
    let keys = get(&server, "/v1/keys", &secret).await.expect(200);
    assert_eq!(keys["items"][0]["actions"], json!(["read", "admin"]));
    server.stop().await;
    for file in std::fs::read_dir(directory.path()).expect("a directory") {
        let bytes = std::fs::read(file.expect("a file").path()).expect("bytes");
        let found = bytes.windows(secret.len()).any(|window| window == secret.as_bytes());
        assert!(!found, "the secret is on disk");
    }
}

#[tokio::test]
async fn keys_are_made_listed_and_revoked_over_http() {
    let server = Server::start().await;
    server.get("/v1/keys/me").await.expect(404);
    let body = json!({"name": "root", "actions": ["read", "write", "query", "admin"]});
    let root = server.post("/v1/keys", &body).await.expect(201);
    let secret = root["secret"].as_str().expect("a secret");
    let post = async |body: &Value| {
        Answer::of(server.request(Method::POST, "/v1/keys").bearer_auth(secret).json(body)).await
    };
    let full = json!({"name": "robots", "actions": ["read", "write"], "maps": ["tower", "tower-*"],
        "expires": {"sec": 4_000_000_000_i64, "nanosec": 5}, "rate_per_s": 7, "max_maps": 9, "max_bytes": 0, "model_daily_calls": 8,
        "model_daily_usd": 0.25});
    let mut made = post(&full).await.expect(201);
    let robots = made["secret"].take();
    assert_ne!(robots, root["secret"]);
    for (field, value) in full.as_object().expect("an object") {
        assert_eq!(made[field], *value, "{field}");
    }
    let listed = get(&server, "/v1/keys?limit=1", secret).await.expect(200);
    assert_eq!((&listed["items"][0]["id"], &listed["next_cursor"]), (&json!("key-1"), &json!("key-2")));
    let listed = get(&server, "/v1/keys?limit=1&cursor=key-2", secret).await.expect(200);
    assert_eq!((&listed["items"][0]["id"], &listed["next_cursor"]), (&json!("key-2"), &Value::Null));
    assert!(listed["items"][0].get("secret").is_none());

    for (body, pointers) in [
        (json!({}), &["/actions"][..]),
        (json!({"actions": []}), &["/actions"]),
        (json!({"actions": ["reed"]}), &["/actions/0"]),
        (json!({"actions": ["read"], "maps": []}), &["/maps"]),
        (json!({"actions": ["read"], "maps": ["a b", "c"]}), &["/maps/0"]),
        (json!({"actions": ["read", "admin"], "maps": ["tower"]}), &["/maps"]),
        (json!({"actions": ["read"], "expires": {"sec": 1, "nanosec": 0}}), &["/expires"]),
        (
            json!({"actions": ["read"], "rate_per_s": 0, "max_maps": -1, "max_bytes": 0.5, "model_daily_usd": -1}),
            &["/max_bytes", "/max_maps", "/model_daily_usd", "/rate_per_s"],
        ),
    ] {
        let refused = post(&body).await;
        let mut named = refused.pointers();
        named.sort_unstable();
        assert_eq!((refused.status.as_u16(), named.as_slice()), (422, pointers), "{body}");
    }

    let revoke = async |id: &str| {
        Answer::of(server.request(Method::DELETE, &format!("/v1/keys/{id}")).bearer_auth(secret)).await
    };
    let robots = robots.as_str().expect("a secret");
    let unused = get(&server, "/v1/keys?limit=1&cursor=key-2", secret).await.expect(200);
    assert!(unused["items"][0].get("last_used").is_none(), "{unused:#}");
    let maps = get(&server, "/v1/maps", robots).await.expect(200);
    assert_eq!(
        (&maps["items"], &maps["covered"]),
        (&json!([]), &full["maps"]),
        "an empty list says what it may hold"
    );
    assert!(get(&server, "/v1/maps", secret).await.expect(200).get("covered").is_none());
    let own = get(&server, "/v1/keys/me", robots).await.expect(200);
    assert_eq!(
        (&own["id"], &own["actions"], &own["maps"]),
        (&json!("key-2"), &full["actions"], &full["maps"])
    );
    let used = get(&server, "/v1/keys?limit=1&cursor=key-2", secret).await.expect(200);
    assert!(used["items"][0]["last_used"]["sec"].as_i64() > Some(1_700_000_000), "{used:#}");
    let metrics = Answer::text(server.request(Method::GET, "/metrics")).await;
    assert!(metrics.contains("revisit_key_requests_total{key=\"key-2\"} 2\n"), "{metrics}");
    revoke("key-2").await.expect(204);
    get(&server, "/v1/maps", robots).await.expect(401);
    revoke("key-2").await.expect(204);
    revoke("key-77").await.expect(404);
    revoke("nonsense").await.expect(404);
}

#[tokio::test]
async fn an_expired_key_is_no_key() {
    let server = Server::start().await;
    let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).expect("a time").as_secs();
    let expires = json!({"sec": now + 3, "nanosec": 0});
    let root = server.post("/v1/keys", &json!({"actions": ["admin"]})).await.expect(201);
    let root = root["secret"].as_str().expect("a secret");
    let body = json!({"actions": ["read"], "expires": expires});
    let made =
        Answer::of(server.request(Method::POST, "/v1/keys").bearer_auth(root).json(&body)).await.expect(201);
    let secret = made["secret"].as_str().expect("a secret");
    // It is good until then, and never after.
    while get(&server, "/v1/maps", secret).await.status == 200 {
        tokio::task::yield_now().await;
    }
    get(&server, "/v1/maps", secret).await.expect(401);
}

#[tokio::test]
async fn a_keyframe_with_its_loop_query_takes_both_actions() {
    let server = Server::start().await;
    let made = server.post("/v1/keys", &json!({"actions": ["write", "admin"]})).await.expect(201);
    let put = async |path: &str, body: &Value| {
        let secret = made["secret"].as_str().expect("a secret");
        Answer::of(server.request(Method::PUT, path).bearer_auth(secret).json(body)).await
    };
    put("/v1/maps/m", &json!({})).await.expect(201);
    put("/v1/maps/m/keyframes/k?query=loop", &keyframe()).await.expect(403);
    put("/v1/maps/m/keyframes/k", &keyframe()).await.expect(201);
}

#[tokio::test]
async fn a_malformed_authorization_is_no_key() {
    let server = Server::start().await;
    let made = server.post("/v1/keys", &json!({"actions": ["read", "admin"]})).await.expect(201);
    let secret = made["secret"].as_str().expect("a secret");
    for header in [
        String::new(),
        "Bearer".to_owned(),
        secret.to_owned(),
        format!("Basic {secret}"),
        format!("Bearer {secret} {secret}"),
        format!("Bearer {}", secret.to_uppercase()),
        format!("Bearer {}", &secret[..secret.len() - 1]),
    ] {
        let request = server.request(Method::GET, "/v1/maps").header("authorization", &header);
        assert_eq!(Answer::of(request).await.status, 401, "{header:?}");
    }
    let twice =
        server.request(Method::GET, "/v1/maps").bearer_auth(secret).header("authorization", "Bearer x");
    Answer::of(twice).await.expect(401);
    let scheme = server.request(Method::GET, "/v1/maps").header("authorization", format!("bearer  {secret}"));
    Answer::of(scheme).await.expect(200);
}

#[tokio::test]
async fn a_stream_of_events_ends_with_its_key() {
    let server = Server::with_map("m").await;
    let open = server.request(Method::GET, "/v1/maps/m/events").send().await.expect("an answer");
    assert_eq!(open.status(), 200);
    let body = json!({"actions": ["read", "admin"]});
    let root = server.post("/v1/keys", &body).await.expect(201);
    // There is a key now: who came without one has seen enough.
    open.text().await.expect("the stream ends");
    let root = root["secret"].as_str().expect("a secret");
    let listen = async |secret: &str| {
        let request = server.request(Method::GET, "/v1/maps/m/events").bearer_auth(secret);
        request.send().await.expect("an answer")
    };
    let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).expect("a time").as_secs();
    for (id, body) in [
        ("key-2", json!({"actions": ["read"]})),
        ("key-3", json!({"actions": ["read"], "expires": {"sec": now + 2, "nanosec": 0}})),
    ] {
        let made = Answer::of(server.request(Method::POST, "/v1/keys").bearer_auth(root).json(&body))
            .await
            .expect(201);
        let stream = listen(made["secret"].as_str().expect("a secret")).await;
        assert_eq!(stream.status(), 200);
        if id == "key-2" {
            let revoke = server.request(Method::DELETE, "/v1/keys/key-2").bearer_auth(root);
            Answer::of(revoke).await.expect(204);
        }
        stream.text().await.expect("the stream ends");
    }
}
