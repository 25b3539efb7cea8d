//! The authorisation matrix: every operation of the API document against every kind of key. A new operation is in it by
//! itself; one that says nothing of keys fails.

use reqwest::{Method, RequestBuilder};
use revisit::domain::key::Action;
use revisit::http::document;
use serde_json::{Value, json};

use crate::support::{Answer, Server, keyframe};

/// What an operation asks for.
#[derive(Clone, Copy)]
enum Needs {
    Nothing,
    AnyKey,
    KeyWith(Action),
}

/// An operation of the document.
struct Operation {
    method: Method,
    path: String,
    needs: Needs,
    media_type: Option<String>,
    example: Value,
}

fn operations() -> Vec<Operation> {
    let document = serde_json::to_value(document()).expect("JSON");
    let mut operations = Vec::new();
    for (path, item) in document["paths"].as_object().expect("paths") {
        for (method, operation) in item.as_object().expect("operations") {
            let security = operation["security"].as_array();
            let [requirement] = security.map(Vec::as_slice).unwrap_or_default() else {
                panic!("{method} {path} does not say who may do it: give it `security(..)`");
            };
            let needs = match requirement.get("key").map(|actions| actions[0].as_str()) {
                None => Needs::Nothing,
                Some(None) => Needs::AnyKey,
                Some(Some(name)) => {
                    let action = Action::from_name(name);
                    Needs::KeyWith(action.unwrap_or_else(|| panic!("{method} {path} asks for {name}")))
                }
            };
            let body =
                operation["requestBody"]["content"].as_object().and_then(|content| content.iter().next());
            operations.push(Operation {
                method: Method::from_bytes(method.to_uppercase().as_bytes()).expect("a method"),
                path: path.clone(),
                needs,
                media_type: body.map(|(media_type, _)| media_type.clone()),
                example: body.map(|(_, body)| body["example"].clone()).unwrap_or_default(),
            });
        }
    }
    operations
}

impl Operation {
    fn name(&self) -> String {
        format!("{} {}", self.method, self.path)
    }

    fn is_in_a_map(&self) -> bool {
        self.path.contains("{map}")
    }

    /// The request, about things that are there.
    fn request(&self, server: &Server, map: &str) -> RequestBuilder {
        let names = [
            ("map", map),
            ("keyframe", "kf-1"),
            ("anchor", "a-0"),
            ("loop", "loop-1"),
            ("query", "q-1"),
            ("id", "key-999"),
        ];
        let path = names
            .iter()
            .fold(self.path.clone(), |path, (name, value)| path.replace(&format!("{{{name}}}"), value));
        let request = server.request(self.method.clone(), &path);
        match &self.media_type {
            Some(media_type) => {
                let body = self.example.as_str().map_or_else(|| self.example.to_string(), str::to_owned);
                request.header("content-type", media_type).body(body)
            }
            None => request,
        }
    }

    /// What it is answered, without waiting for the end of a stream.
    async fn status(&self, server: &Server, map: &str, secret: Option<&str>) -> u16 {
        let request = self.request(server, map);
        let request = match secret {
            Some(secret) => request.bearer_auth(secret),
            None => request,
        };
        request.send().await.expect("an answer").status().as_u16()
    }
}

/// A key made by the administrator.
async fn key(server: &Server, admin: &str, body: Value) -> (String, String) {
    let made =
        Answer::of(server.request(Method::POST, "/v1/keys").bearer_auth(admin).json(&body)).await.expect(201);
    let text = |field: &str| made[field].as_str().expect("a text").to_owned();
    (text("id"), text("secret"))
}

async fn a_map_with_a_keyframe(server: &Server, admin: &str, map: &str) {
    let path = format!("/v1/maps/{map}");
    Answer::of(server.request(Method::PUT, &path).bearer_auth(admin).json(&json!({}))).await.expect(201);
    let mut body = keyframe();
    body["detections"] = json!([{"class": "door_number", "confidence": 0.9, "box": [0, 0, 9, 9], "position": [0, 0, 2],
        "text": "901"}]);
    let path = format!("{path}/keyframes/kf-1");
    Answer::of(server.request(Method::PUT, &path).bearer_auth(admin).json(&body)).await.expect(201);
}

#[tokio::test]
async fn every_operation_is_open_to_exactly_the_keys_that_may() {
    let server = Server::start().await;
    let everything = json!(Action::NAMES);
    let made = server.post("/v1/keys", &json!({"name": "root", "actions": everything})).await.expect(201);
    let admin = made["secret"].as_str().expect("a secret").to_owned();
    let (id, revoked) = key(&server, &admin, json!({"actions": everything})).await;
    let revoke = server.request(Method::DELETE, &format!("/v1/keys/{id}")).bearer_auth(&admin);
    Answer::of(revoke).await.expect(204);
    let mut of_action = Vec::new();
    for action in Action::ALL {
        let (_, here) = key(&server, &admin, json!({"actions": [action.as_str()]})).await;
        let others: Vec<&str> =
            Action::ALL.into_iter().filter(|other| *other != action).map(Action::as_str).collect();
        let (_, without) = key(&server, &admin, json!({"actions": others})).await;
        of_action.push((action, here, without));
    }
    // A key reaches maps by patterns; administrators reach all, so they have no "elsewhere".
    let (_, elsewhere) =
        key(&server, &admin, json!({"actions": ["read", "write", "query"], "maps": ["other-*"]})).await;

    let operations = operations();
    assert!(operations.len() > 30, "{}", operations.len());
    let mut cells = 0;
    for (number, operation) in operations.iter().enumerate() {
        let name = operation.name();
        let map = format!("map-{number}");
        a_map_with_a_keyframe(&server, &admin, &map).await;
        let ask = async |secret: Option<&str>| operation.status(&server, &map, secret).await;
        let nobody = [None, Some("revisit_unknown"), Some(""), Some(revoked.as_str())];
        for secret in nobody {
            let status = ask(secret).await;
            let is_anybodys = matches!(operation.needs, Needs::Nothing);
            assert!(
                if is_anybodys { status < 400 } else { status == 401 },
                "{name} with {secret:?}: {status}"
            );
            cells += 1;
        }
        let action = match operation.needs {
            Needs::Nothing => continue,
            Needs::AnyKey => {
                for (of, with, _) in &of_action {
                    assert_eq!(ask(Some(with)).await, 200, "{name} with {of:?} alone");
                    cells += 1;
                }
                continue;
            }
            Needs::KeyWith(action) => action,
        };
        let (_, with, without) = of_action.iter().find(|(of, ..)| *of == action).expect("a pair of keys");
        assert_eq!(ask(Some(without)).await, 403, "{name} without {action:?}");
        if operation.is_in_a_map() {
            assert_eq!(ask(Some(&elsewhere)).await, 404, "{name} for a key of other maps");
            let missing = operation.status(&server, "map-of-nobody", Some(&elsewhere)).await;
            assert_eq!(missing, 404, "{name}: a map that is there looks like one that is not");
            cells += 2;
        }
        let allowed = ask(Some(with)).await;
        assert!(![401, 403].contains(&allowed) && allowed < 500, "{name} with {action:?}: {allowed}");
        cells += 2;
    }
    println!("{cells} cells of {} operations", operations.len());
}

#[tokio::test]
async fn a_map_outside_a_keys_scope_is_answered_as_one_that_is_not_there() {
    let server = Server::start().await;
    let made = server.post("/v1/keys", &json!({"actions": Action::NAMES})).await.expect(201);
    let admin = made["secret"].as_str().expect("a secret").to_owned();
    let (_, ours) =
        key(&server, &admin, json!({"actions": ["read", "write"], "maps": ["ours-*", "b"]})).await;
    for map in ["a", "b", "ours-1", "ours-2", "theirs-1", "z"] {
        a_map_with_a_keyframe(&server, &admin, map).await;
    }
    let get = async |path: &str| {
        Answer::of(server.request(Method::GET, path).bearer_auth(&ours).header("x-request-id", "same")).await
    };
    let hidden = get("/v1/maps/theirs-1").await.expect(404).to_string();
    let missing = get("/v1/maps/theirs-9").await.expect(404).to_string();
    assert_eq!(hidden.replace("theirs-1", "theirs-9"), missing);
    assert!(hidden.contains("this key covers the maps `ours-*`, `b`; theirs-1 is none of them"), "{hidden}");

    let mut seen = Vec::new();
    let mut cursor = String::new();
    loop {
        let part = get(&format!("/v1/maps?limit=1{cursor}")).await.expect(200);
        seen.extend(part["items"].as_array().expect("items").iter().map(|map| map["id"].clone()));
        let Some(next) = part["next_cursor"].as_str() else { break };
        cursor = format!("&cursor={next}");
    }
    assert_eq!(seen, ["b", "ours-1", "ours-2"]);
}

#[tokio::test]
async fn a_key_that_may_write_and_not_read_copies_no_map() {
    let server = Server::start().await;
    let made = server.post("/v1/keys", &json!({"actions": Action::NAMES})).await.expect(201);
    let admin = made["secret"].as_str().expect("a secret").to_owned();
    a_map_with_a_keyframe(&server, &admin, "lab").await;
    for (actions, status) in [(json!(["write"]), 403), (json!(["read", "write"]), 201)] {
        let body = json!({"name": "copier", "actions": actions, "maps": ["*"]});
        let (_, secret) = key(&server, &admin, body).await;
        let path = format!("/v1/maps/copy-{status}");
        let copy =
            server.request(Method::PUT, &path).bearer_auth(&secret).json(&json!({"base": {"map": "lab"}}));
        Answer::of(copy).await.expect(status);
    }
}
