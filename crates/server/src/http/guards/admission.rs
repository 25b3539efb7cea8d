//! Admission: admits a request, or rejects it at once as overloaded.
//!
//! The shedding order is that of [`crate::engine::limits::load_shedding`]. A rejected request is answered without
//! reading its body; [`crate::http::connection::unread`] handles the rest of it.

use std::sync::Arc;

use axum::body::Body;
use axum::extract::{MatchedPath, Request, State};
use axum::http::Method;
use axum::middleware::Next;
use axum::response::{IntoResponse as _, Response};

use crate::engine::limits::load_shedding::{Kind, RequestPermit};
use crate::http::App;
use crate::http::connection::min_rate_body::MinRateBody;
use crate::http::problem::Problem;

/// Never rejected, because operators need them most under overload; served from memory.
const ALWAYS: [&str; 3] = ["/healthz", "/readyz", "/metrics"];
/// Queries sent by POST.
const QUESTIONS: [&str; 4] = [
    "/v1/maps/{map}/loop-queries",
    "/v1/semantics/similarity",
    "/v1/semantics/information",
    "/v1/semantics/merge",
];
/// The permit of a request, for handlers that wait for something other than work.
#[derive(Clone, Debug, Default)]
pub struct HeldPermit(Option<Arc<RequestPermit>>);

impl HeldPermit {
    /// Awaits without counting the request as in flight.
    pub async fn release_while<T>(&self, waiting: impl Future<Output = T>) -> T {
        match &self.0 {
            Some(turn) => turn.release_while(waiting).await,
            None => waiting.await,
        }
    }
}

/// Admits a request and times its body, or rejects it.
pub async fn admit(State(app): State<App>, mut request: Request, next: Next) -> Response {
    let route = request.extensions().get::<MatchedPath>().map_or("", MatchedPath::as_str);
    let (kind, what) = kind(request.method(), route);
    let turn = match app.service.pressure().admit(kind) {
        Some(turn) => Some(Arc::new(turn)),
        None if ALWAYS.contains(&route) => None,
        None => {
            app.metrics.shed(what);
            return Problem::overloaded("the server has reached its limit of concurrent requests")
                .into_response();
        }
    };
    request.extensions_mut().insert(HeldPermit(turn.clone()));
    let pace = app.pace;
    let timed = turn.clone();
    let response = next.run(request.map(|body| Body::new(MinRateBody::new(body, pace, timed)))).await;
    // The permit ends here: sending a response, above all an event stream, is not work.
    drop(turn);
    response
}

fn kind(method: &Method, route: &str) -> (Kind, &'static str) {
    let asks = method == Method::POST && QUESTIONS.contains(&route);
    if asks || matches!(*method, Method::GET | Method::HEAD | Method::OPTIONS) {
        (Kind::Read, "read")
    } else {
        (Kind::Write, "write")
    }
}
