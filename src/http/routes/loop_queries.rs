//! Loop queries: "is this keyframe a loop?", and the verdict read back with every figure.

use axum::extract::State;
use axum::http::HeaderName;
use axum::response::{IntoResponse as _, Response};

use crate::api::examples;
use crate::api::loop_query::LoopQueryBody;
use crate::api::verdict::LoopAnswer;
use crate::engine::{Service, Timings};
use crate::http::answer::json_bytes;
use crate::http::error_responses::{OfMapQuestion, ReadErrors};
use crate::http::extract::body::QueryOfMap;
use crate::http::extract::path::{MapPathParams, QueryPath, QueryPathParams};
use crate::http::problem::Problem;

/// The W3C header in which a server tells what it spent its time on.
const SERVER_TIMING: HeaderName = HeaderName::from_static("server-timing");

/// Ask whether a keyframe is a loop
///
/// About a stored keyframe or one sent along. It changes nothing and calls no model; the same map version, keyframe,
/// settings and seed give the same bytes.
///
/// A verdict is not yet a closed loop: it is an answer. Once the client has closed the loop in its own map, it confirms that
/// with `POST /v1/maps/{map}/loops`. From then on the two keyframes are covisible, and the same question is answered with the
/// loop in `closed` and the reason `already_closed`.
#[utoipa::path(
    post, path = "/v1/maps/{map}/loop-queries", tag = "loops", params(MapPathParams), security(("key" = ["query"])),
    request_body(content = LoopQueryBody, example = examples::loop_query),
    responses(
        (status = 200, description = "The verdict", body = LoopAnswer, example = examples::loop_answer),
        OfMapQuestion
    )
)]
pub async fn query_loop(
    State(service): State<Service>,
    QueryOfMap { map, query }: QueryOfMap,
) -> Result<Response, Problem> {
    let answer = service.loop_query(&map, query).await?;
    Ok(([(SERVER_TIMING, server_timing(answer.timings))], json_bytes(answer.body)).into_response())
}

/// Read a verdict again
///
/// The very bytes that were answered. Records are bounded for each map, the oldest go first.
#[utoipa::path(
    get, path = "/v1/maps/{map}/loop-queries/{query}", tag = "loops", params(QueryPathParams), security(("key" = ["read"])),
    responses((status = 200, description = "The verdict", body = LoopAnswer, example = examples::loop_answer), ReadErrors)
)]
pub async fn get_loop_query(
    State(service): State<Service>,
    QueryPath { map, query }: QueryPath,
) -> Result<Response, Problem> {
    Ok(json_bytes(service.kept_query(&map, &query).await?))
}

/// What each step took, in milliseconds.
fn server_timing(timings: Timings) -> String {
    let Timings { screen_ms, features_ms, geometry_ms } = timings;
    format!("screen;dur={screen_ms:.3}, features;dur={features_ms:.3}, geometry;dur={geometry_ms:.3}")
}
