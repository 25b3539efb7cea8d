//! Client: the API over plain HTTP, typed, for whatever of ours talks to a server.
//!
//! | file | concept |
//! |---|---|
//! | `address` | ids and queries become URLs |
//! | `operations` | one function per operation of the API |
//! | `answers` | the fields of the answers that a client uses |
//! | `error` | what can go wrong, said in one line each |

mod address;
mod answers;
mod error;
mod operations;
#[cfg(test)]
mod tests;

use std::time::Duration;

use reqwest::header::{HeaderName, IF_MATCH, RETRY_AFTER};
use reqwest::{Method, RequestBuilder, Response, StatusCode};
use serde::de::DeserializeOwned;
use serde_json::Value;

pub use answers::{
    AnchorContradiction, AnchorFigures, AnchorMatch, BowFigures, Candidate, CandidateVerdict, ClosedLoop,
    DetectionAnswer, GeometryFigures, KeyframeAnswer, LoopAnswer, MapAnswer, Merged, Reason, StoredKeyframe,
    Verdict,
};
pub use error::{ClientError, FieldProblem, Problem};

/// A connection is refused or made within this time.
const CONNECT_TIMEOUT: Duration = Duration::from_secs(10);
/// An answer comes within this time; a loop query that waits for a model has its own bound below it.
const ANSWER_TIMEOUT: Duration = Duration::from_mins(5);
/// A server that says "busy" (429, 503) is asked this often in all.
const BUSY_ATTEMPTS: u32 = 5;
/// A `retry-after` above this is not waited for: the caller decides.
const LONGEST_RETRY_AFTER_S: u64 = 30;

const IDEMPOTENT_REPLAYED: HeaderName = HeaderName::from_static("idempotent-replayed");

/// A server, the connections kept open to it, and the key shown to it.
///
/// Cloning is cheap and shares the connections.
#[derive(Clone, Debug)]
pub struct Client {
    http: reqwest::Client,
    base_url: String,
    key: Option<String>,
}

impl Client {
    /// A client of the server at `base_url` (`http://host:port`, with or without a path prefix).
    ///
    /// Proxies named in the environment are not used: a robot talks to its own server.
    pub fn new(base_url: &str) -> Result<Self, ClientError> {
        let base_url = address::base_url(base_url)?;
        let http = crate::config::tls::client_for(&base_url)
            .connect_timeout(CONNECT_TIMEOUT)
            .timeout(ANSWER_TIMEOUT)
            .redirect(reqwest::redirect::Policy::none())
            .no_proxy()
            .user_agent(concat!("revisit/", env!("CARGO_PKG_VERSION")))
            .build()
            .map_err(|source| ClientError::transport("the HTTP client", source))?;
        Ok(Self { http, base_url, key: None })
    }

    /// The same client, showing an API key as `authorization: Bearer ...`.
    pub fn with_key(mut self, key: impl Into<String>) -> Self {
        self.key = Some(key.into());
        self
    }

    /// The server's address, without a slash at the end.
    pub fn base_url(&self) -> &str {
        &self.base_url
    }

    /// GET of any resource, for what has no function of its own:
    /// `client.get(&["v1", "maps", map, "anchors"], &[("state", "valid")])`.
    pub async fn get<T: DeserializeOwned>(
        &self,
        path: &[&str],
        query: &[(&str, &str)],
    ) -> Result<T, ClientError> {
        let url = address::url(&self.base_url, path, query)?;
        self.send(Method::GET, url, None).await?.decode()
    }

    /// One request and its answer; a server that says when to come back is obeyed.
    ///
    /// Asking again is harmless: every write carries an id, and a refused one did nothing.
    async fn send(&self, method: Method, url: String, body: Option<&Value>) -> Result<Answer, ClientError> {
        let mut attempt = 1;
        loop {
            let response = self
                .request(method.clone(), &url, body)
                .send()
                .await
                .map_err(|source| ClientError::transport(&url, source))?;
            match busy_for(&response) {
                Some(wait) if attempt < BUSY_ATTEMPTS => tokio::time::sleep(wait).await,
                _ => return Answer::read(url, response).await,
            }
            attempt += 1;
        }
    }

    fn request(&self, method: Method, url: &str, body: Option<&Value>) -> RequestBuilder {
        let is_patch = method == Method::PATCH;
        let mut request = self.http.request(method, url);
        if is_patch {
            // Whatever version there is: a program that plays changes has seen none.
            request = request.header(IF_MATCH, "*");
        }
        if let Some(key) = &self.key {
            request = request.bearer_auth(key);
        }
        match body {
            Some(body) => request.json(body),
            None => request,
        }
    }
}

/// How long a busy server asks to be left alone, if it asks and the wait is bearable.
fn busy_for(response: &Response) -> Option<Duration> {
    let busy = [StatusCode::TOO_MANY_REQUESTS, StatusCode::SERVICE_UNAVAILABLE];
    if !busy.contains(&response.status()) {
        return None;
    }
    let seconds = response.headers().get(RETRY_AFTER)?.to_str().ok()?;
    let seconds: u64 = seconds.trim().parse().ok()?;
    (seconds <= LONGEST_RETRY_AFTER_S).then(|| Duration::from_secs(seconds))
}

/// The answer to a request that was not refused.
struct Answer {
    url: String,
    replayed: bool,
    body: bytes::Bytes,
}

impl Answer {
    async fn read(url: String, response: Response) -> Result<Self, ClientError> {
        let status = response.status();
        let replayed = response.headers().contains_key(IDEMPOTENT_REPLAYED);
        let body = response.bytes().await.map_err(|source| ClientError::transport(&url, source))?;
        if !status.is_success() {
            return Err(Problem::read(status, &url, &body).into());
        }
        Ok(Self { url, replayed, body })
    }

    fn decode<T: DeserializeOwned>(&self) -> Result<T, ClientError> {
        let mut json = serde_json::Deserializer::from_slice(&self.body);
        serde_path_to_error::deserialize(&mut json)
            .map_err(|source| ClientError::Decode { url: self.url.clone(), source })
    }
}
