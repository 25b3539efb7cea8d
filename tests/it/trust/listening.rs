//! Where the server listens without keys, and where it does not.

use std::process::{Command, Stdio};

use reqwest::Method;
use serde_json::json;

use crate::support::{Answer, Server};

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
    let key = server.post("/v1/keys", &json!({"actions": ["read"]})).await.expect(201);
    assert_eq!(ask("maps.example", key["secret"].as_str()).await, 200, "a key is what counts");
}
