//! Loops: confirmed by clients, and revoked.

use axum::Json;
use axum::extract::State;
use axum::response::Response;

use crate::api::examples;
use crate::api::list::LoopList;
use crate::api::loops::{LoopBody, LoopClosed, LoopRevoked};
use crate::api::trajectory::MeasuredLoop;
use crate::domain::ids::MapId;
use crate::domain::request::NewLoop;
use crate::engine::{ConfirmedLoop, Service, ServiceError};
use crate::geometry::Sim3;
use crate::http::answer::written;
use crate::http::error_responses::{OfDelete, OfWrite, ReadErrors};
use crate::http::extract::answering::Answering;
use crate::http::extract::body::Body;
use crate::http::extract::path::{LoopPath, MapPath};
use crate::http::extract::query::{Paging, Query};
use crate::http::problem::Problem;

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
) -> Result<Json<LoopList>, Problem> {
    let (version, loops) = service.list_loops(&map, page.into()).await?;
    Ok(Json(LoopList::of(version, loops)))
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
) -> Result<Json<LoopRevoked>, Problem> {
    let (version, report) = service.revoke_loop(&map, &id).await?;
    Ok(Json(LoopRevoked::of(version, report)))
}

/// Returns the transformation that the query of a loop verified, if its answer is kept and about these two keyframes.
async fn measured(service: &Service, map: &MapId, new: &NewLoop) -> Result<Option<Sim3>, Problem> {
    let Some(query) = new.query.as_ref().filter(|_| new.candidate_from_query.is_none()) else {
        return Ok(None);
    };
    match service.kept_query(map, query).await {
        Ok(answer) => Ok(MeasuredLoop::between(&answer, new.keyframe.as_str(), new.candidate.as_str())
            .map(|measured| Sim3::scaled(measured.candidate_from_query, measured.scale))),
        // The number of stored answers is limited, and a client may name a query of its own.
        Err(ServiceError::NotFound(_)) => Ok(None),
        Err(error) => Err(error.into()),
    }
}
