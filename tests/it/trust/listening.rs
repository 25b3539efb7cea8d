//! Where the server listens without keys, and where it does not.

use std::process::{Command, Stdio};

use reqwest::Method;
use serde_json::json;

use crate::support::{Answer, Server, keyframe};

#[test]
fn on_an_address_that_others_reach_the_first_start_refuses_and_says_how_to_make_a_key() {
    let directory = tempfile::tempdir().expect("a directory");
    let database = format!("sqlite://{}", directory.path().join("test.db").display());
    let serve = |listen: &str| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_revisit"));
        for (name, _) in std::env::vars().filter(|(name, _)| name.starts_with("REVISIT_")) {
            command.env_remove(name);
        }
        command.args(["serve", "--listen", listen, "--database", &database]);
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    };
    let refused = serve("0.0.0.0:0").output().expect("the binary runs");
    let said = String::from_utf8_lossy(&refused.stderr);
    assert!(!refused.status.success() && said.contains("revisit keys create"), "{said}");
    assert!(refused.stdout.is_empty(), "it never says that it listens");

    let create = Command::new(env!("CARGO_BIN_EXE_revisit"))
        .args(["keys", "create", "--actions", "read", "--database", &database])
        .output()
        .expect("the binary runs");
    assert!(create.status.success(), "{create:?}");
    let mut child = serve("0.0.0.0:0").spawn().expect("the binary runs");
    let mut line = String::new();
    let stdout = child.stdout.take().expect("piped");
    std::io::BufRead::read_line(&mut std::io::BufReader::new(stdout), &mut line).expect("text");
    let _ = child.kill();
    let _ = child.wait();
    assert!(line.starts_with("listening on http://0.0.0.0:"), "{line:?}");
}

#[tokio::test]
async fn without_keys_no_name_that_a_web_page_could_have_made_leads_here() {
    let server = Server::start().await;
    let ask = async |host: &str, secret: Option<&str>| {
        let request = server.request(Method::GET, "/v1/maps").header("host", host);
        let request = secret.into_iter().fold(request, reqwest::RequestBuilder::bearer_auth);
        Answer::of(request).await.status.as_u16()
    };
    for (host, status) in [
        ("127.0.0.1:7878", 200),
        ("[::1]:7878", 200),
        ("localhost", 200),
        ("robots.localhost:7878", 200),
        ("10.0.0.7", 200),
        ("evil.example", 403),
        ("evil.example:7878", 403),
        ("localhost.evil.example", 403),
        ("127.0.0.1.evil.example", 403),
    ] {
        assert_eq!(ask(host, None).await, status, "{host}");
    }
    let key = server.post("/v1/keys", &json!({"actions": ["read", "admin"]})).await.expect(201);
    assert_eq!(ask("maps.example", key["secret"].as_str()).await, 200, "a key is what counts");
}

#[tokio::test]
async fn without_keys_nothing_is_changed_for_a_web_page_from_elsewhere() {
    let server = Server::with_map("m").await;
    let own = server.url("");
    // As a browser sends a form or bytes without a type: it asks nobody first.
    let send = async |method: &Method, path: &str, headers: &[(&str, &str)]| {
        let request = server.request(method.clone(), path).body(keyframe().to_string());
        Answer::of(headers.iter().fold(request, |request, (name, value)| request.header(*name, *value))).await
    };
    let put = async |headers: &[(&str, &str)]| send(&Method::PUT, "/v1/maps/m/keyframes/kf-1", headers).await;
    for (headers, pointers) in [
        (&[("origin", "https://evil.example")][..], &["origin:"][..]),
        (&[("origin", "null")], &["origin:"]),
        (&[("origin", "")], &["origin:"]),
        (&[("origin", "http://127.0.0.1:1")], &["origin:"]),
        (&[("origin", "http://127.0.0.1")], &["origin:"]),
        (&[("origin", &own.replace("127.0.0.1", "localhost"))], &["origin:"]),
        (&[("origin", &own), ("origin", "https://evil.example")], &["origin:"]),
        (&[("sec-fetch-site", "cross-site")], &["sec-fetch-site:"]),
        (&[("sec-fetch-site", "same-site")], &["sec-fetch-site:"]),
        (&[("origin", &own), ("sec-fetch-site", "same-site")], &["sec-fetch-site:"]),
        (
            &[("origin", "https://evil.example"), ("sec-fetch-site", "cross-site")],
            &["origin:", "sec-fetch-site:"],
        ),
    ] {
        let refused = put(headers).await;
        assert_eq!((refused.status.as_u16(), refused.pointers().as_slice()), (403, pointers), "{headers:?}");
        assert_eq!(refused.header("content-type"), "application/problem+json", "{headers:?}");
    }
    server.get("/v1/maps/m/keyframes/kf-1").await.expect(404);

    let document = serde_json::to_value(revisit::http::document()).expect("JSON");
    for (path, item) in document["paths"].as_object().expect("paths") {
        for method in item.as_object().expect("operations").keys().filter(|method| *method != "get") {
            let method = Method::from_bytes(method.to_uppercase().as_bytes()).expect("a method");
            let refused = send(&method, path, &[("origin", "https://evil.example")]).await;
            assert_eq!(refused.status, 403, "{method} {path}: {refused:#?}");
        }
    }
    let reading = server.request(Method::GET, "/v1/maps").header("sec-fetch-site", "cross-site");
    Answer::of(reading).await.expect(200);

    // A robot, the viewer, and who typed the address.
    put(&[]).await.expect(201);
    put(&[("origin", &own), ("sec-fetch-site", "same-origin")]).await.expect(200);
    put(&[("sec-fetch-site", "none")]).await.expect(200);
    // Where a key is shown, it counts, and no page has it.
    let key = server.post("/v1/keys", &json!({"actions": ["write", "admin"]})).await.expect(201);
    let bearer = format!("Bearer {}", key["secret"].as_str().expect("a secret"));
    put(&[("origin", "https://robots.example"), ("authorization", &bearer)]).await.expect(200);
}
