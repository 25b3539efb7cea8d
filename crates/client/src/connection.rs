//! Connection: one request and its answer over plain HTTP, with retries where a server is busy.

use std::ops::ControlFlow;
use std::time::Duration;

use bytes::Bytes;
use reqwest::header::{CONTENT_TYPE, HeaderName, IF_MATCH, RETRY_AFTER};
use reqwest::{Method, RequestBuilder, Response, StatusCode};
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::address;
use super::error::{ClientError, Problem};

/// A connection is refused or made within this time.
const CONNECT_TIMEOUT: Duration = Duration::from_secs(10);
/// An answer comes within this time; a loop query that waits for a model has its own bound below it.
const ANSWER_TIMEOUT: Duration = Duration::from_mins(5);
/// A server that says "busy" (429, 503) is asked this often in all.
pub(super) const BUSY_ATTEMPTS: u32 = 5;
/// A longer `retry-after` is not waited for: the caller decides.
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
    /// Returns a client of the server at `base_url` (`http://host:port`, with or without a path prefix).
    ///
    /// Proxies named in the environment are not used: a robot talks to its own server.
    pub fn new(base_url: &str) -> Result<Self, ClientError> {
        let base_url = address::base_url(base_url)?;
        let http = crate::tls::client_for(&base_url)
            .connect_timeout(CONNECT_TIMEOUT)
            .timeout(ANSWER_TIMEOUT)
            .redirect(reqwest::redirect::Policy::none())
            .no_proxy()
            .user_agent(concat!("revisit/", env!("CARGO_PKG_VERSION")))
            .build()
            .map_err(|source| ClientError::transport("the HTTP client", source))?;
        Ok(Self { http, base_url, key: None })
    }

    /// Returns the same client, showing an API key, if there is one, as `authorization: Bearer ...`.
    pub fn with_key(self, key: impl Into<Option<String>>) -> Self {
        Self { key: key.into(), ..self }
    }

    /// Returns the server's address, without a slash at the end.
    pub fn base_url(&self) -> &str {
        &self.base_url
    }

    /// GET of a resource by its path, such as `["v1", "maps", map]`.
    pub(super) async fn read<T: DeserializeOwned>(
        &self,
        path: &[&str],
        query: &[(&str, String)],
    ) -> Result<T, ClientError> {
        self.ask(Method::GET, path, query).await?.decode()
    }

    /// Sends a request without a body.
    pub(super) async fn ask(
        &self,
        method: Method,
        path: &[&str],
        query: &[(&str, String)],
    ) -> Result<Answer, ClientError> {
        self.send(method, path, query, None::<&()>).await
    }

    /// Sends a body, and says whether the same was written before.
    pub(super) async fn write<T: DeserializeOwned>(
        &self,
        method: Method,
        path: &[&str],
        query: &[(&str, String)],
        body: &impl Serialize,
    ) -> Result<Written<T>, ClientError> {
        let answer = self.send(method, path, query, Some(body)).await?;
        Ok(Written { replayed: answer.replayed, answer: answer.decode()? })
    }

    /// Sends one line of JSON for each item, and reads the lines of the answer. A busy server is not asked again.
    pub(super) async fn write_lines<T: DeserializeOwned>(
        &self,
        path: &[&str],
        items: &[impl Serialize],
    ) -> Result<Vec<T>, ClientError> {
        let url = address::url(&self.base_url, path, &[])?;
        let mut body = Vec::new();
        for item in items {
            serde_json::to_writer(&mut body, item).map_err(|error| ClientError::Write(error.into()))?;
            body.push(b'\n');
        }
        let request = self.request(Method::POST, &url, None::<&()>);
        let request = request.header(CONTENT_TYPE, "application/x-ndjson").body(body);
        let response = request.send().await.map_err(|source| ClientError::transport(&url, source))?;
        let answer = Answer::read(url.clone(), response).await?;
        let lines = answer.body.split(|byte| *byte == b'\n').filter(|line| !line.is_empty());
        lines.map(|line| decode(&url, line)).collect()
    }

    /// Reads a resource that may be larger than memory; `take` receives it piece by piece, until it breaks.
    pub(super) async fn pieces(
        &self,
        path: &[&str],
        query: &[(&str, String)],
        timeout: Duration,
        mut take: impl FnMut(&str, &[u8]) -> Result<ControlFlow<()>, ClientError>,
    ) -> Result<(), ClientError> {
        let url = address::url(&self.base_url, path, query)?;
        let failed = |source| ClientError::transport(&url, source);
        let request = self.request(Method::GET, &url, None::<&()>).timeout(timeout);
        let mut response = request.send().await.map_err(failed)?;
        if !response.status().is_success() {
            return Answer::read(url, response).await.map(drop);
        }
        while let Some(piece) = response.chunk().await.map_err(failed)? {
            if take(&url, &piece)?.is_break() {
                break;
            }
        }
        Ok(())
    }

    /// Sends one request and returns its answer; a busy server that names a time is asked again then.
    ///
    /// Asking again is harmless: every write carries an id, and a refused one did nothing.
    async fn send<B: Serialize>(
        &self,
        method: Method,
        path: &[&str],
        query: &[(&str, String)],
        body: Option<&B>,
    ) -> Result<Answer, ClientError> {
        let url = address::url(&self.base_url, path, query)?;
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

    fn request<B: Serialize>(&self, method: Method, url: &str, body: Option<&B>) -> RequestBuilder {
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

/// Returns how long a busy server wants the client to wait, if it says so and the wait is bearable.
fn busy_for(response: &Response) -> Option<Duration> {
    let busy = [StatusCode::TOO_MANY_REQUESTS, StatusCode::SERVICE_UNAVAILABLE];
    if !busy.contains(&response.status()) {
        return None;
    }
    let seconds = response.headers().get(RETRY_AFTER)?.to_str().ok()?;
    let seconds: u64 = seconds.trim().parse().ok()?;
    (seconds <= LONGEST_RETRY_AFTER_S).then(|| Duration::from_secs(seconds))
}

/// An answer to a write.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Written<T> {
    /// The answer.
    pub answer: T,
    /// Whether the same was written before, and nothing changed.
    pub replayed: bool,
}

/// The answer to a request that was not refused.
pub(super) struct Answer {
    url: String,
    replayed: bool,
    body: Bytes,
}

impl Answer {
    async fn read(url: String, response: Response) -> Result<Self, ClientError> {
        let status = response.status();
        let replayed = response.headers().contains_key(IDEMPOTENT_REPLAYED);
        let body = response.bytes().await.map_err(|source| ClientError::transport(&url, source))?;
        if !status.is_success() {
            return Err(Box::new(Problem::read(status, &url, &body)).into());
        }
        Ok(Self { url, replayed, body })
    }

    /// Returns the body as text; bytes that are not UTF-8 are replaced.
    pub(super) fn text(&self) -> String {
        String::from_utf8_lossy(&self.body).into_owned()
    }

    pub(super) fn decode<T: DeserializeOwned>(&self) -> Result<T, ClientError> {
        decode(&self.url, &self.body)
    }

    /// Returns the body as it came.
    pub(super) fn bytes(self) -> Bytes {
        self.body
    }
}

/// Reads an answer, and says where it is not what the API document promises.
pub(super) fn decode<T: DeserializeOwned>(url: &str, body: &[u8]) -> Result<T, ClientError> {
    let mut json = serde_json::Deserializer::from_slice(body);
    serde_path_to_error::deserialize(&mut json)
        .map_err(|source| ClientError::Decode { url: url.to_owned(), source })
}
