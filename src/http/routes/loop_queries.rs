//! Loop queries: "is this keyframe a loop?", and reading a verdict again with every figure.

use axum::Json;
use axum::extract::State;
use axum::http::HeaderName;
use axum::response::{IntoResponse as _, Response};

use crate::api::examples;
use crate::api::list::VerdictList;
use crate::api::loop_query::LoopQueryBody;
use crate::api::verdict::LoopAnswer;
use crate::domain::request::Detail;
use crate::engine::{Service, Timings};
use crate::http::answer::json_bytes;
use crate::http::error_responses::{OfMapQuestion, ReadErrors};
use crate::http::extract::answering::Answering;
use crate::http::extract::body::QueryOfMap;
use crate::http::extract::path::{MapPath, QueryPath};
use crate::http::extract::query::{DetailParams, Paging, Query, VerdictSearch};
use crate::http::problem::Problem;

/// The W3C header with a server's timings.
pub(super) const SERVER_TIMING: HeaderName = HeaderName::from_static("server-timing");

/// Query whether a keyframe is a loop
///
/// The keyframe is a stored one, or one in the body. The query changes nothing and calls no model. The same map
/// version, keyframe, settings and seed give the same bytes. A client that needs only the verdict asks for less with
/// `?detail=brief`; the recorded verdict is whole all the same.
///
/// A verdict does not close a loop. Once the client has closed the loop in its own map, it confirms that with `POST
/// /v1/maps/{map}/loops`. From then on the two keyframes are covisible. The same query then returns the loop in
/// `closed` and the reason `already_closed`.
#[utoipa::path(
    post, path = "/v1/maps/{map}/loop-queries", tag = "loops", params(MapPath, DetailParams), security(("key" = ["query"])),
    request_body(content = LoopQueryBody, example = examples::loop_query),
    responses(
        (status = 200, description = "The verdict", body = LoopAnswer, example = examples::loop_answer),
        OfMapQuestion
    )
)]
pub async fn query_loop(
    Answering(service): Answering,
    Query(asked): Query<DetailParams>,
    QueryOfMap { map, query }: QueryOfMap,
) -> Result<Response, Problem> {
    let answer = service.loop_query(&map, query).await?;
    let detail = asked.detail();
    let body = match detail {
        Detail::Full => json_bytes(answer.body),
        Detail::Brief => Json(LoopAnswer::of(&answer.id, answer.keyframe.as_ref(), &answer.verdict, detail))
            .into_response(),
    };
    Ok(([(SERVER_TIMING, server_timing(answer.timings))], body).into_response())
}

/// List verdicts
///
/// The newest first, paged: a line for each loop query about a keyframe, the last 100,000 of a map. Written behind: a crash may
/// lose the last few. A question that is asked again, at the same version, has one line, with the time of the last. An erasure
/// removes all lines of the map, for any of them may name what was erased.
#[utoipa::path(
    get, path = "/v1/maps/{map}/loop-queries", tag = "loops", params(MapPath, VerdictSearch, Paging),
    security(("key" = ["read"])),
    responses((status = 200, description = "One page of the list", body = VerdictList, example = examples::verdicts), ReadErrors)
)]
pub async fn list_loop_queries(
    State(service): State<Service>,
    MapPath { map }: MapPath,
    Query((asked, page)): Query<(VerdictSearch, Paging)>,
) -> Result<Json<VerdictList>, Problem> {
    let release = asked.release.clone();
    let found = service.list_verdicts(&map, release.as_ref(), &asked.into(), page.into()).await?;
    Ok(Json(found.into()))
}

/// Read a verdict again
///
/// Returns the exact bytes of the answer. The number of records per map is limited; the oldest are deleted first.
#[utoipa::path(
    get, path = "/v1/maps/{map}/loop-queries/{query}", tag = "loops", params(QueryPath), security(("key" = ["read"])),
    responses((status = 200, description = "The verdict", body = LoopAnswer, example = examples::loop_answer), ReadErrors)
)]
pub async fn get_loop_query(
    State(service): State<Service>,
    QueryPath { map, query }: QueryPath,
) -> Result<Response, Problem> {
    Ok(json_bytes(service.kept_query(&map, query.as_str()).await?))
}

/// Formats the waiting time and the duration of each step, in milliseconds.
pub(super) fn server_timing(timings: Timings) -> String {
    let Timings { queue_ms, screen_ms, features_ms, geometry_ms } = timings;
    format!(
        "queue;dur={queue_ms:.3}, screen;dur={screen_ms:.3}, features;dur={features_ms:.3}, geometry;dur={geometry_ms:.3}"
    )
}
