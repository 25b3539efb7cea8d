//! Stub: a chat-completions server in this process that answers by a function and keeps a journal.

use std::net::SocketAddr;
use std::sync::{Arc, Mutex};

use axum::Router;
use axum::body::{Body, Bytes};
use axum::extract::State;
use axum::http::HeaderMap;
use axum::response::Response;
use revisit::config::models::ModelArgs;
use revisit::engine::ModelChoice;
use serde_json::{Value, json};
use tokio::net::TcpListener;

/// What a stub was asked.
#[derive(Clone, Debug)]
pub struct Asked {
    /// `similarity`, `information`, `merge`, `look`, `next`, `summary` or `embed`.
    pub what: &'static str,
    /// The data of the question, where it is JSON; else the words.
    pub data: Value,
    pub body: Value,
    pub headers: HeaderMap,
}

/// What a stub does.
#[derive(Clone, Debug)]
pub enum Reply {
    /// A completion with this content.
    Say(String),
    /// These bytes under this status.
    Raw { status: u16, headers: Vec<(&'static str, &'static str)>, body: String },
    /// This, once it is let go.
    After(Arc<tokio::sync::Notify>, String),
    /// Nothing, for ever.
    Hang,
    /// Half an answer, and the connection is gone.
    Drop,
}

type Script = dyn Fn(&Asked) -> Reply + Send + Sync;

/// A stub; it stops with the test's runtime.
#[derive(Clone)]
pub struct Stub {
    address: SocketAddr,
    shared: Arc<Shared>,
}

struct Shared {
    script: Mutex<Arc<Script>>,
    journal: Mutex<Vec<Asked>>,
}

impl Stub {
    pub async fn start(script: impl Fn(&Asked) -> Reply + Send + Sync + 'static) -> Self {
        let shared = Arc::new(Shared { script: Mutex::new(Arc::new(script)), journal: Mutex::default() });
        let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
        let address = listener.local_addr().unwrap();
        let router = Router::new().fallback(answer).with_state(shared.clone());
        tokio::spawn(async move { axum::serve(listener, router).await });
        Self { address, shared }
    }

    /// From now on it answers so.
    pub fn script(&self, script: impl Fn(&Asked) -> Reply + Send + Sync + 'static) {
        *self.shared.script.lock().unwrap() = Arc::new(script);
    }

    /// All it was asked.
    pub fn journal(&self) -> Vec<Asked> {
        self.shared.journal.lock().unwrap().clone()
    }

    pub fn calls(&self) -> usize {
        self.shared.journal.lock().unwrap().len()
    }

    pub fn url(&self) -> String {
        format!("http://{}/v1", self.address)
    }

    /// Flags that make a server ask this stub, impatiently.
    pub fn args(&self, more: &[&str]) -> ModelArgs {
        let url = self.url();
        let usual = [
            "--model-url",
            &url,
            "--model-name",
            "stub",
            "--model-retry-delay-ms",
            "1",
            "--model-breaker-pause-ms",
            "20",
            "--model-text-timeout-ms",
            "20000",
            "--model-client-timeout-ms",
            "20000",
        ];
        let usual = usual.chunks(2).filter(|flag| !more.contains(&flag[0])).flatten();
        let flags: Vec<&str> = usual.chain(more).copied().collect();
        ModelArgs::of(&flags).unwrap()
    }

    pub fn choice(&self, more: &[&str]) -> ModelChoice {
        ModelChoice::Configured(Box::new(self.args(more)))
    }
}

async fn answer(State(shared): State<Arc<Shared>>, headers: HeaderMap, body: Bytes) -> Response {
    let body: Value = serde_json::from_slice(&body).unwrap();
    let asked = understood(body, headers);
    let script = shared.script.lock().unwrap().clone();
    shared.journal.lock().unwrap().push(asked.clone());
    match script(&asked) {
        Reply::Say(content) => json_answer(200, &[], completion(&content).to_string()),
        Reply::Raw { status, headers, body } => json_answer(status, &headers, body),
        Reply::After(gate, content) => {
            gate.notified().await;
            json_answer(200, &[], completion(&content).to_string())
        }
        Reply::Hang => std::future::pending().await,
        Reply::Drop => {
            let torn = async_stream::stream! {
                yield Ok::<_, std::io::Error>(Bytes::from_static(b"{\"choices\": [{\"mess"));
                yield Err(std::io::Error::other("gone"));
            };
            Response::builder()
                .header("content-type", "application/json")
                .body(Body::from_stream(torn))
                .unwrap()
        }
    }
}

fn json_answer(status: u16, headers: &[(&str, &str)], body: String) -> Response {
    let typed = headers.iter().any(|(name, _)| *name == "content-type");
    let mut response = Response::builder().status(status);
    if !typed {
        response = response.header("content-type", "application/json");
    }
    let response = headers.iter().fold(response, |response, (name, value)| response.header(*name, *value));
    response.body(Body::from(body)).unwrap()
}

/// A completion as servers write it.
pub fn completion(content: &str) -> Value {
    json!({
        "id": "c-1", "object": "chat.completion", "created": 1, "model": "stub",
        "choices": [{
            "index": 0, "finish_reason": "stop",
            "message": {"role": "assistant", "content": content, "refusal": null}
        }],
        "usage": {"prompt_tokens": 100, "completion_tokens": 10, "total_tokens": 110}
    })
}

/// A completion that gives a level.
pub fn level(level: u8) -> Reply {
    Reply::Say(json!({"reason": "so it was told", "level": level}).to_string())
}

fn understood(body: Value, headers: HeaderMap) -> Asked {
    let messages = body["messages"].as_array().cloned().unwrap_or_default();
    let user = messages.last().map(|message| message["content"].clone()).unwrap_or_default();
    let rules = body.pointer("/messages/0/content").and_then(Value::as_str).unwrap_or_default().to_owned();
    let seen = user.as_array().and_then(|parts| parts[0]["text"].as_str());
    let text = seen.or(user.as_str()).unwrap_or_default();
    let data = serde_json::from_str(text).unwrap_or_else(|_| json!(text));
    let schema = body.pointer("/response_format/json_schema/name").and_then(Value::as_str);
    let what = match (seen, schema) {
        _ if body.get("input").is_some() => "embed",
        (Some(_), _) => "look",
        (_, Some("level")) if data.get("a").is_some() => "similarity",
        (_, Some("level")) => "information",
        (_, Some("text")) => "merge",
        _ if rules.contains("Ask one short question") => "next",
        _ => "summary",
    };
    Asked { what, data, body, headers }
}
