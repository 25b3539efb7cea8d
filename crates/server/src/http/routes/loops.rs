//! Loops: asked for ("is this keyframe a loop?", "where am I?"), confirmed by clients, and revoked.

use axum::Json;
use axum::extract::State;
use axum::http::HeaderName;
use axum::response::{IntoResponse as _, Response};
use bytes::Bytes;

use crate::api::examples;
use crate::api::list::{LoopList, VerdictList};
use crate::api::location::{AskedMapView, LocateAnswerView, LocateBody};
use crate::api::loop_query::LoopQueryBody;
use crate::api::loops::{LoopBody, LoopClosed, LoopRevoked};
use crate::api::trajectory::MeasuredLoop;
use crate::api::verdict::LoopAnswer;
use crate::domain::ids::MapId;
use crate::domain::location::LocateRequest;
use crate::domain::request::{Detail, NewLoop};
use crate::engine::{AskedMap, ConfirmedLoop, Service, ServiceError, Timings};
use crate::geometry::Sim3;
use crate::http::answer::{Answer, json_bytes, written};
use crate::http::error_responses::{OfDelete, OfMapQuestion, OfWrite, ReadErrors};
use crate::http::extract::answering::Answering;
use crate::http::extract::body::{Body, QueryOfMap};
use crate::http::extract::path::{LoopPath, MapPath, QueryPath};
use crate::http::extract::query::{DetailParams, Paging, Query, VerdictSearch};
use crate::http::guards::access::Caller;
use crate::http::problem::Problem;

/// The W3C header with a server's timings.
const SERVER_TIMING: HeaderName = HeaderName::from_static("server-timing");

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
) -> Answer<VerdictList> {
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
fn server_timing(timings: Timings) -> String {
    let Timings { queue_ms, screen_ms, features_ms, geometry_ms } = timings;
    format!(
        "queue;dur={queue_ms:.3}, screen;dur={screen_ms:.3}, features;dur={features_ms:.3}, geometry;dur={geometry_ms:.3}"
    )
}

/// Find where a keyframe was taken
///
/// The keyframe need not have a pose: it is held against one, several or all maps that the key may query. The answer is
/// `located` only where the confidence is at least 0.99. Where several places fit, it is `ambiguous`, and `look_for` names
/// signs that would tell them apart; else it is `unknown`. The question stores nothing and calls no model. At most 64 maps are
/// asked, and geometry looks at 20 pairs of keyframes at most.
#[utoipa::path(
    post, path = "/v1/locate", tag = "loops", security(("key" = ["query"])),
    request_body(content = LocateBody, example = examples::locate),
    responses((status = 200, description = "The places", body = LocateAnswerView, example = examples::locate_answer), OfMapQuestion)
)]
pub async fn locate(
    State(service): State<Service>,
    caller: Caller,
    Body(request): Body<LocateRequest>,
) -> Result<Response, Problem> {
    let answer = service.locate(request, |map| caller.reaches(map)).await?;
    let asked = |map: &AskedMap| AskedMapView::of(&map.id, map.version, map.are_words_compared);
    let maps = answer.maps.iter().map(asked).collect();
    let body = Json(LocateAnswerView::of(maps, answer.keyframes, &answer.location));
    Ok(([(SERVER_TIMING, server_timing(answer.timings))], body).into_response())
}

/// Confirm a loop
///
/// States that the client has closed the loop. Matched anchors of the two local maps are merged, and the two keyframes
/// become covisible. Only this closes a loop; the verdict of a query changes nothing. Evidence against the loop is
/// returned in `warnings`.
#[utoipa::path(
    post, path = "/v1/maps/{map}/loops", tag = "loops", params(MapPath), security(("key" = ["write"])),
    request_body(content = LoopBody, example = examples::loop_body),
    responses(
        (status = 201, description = "The loop is confirmed", body = LoopClosed, example = examples::loop_closed),
        (status = 200, description = "The same loop was already confirmed", body = LoopClosed,

            headers(("idempotent-replayed" = String, description = "`true`")), example = examples::loop_closed),
        OfWrite
    )
)]
pub async fn confirm_loop(
    State(service): State<Service>,
    MapPath { map }: MapPath,
    Body(new): Body<NewLoop>,
) -> Result<Response, Problem> {
    let transform = measured(&service, &map, &new).await?;
    let (version, stored) = service.confirm_loop(&map, new, transform).await?;
    let ConfirmedLoop { report, warnings } = stored.value;
    Ok(written(stored.created, LoopClosed::of(version, report, warnings)))
}

/// List confirmed loops
///
/// Oldest first, paged.
#[utoipa::path(
    get, path = "/v1/maps/{map}/loops", tag = "loops", params(MapPath, Paging), security(("key" = ["read"])),
    responses((status = 200, description = "One page of the list", body = LoopList, example = examples::loops), ReadErrors)
)]
pub async fn list_loops(
    Answering(service): Answering,
    MapPath { map }: MapPath,
    Query(page): Query<Paging>,
) -> Answer<LoopList> {
    Ok(Json(service.list_loops(&map, page.into()).await?.into()))
}

/// Revoke a loop
///
/// For a loop that was wrong: its merges are undone, and the two keyframes are no longer covisible through it.
#[utoipa::path(
    delete, path = "/v1/maps/{map}/loops/{loop}", tag = "loops", params(LoopPath), security(("key" = ["write"])),
    responses(
        (status = 200, description = "The loop is revoked", body = LoopRevoked, example = examples::loop_revoked),
        OfDelete
    )
)]
pub async fn revoke_loop(
    State(service): State<Service>,
    LoopPath { map, r#loop: id }: LoopPath,
) -> Answer<LoopRevoked> {
    let (version, report) = service.revoke_loop(&map, &id).await?;
    Ok(Json(LoopRevoked::of(version, report)))
}

/// Returns the transformation that the query of a loop verified, if its answer is kept and about these two keyframes.
async fn measured(service: &Service, map: &MapId, new: &NewLoop) -> Result<Option<Sim3>, Problem> {
    let query = new.query.as_deref().filter(|_| new.candidate_from_query.is_none());
    let Some(answer) = kept_answer(service, map, query).await? else { return Ok(None) };
    let measured = MeasuredLoop::between(&answer, new.keyframe.as_str(), new.candidate.as_str());
    Ok(measured.map(|measured| Sim3::scaled(measured.candidate_from_query, measured.scale)))
}

/// Returns the answer to the query of a loop, if one is named and its answer is kept.
pub(super) async fn kept_answer(
    service: &Service,
    map: &MapId,
    query: Option<&str>,
) -> Result<Option<Bytes>, Problem> {
    let Some(query) = query else { return Ok(None) };
    match service.kept_query(map, query).await {
        Ok(answer) => Ok(Some(answer)),
        // The number of stored answers is limited, and a client may name a query of its own.
        Err(ServiceError::NotFound(_)) => Ok(None),
        Err(error) => Err(error.into()),
    }
}
