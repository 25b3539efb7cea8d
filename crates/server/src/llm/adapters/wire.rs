//! HTTP client of the models: one POST of JSON to a configured address, without redirects or proxies, with bounded
//! answers.

use std::time::Duration;

use reqwest::header::{CONTENT_TYPE, RETRY_AFTER};
use reqwest::{Response, StatusCode, Url};
use secrecy::{ExposeSecret as _, SecretString};
use serde_json::Value;
use thiserror::Error;

use crate::config::tls;
use crate::llm::port::Fault;

/// Maximum length of an answer, in bytes.
const ANSWER_BYTES_MAX: usize = 1 << 20;

/// A server that requests a longer pause counts as unavailable.
const RETRY_AFTER_MAX: Duration = Duration::from_hours(1);

/// The reason why an address cannot be used.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum EndpointError {
    /// It is not an address.
    #[error("{0} is no http or https address")]
    Address(String),
    /// It contains credentials, which would end up in logs.
    #[error("a model's address must not contain a name or a password; use REVISIT_MODEL_KEY")]
    Credentials,
    /// The HTTP client cannot be created.
    #[error("the HTTP client: {0}")]
    Client(String),
}

/// A model's address and key.
#[derive(Clone, Debug)]
pub struct Endpoint {
    http: reqwest::Client,
    url: Url,
    key: Option<SecretString>,
}

impl Endpoint {
    /// Returns an address with a path below it, such as `chat/completions`; empty for the address itself.
    pub fn new(
        base: &str,
        path: &str,
        key: Option<SecretString>,
        connect_timeout: Duration,
    ) -> Result<Self, EndpointError> {
        let no_address = || EndpointError::Address(base.chars().take(100).collect());
        let mut url = Url::parse(base).map_err(|_| no_address())?;
        if !url.username().is_empty() || url.password().is_some() {
            return Err(EndpointError::Credentials);
        }
        if !matches!(url.scheme(), "http" | "https") || url.host_str().is_none() {
            return Err(no_address());
        }
        if !path.is_empty() && !url.path().ends_with(path) {
            let joined = format!("{}/{path}", url.path().trim_end_matches('/'));
            url.set_path(&joined);
        }
        let http = tls::client_for(url.as_str())
            .connect_timeout(connect_timeout)
            .redirect(reqwest::redirect::Policy::none())
            .no_proxy()
            .user_agent(concat!("revisit/", env!("CARGO_PKG_VERSION")))
            .build()
            .map_err(|error| EndpointError::Client(tls::cause_of(&error)))?;
        Ok(Self { http, url, key })
    }

    /// Returns the address, without query, for keys of the cache.
    pub fn identity(&self) -> String {
        let mut url = self.url.clone();
        url.set_query(None);
        url.to_string()
    }

    /// Sends a body and reads the answer as JSON.
    pub async fn post(&self, body: &Value) -> Result<Value, Fault> {
        let mut request = self.http.post(self.url.clone()).json(body);
        if let Some(key) = &self.key {
            request = request.bearer_auth(key.expose_secret());
        }
        let response = request.send().await.map_err(unreachable)?;
        refuse_failures(&response)?;
        let media_type = response.headers().get(CONTENT_TYPE).and_then(|value| value.to_str().ok());
        if !media_type.is_some_and(|media_type| media_type.contains("json")) {
            return Err(Fault::Garbled("no JSON"));
        }
        serde_json::from_slice(&bounded(response).await?).map_err(|_| Fault::Garbled("broken JSON"))
    }
}

fn refuse_failures(response: &Response) -> Result<(), Fault> {
    let status = response.status();
    match status {
        StatusCode::OK | StatusCode::CREATED => Ok(()),
        StatusCode::TOO_MANY_REQUESTS => Err(Fault::Limited { retry_after: retry_after(response) }),
        StatusCode::REQUEST_TIMEOUT | StatusCode::TOO_EARLY | StatusCode::CONFLICT => {
            Err(Fault::Failing(status.as_u16()))
        }
        // A busy server may also state when to retry.
        StatusCode::SERVICE_UNAVAILABLE if retry_after(response).is_some() => {
            Err(Fault::Limited { retry_after: retry_after(response) })
        }
        status if status.is_server_error() => Err(Fault::Failing(status.as_u16())),
        // Redirects, too: questions are sent to the configured host only.
        status => Err(Fault::Refused(status.as_u16())),
    }
}

/// Parses seconds; the rare date format is ignored, and the delay between retries applies.
fn retry_after(response: &Response) -> Option<Duration> {
    let seconds: f64 = response.headers().get(RETRY_AFTER)?.to_str().ok()?.trim().parse().ok()?;
    (seconds >= 0.0).then(|| Duration::from_secs_f64(seconds.min(RETRY_AFTER_MAX.as_secs_f64())))
}

async fn bounded(mut response: Response) -> Result<Vec<u8>, Fault> {
    let mut body = Vec::new();
    while let Some(chunk) = response.chunk().await.map_err(unreachable)? {
        if body.len() + chunk.len() > ANSWER_BYTES_MAX {
            return Err(Fault::Garbled("an answer that is too long"));
        }
        body.extend_from_slice(&chunk);
    }
    Ok(body)
}

fn unreachable(error: reqwest::Error) -> Fault {
    let what = match () {
        () if error.is_timeout() => "the connection took too long",
        () if error.is_connect() => "no connection",
        () if error.is_body() || error.is_decode() => "the connection broke within the answer",
        () => "the connection broke",
    };
    Fault::Unreachable(what.to_owned())
}
