//! Router: the routes, and the layers around them.

use std::time::Instant;

use axum::Router;
use axum::extract::{Request, State};
use axum::middleware::{Next, from_fn, from_fn_with_state};
use axum::response::Response;
use tower::ServiceBuilder;
use tower_http::catch_panic::CatchPanicLayer;
use tower_http::compression::CompressionLayer;
use tower_http::limit::RequestBodyLimitLayer;

use super::connection::bound_answers::bound_answers;
use super::envelope::{self, envelope};
use super::forwarding::forward;
use super::guards::access::authorise;
use super::guards::admission::admit;
use super::{App, document, pages, routes};
use crate::api::limits;

/// Returns every route with its layers.
pub fn router(app: App) -> Router {
    let (api, _) = routes::api(document::frame()).split_for_parts();
    // Outermost first.
    let layers = ServiceBuilder::new()
        .layer(from_fn(envelope))
        .layer(from_fn_with_state(app.clone(), observe))
        .layer(from_fn_with_state(app.clone(), admit))
        .layer(CompressionLayer::new())
        // Before compression, because only then a response has a length and is held in memory.
        .layer(from_fn_with_state(app.clone(), bound_answers))
        .layer(CatchPanicLayer::custom(envelope::panicked))
        // Limits the compressed size; the body's reader limits the inflated size.
        .layer(RequestBodyLimitLayer::new(limits::BULK_BYTES));
    // The pages contain no data and ask for a key in the browser.
    api.route_layer(from_fn_with_state(app.clone(), forward))
        .route_layer(from_fn_with_state(app.clone(), authorise))
        .merge(pages::routes())
        .fallback(envelope::no_such_path)
        .method_not_allowed_fallback(envelope::no_such_method)
        .layer(layers)
        .with_state(app)
}

/// Counts and times a request by the pattern of its route.
async fn observe(State(app): State<App>, request: Request, next: Next) -> Response {
    let started = Instant::now();
    let method = request.method().clone();
    let route = envelope::route_of(&request).to_owned();
    let response = next.run(request).await;
    app.metrics.answered(method.as_str(), &route, response.status().as_u16(), started.elapsed());
    response
}
