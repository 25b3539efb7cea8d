//! Envelope: adds the request id to every response, and writes every error as a problem document.

use std::any::Any;
use std::fmt;
use std::hash::{BuildHasher, Hasher, RandomState};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, LazyLock};
use std::time::Instant;

use axum::body::Body;
use axum::extract::{MatchedPath, Request};
use axum::http::header::{AUTHORIZATION, CONTENT_LENGTH, CONTENT_TYPE, X_CONTENT_TYPE_OPTIONS};
use axum::http::{HeaderName, HeaderValue, Method, Uri};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};

use tracing::Instrument as _;
use tracing::field::Empty;

use super::problem::{Kind, Problem};
use crate::config::traces;
use crate::domain::ids::KeyframeId;

/// The header with a request's id.
pub const REQUEST_ID: HeaderName = HeaderName::from_static("x-request-id");
/// The media type of problem documents.
pub const PROBLEM_JSON: HeaderValue = HeaderValue::from_static("application/problem+json");

/// Keeps browsers from guessing the type of a response.
pub const NO_SNIFF: HeaderValue = HeaderValue::from_static("nosniff");

/// The target of the access log.
const ACCESS: &str = "revisit::access";

/// A request's id, in the request's extensions.
#[derive(Clone, Debug)]
pub struct RequestId(Arc<str>);

impl fmt::Display for RequestId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// Marks an answer that another server of the same database gave: its errors are problem documents already.
#[derive(Clone, Copy, Debug)]
pub struct OfPeer;

/// Returns the pattern of a request's route, never its path: there are as many paths as keyframes.
pub fn route_of(request: &Request) -> &str {
    request.extensions().get::<MatchedPath>().map_or("unmatched", MatchedPath::as_str)
}

/// Middleware around all other layers. Log lines inside it belong to the request's span, which has its id.
pub async fn envelope(mut request: Request, next: Next) -> Response {
    let started = Instant::now();
    let id = RequestId::of(&request);
    request.extensions_mut().insert(id.clone());
    // Marked sensitive, so that printed headers never show a key.
    if let Some(key) = request.headers_mut().get_mut(AUTHORIZATION) {
        key.set_sensitive(true);
    }
    let (method, uri) = (request.method().clone(), request.uri().clone());
    let header = |name: &str| Some(request.headers().get(name)?.to_str().ok()?.to_owned());
    let trace = traces::request_span(&id.0, method.as_str(), route_of(&request), header);
    // At error level, because the span must exist even if only errors are logged.
    let log = || tracing::error_span!("request", request_id = %id, %method, route = %route_of(&request), key = Empty);
    let span = trace.in_scope(log);
    let mut response = next.run(request).instrument(span.clone()).instrument(trace.clone()).await;
    let _entered = span.enter();
    let is_error = response.status().is_client_error() || response.status().is_server_error();
    if is_error && response.extensions_mut().remove::<OfPeer>().is_none() {
        response = refusal(response, &id, &uri);
    }
    let status = response.status().as_u16();
    traces::answered(&trace, status);
    let duration_ms = started.elapsed().as_secs_f64() * 1e3;
    tracing::debug!(target: ACCESS, status, duration_ms, "answered");
    if let Ok(value) = HeaderValue::from_str(&id.0) {
        response.headers_mut().insert(REQUEST_ID, value);
    }
    // A crop is untrusted content: a browser must not guess another type for it.
    response.headers_mut().insert(X_CONTENT_TYPE_OPTIONS, NO_SNIFF);
    response
}

impl RequestId {
    /// Returns the client's own id if it is valid, because it is logged.
    fn of(request: &Request) -> Self {
        let given = request.headers().get(REQUEST_ID).and_then(|value| value.to_str().ok());
        match given.map(str::parse::<KeyframeId>) {
            Some(Ok(sane)) => Self(sane.as_str().into()),
            _ => Self::next(),
        }
    }

    /// Returns a random number of this process and a counter.
    pub(super) fn next() -> Self {
        static PROCESS: LazyLock<u64> = LazyLock::new(|| RandomState::new().build_hasher().finish());
        static COUNT: AtomicU64 = AtomicU64::new(1);
        let count = COUNT.fetch_add(1, Ordering::Relaxed);
        Self(format!("{:016x}-{count:x}", *PROCESS).into())
    }
}

/// Writes the problem document. Errors of axum or tower-http become one here and keep their headers (`allow`).
fn refusal(response: Response, id: &RequestId, uri: &Uri) -> Response {
    let (mut parts, _) = response.into_parts();
    let problem = parts.extensions.remove::<Problem>().unwrap_or_else(|| Problem::of_status(parts.status));
    // The only place where failures are logged: rejections are client errors and are not.
    if let Some(cause) = problem.cause() {
        tracing::error!(path = uri.path(), status = parts.status.as_u16(), cause, "request failed");
    } else if parts.status.is_server_error() && !problem.is_overload() {
        tracing::warn!(
            path = uri.path(),
            status = parts.status.as_u16(),
            code = problem.code(),
            "request refused"
        );
    }
    parts.headers.insert(CONTENT_TYPE, PROBLEM_JSON);
    parts.headers.remove(CONTENT_LENGTH);
    let view = problem.view(&id.0);
    Response::from_parts(parts, Body::from(serde_json::to_vec(&view).unwrap_or_default()))
}

/// Responds to a panicking handler like any other internal error; the process continues.
pub fn panicked(payload: Box<dyn Any + Send>) -> Response {
    let text = payload.downcast_ref::<&str>().map(ToString::to_string);
    let text = text.or_else(|| payload.downcast_ref::<String>().cloned()).unwrap_or_default();
    // tower-http passes it by value.
    drop(payload);
    Problem::internal(format!("panicked: {text}")).into_response()
}

/// Responds to an unknown path.
pub async fn no_such_path(uri: Uri) -> Problem {
    let path: String = uri.path().chars().take(200).collect();
    Problem::new(Kind::NOT_FOUND, format!("there is no resource at {path}; /docs lists the API"))
}

/// Responds to a known path with a method that it does not have; axum adds `allow`.
pub async fn no_such_method(method: Method, uri: Uri) -> Problem {
    let path: String = uri.path().chars().take(200).collect();
    Problem::new(
        Kind::METHOD_NOT_ALLOWED,
        format!("{path} does not support {method}; the header `allow` lists the supported methods"),
    )
}
