//! Bulk uploads: how long their key, their map and their place among the requests are theirs.

use std::time::Duration;

use reqwest::Method;
use serde_json::{Value, json};

use crate::raw::Connection;
use crate::support::{Answer, Server, keyframe};

const MAP: &str = "/v1/maps/m";

/// An upload that goes on for as long as its client likes.
struct Upload(Connection);

impl Upload {
    /// Begins one with a line.
    async fn begin(server: &Server, secret: Option<&str>, id: &str) -> Self {
        let mut connection = Connection::open(server.addr()).await;
        let key = secret.map_or_else(String::new, |secret| format!("authorization: Bearer {secret}\r\n"));
        let head = format!(
            "POST {MAP}/keyframes HTTP/1.1\r\nhost: localhost\r\n{key}connection: close\r\ntransfer-encoding: chunked\r\n\r\n"
        );
        connection.send(head).await;
        let mut upload = Self(connection);
        upload.line(id).await;
        upload
    }

    async fn line(&mut self, id: &str) {
        let mut item = keyframe();
        item["id"] = json!(id);
        let line = format!("{item}\n");
        self.0.send(format!("{:x}\r\n{line}\r\n", line.len())).await;
    }

    /// Ends it; what each line was answered.
    async fn end(mut self) -> Vec<Value> {
        self.0.send("0\r\n\r\n").await;
        let answer = self.0.rest().await;
        let (_, body) = answer.split_once("\r\n\r\n").expect("a head");
        body.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect()
    }
}

async fn ask(
    server: &Server,
    method: Method,
    path: &str,
    secret: Option<&str>,
    body: Option<Value>,
) -> Answer {
    let request = secret.into_iter().fold(server.request(method, path), reqwest::RequestBuilder::bearer_auth);
    Answer::of(body.iter().fold(request, reqwest::RequestBuilder::json)).await
}

async fn make_key(server: &Server, root: Option<&str>, body: Value) -> String {
    let made = ask(server, Method::POST, "/v1/keys", root, Some(body)).await.expect(201);
    made["secret"].as_str().expect("a secret").to_owned()
}

/// What comes in the middle of an upload.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Meanwhile {
    Nothing,
    Revoked,
    Expired,
    FirstKey,
    Deleted,
    Replaced,
}

#[tokio::test]
async fn an_upload_outlives_neither_its_key_nor_its_map() {
    let gone = [(201, "kf-1"), (404, "kf-2"), (404, "kf-3")];
    for (meanwhile, answered, stored) in [
        (
            Meanwhile::Nothing,
            &[(201, "kf-1"), (201, "kf-2"), (201, "kf-3")][..],
            Some(&["kf-1", "kf-2", "kf-3"][..]),
        ),
        // One line for all the rest, which nobody reads any more.
        (Meanwhile::Revoked, &[(201, "kf-1"), (401, "")], Some(&["kf-1"])),
        (Meanwhile::Expired, &[(201, "kf-1"), (401, "")], Some(&["kf-1"])),
        (Meanwhile::FirstKey, &[(201, "kf-1"), (401, "")], Some(&["kf-1"])),
        (Meanwhile::Deleted, &gone, None),
        (Meanwhile::Replaced, &gone, Some(&[])),
    ] {
        let server = Server::start().await;
        let (mut root, mut robot) = (None, None);
        if meanwhile != Meanwhile::FirstKey {
            root = Some(make_key(&server, None, json!({"actions": ["read", "write", "admin"]})).await);
            let mut body = json!({"actions": ["read", "write"]});
            if meanwhile == Meanwhile::Expired {
                let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).expect("a time");
                body["expires"] = json!({"sec": now.as_secs() + 2, "nanosec": 0});
            }
            robot = Some(make_key(&server, root.as_deref(), body).await);
        }
        let asked = async |method, path: &str, secret: &Option<String>, body| {
            ask(&server, method, path, secret.as_deref(), body).await
        };
        asked(Method::PUT, MAP, &root, Some(json!({}))).await.expect(201);
        let mut upload = Upload::begin(&server, robot.as_deref(), "kf-1").await;
        let first = format!("{MAP}/keyframes/kf-1");
        while asked(Method::GET, &first, &root, None).await.status != 200 {
            tokio::task::yield_now().await;
        }
        match meanwhile {
            Meanwhile::Nothing => {}
            Meanwhile::Revoked => {
                asked(Method::DELETE, "/v1/keys/key-2", &root, None).await.expect(204);
            }
            Meanwhile::Expired => {
                while asked(Method::GET, MAP, &robot, None).await.status == 200 {
                    tokio::task::yield_now().await;
                }
            }
            Meanwhile::FirstKey => {
                root = Some(make_key(&server, None, json!({"actions": ["read", "admin"]})).await);
            }
            Meanwhile::Deleted | Meanwhile::Replaced => {
                asked(Method::DELETE, MAP, &root, None).await.expect(204);
                if meanwhile == Meanwhile::Replaced {
                    asked(Method::PUT, MAP, &root, Some(json!({}))).await.expect(201);
                }
            }
        }
        upload.line("kf-2").await;
        upload.line("kf-3").await;
        let lines = upload.end().await;
        let told: Vec<_> = lines
            .iter()
            .map(|line| (line["status"].as_u64().unwrap_or(0), line["id"].as_str().unwrap_or("")))
            .collect();
        assert_eq!(told, answered, "{meanwhile:?}: {lines:#?}");
        let list = asked(Method::GET, &format!("{MAP}/keyframes"), &root, None).await;
        let Some(stored) = stored else {
            list.expect(404);
            continue;
        };
        let list = list.expect(200);
        let ids: Vec<_> = list["items"].as_array().expect("items").iter().map(|item| &item["id"]).collect();
        assert_eq!(ids, stored, "{meanwhile:?}");
    }
}

/// Waits until so many keyframes are stored, and nobody but who asks for the figures has a turn; the time only keeps a
/// failure from going on for ever.
async fn until_all_wait(server: &Server, stored: u64) {
    let names = ["revisit_keyframes", "revisit_requests_in_flight", "revisit_writes_under_way"];
    let mut figures = [0; 3];
    let rest = async {
        while figures[0] < stored || figures[1..] != [1, 0] {
            let metrics = Answer::text(server.request(Method::GET, "/metrics")).await;
            let figure = |name| {
                let line = metrics.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(' '));
                line.and_then(|figure| figure.parse().ok()).expect("a figure")
            };
            figures = names.map(figure);
        }
    };
    let rest = tokio::time::timeout(Duration::from_secs(20), rest).await;
    assert!(rest.is_ok(), "{names:?} are {figures:?}");
}

#[tokio::test]
async fn uploads_that_wait_for_their_keys_share_take_no_place_of_others() {
    let (server, _) = Server::within(&["--max-requests", "4"]).await;
    let root = make_key(&server, None, json!({"actions": ["read", "write", "admin"]})).await;
    let root = Some(root.as_str());
    ask(&server, Method::PUT, MAP, root, Some(json!({}))).await.expect(201);
    let mut uploads = Vec::new();
    for number in 0..4 {
        let slow = make_key(&server, root, json!({"actions": ["write"], "rate_per_s": 1})).await;
        let mut upload = Upload::begin(&server, Some(&slow), &format!("kf-{number}-0")).await;
        for line in 1..1000 {
            upload.line(&format!("kf-{number}-{line}")).await;
        }
        uploads.push(upload);
    }
    // Each has stored a line and waits for the next second.
    until_all_wait(&server, 4).await;
    ask(&server, Method::GET, MAP, root, None).await.expect(200);
    ask(&server, Method::PUT, &format!("{MAP}/keyframes/kf"), root, Some(keyframe())).await.expect(201);
}

#[tokio::test]
async fn an_upload_whose_client_is_silent_keeps_no_turn_to_write() {
    let server = Server::start().await;
    server.put(MAP, &json!({})).await.expect(201);
    let mut upload = Upload::begin(&server, None, "kf-1").await;
    upload.line("kf-2").await;
    until_all_wait(&server, 2).await;
    upload.line("kf-3").await;
    let statuses: Vec<_> = upload.end().await.iter().map(|line| line["status"].clone()).collect();
    assert_eq!(statuses, [201, 201, 201]);
}
