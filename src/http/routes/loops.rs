//! Loops: closed by clients, and revoked again.

use axum::Json;
use axum::extract::State;
use axum::response::Response;

use crate::http::answer::written;
use crate::http::body::Body;
use crate::http::path::{InLoop, InMap, LoopPath, MapPath};
use crate::http::problem::Problem;
use crate::http::query::{Paging, Query};
use crate::http::refusals::{OfDelete, OfRead, OfWrite};
use crate::model::request::NewLoop;
use crate::service::{ConfirmedLoop, Service};
use crate::wire::examples;
use crate::wire::list::LoopList;
use crate::wire::loops::{LoopBody, LoopClosed, LoopRevoked};

/// Confirm a loop
///
/// The client has closed it: anchors matched between the two local maps become one, and the two keyframes covisible. Only this
/// closes a loop; a verdict of a query changes nothing. What speaks against it is told in `warnings`.
#[utoipa::path(
    post, path = "/v1/maps/{map}/loops", tag = "loops", params(MapPath), security(("key" = ["write"])),
    request_body(content = LoopBody, example = examples::loop_body),
    responses(
        (status = 201, description = "The loop is confirmed", body = LoopClosed, example = examples::loop_closed),
        (status = 200, description = "The same loop was confirmed before", body = LoopClosed,

            headers(("idempotent-replayed" = String, description = "`true`")), example = examples::loop_closed),
        OfWrite
    )
)]
pub async fn confirm_loop(
    State(service): State<Service>,
    InMap(map): InMap,
    Body(new): Body<NewLoop>,
) -> Result<Response, Problem> {
    let stored = service.confirm_loop(&map, new).await?;
    let ConfirmedLoop { report, warnings } = stored.value;
    Ok(written(stored.created, LoopClosed::of(stored.map_version, report, warnings)))
}

/// List confirmed loops
///
/// Oldest first, one part at a time.
#[utoipa::path(
    get, path = "/v1/maps/{map}/loops", tag = "loops", params(MapPath, Paging), security(("key" = ["read"])),
    responses((status = 200, description = "One part of the list", body = LoopList, example = examples::loops), OfRead)
)]
pub async fn list_loops(
    State(service): State<Service>,
    InMap(map): InMap,
    Query(page): Query<Paging>,
) -> Result<Json<LoopList>, Problem> {
    let (version, loops) = service.list_loops(&map, page.cursor.as_deref(), page.limit).await?;
    Ok(Json(LoopList::of(version, loops)))
}

/// Revoke a loop
///
/// It was none after all: what it merged is split again, and the two keyframes are no longer covisible through it.
#[utoipa::path(
    delete, path = "/v1/maps/{map}/loops/{loop}", tag = "loops", params(LoopPath), security(("key" = ["write"])),
    responses(
        (status = 200, description = "The loop is revoked", body = LoopRevoked, example = examples::loop_revoked),
        OfDelete
    )
)]
pub async fn revoke_loop(
    State(service): State<Service>,
    InLoop { map, id }: InLoop,
) -> Result<Json<LoopRevoked>, Problem> {
    let (version, report) = service.revoke_loop(&map, &id).await?;
    Ok(Json(LoopRevoked::of(version, report)))
}
