//! Erasures: keyframes and sessions that leave for good.

use axum::Json;
use axum::extract::State;
use axum::http::StatusCode;

use crate::api::erasure::{ErasureBody, ErasureView};
use crate::api::examples;
use crate::domain::erasure::NewErasure;
use crate::engine::Service;
use crate::http::error_responses::{OfWrite, ReadErrors};
use crate::http::extract::body::Body;
use crate::http::extract::path::{ErasurePath, MapPath};
use crate::http::problem::Problem;

/// Erase keyframes or sessions for good
///
/// A job: it deletes the keyframes from the map and from each of its releases, revokes the loops that name them, empties the map's
/// events and stored verdicts and the cache of models' answers, and then writes the database's file anew, so that no byte of them is left in
/// it, in its log or in the next backup. While the file is written, writes to any map wait: seconds for each gigabyte. It needs
/// as much free disk as the database has twice: in the log beside it, and in `SQLITE_TMPDIR` (else `/var/tmp`). Maps that began as copies are
/// maps of their own. Poll the job until it is `done`; it survives restarts. Backups that were taken before still hold
/// what was erased, and so does what other systems were sent.
#[utoipa::path(
    post, path = "/v1/maps/{map}/erase", tag = "maps", params(MapPath), security(("key" = ["admin"])),
    request_body(content = ErasureBody, example = examples::erasure_body),
    responses((status = 202, description = "The erasure is on record, and begins", body = ErasureView, example = examples::erasure), OfWrite)
)]
pub async fn erase(
    State(service): State<Service>,
    MapPath { map }: MapPath,
    Body(asked): Body<NewErasure>,
) -> Result<(StatusCode, Json<ErasureView>), Problem> {
    let erasure = service.erase(&map, asked).await?;
    let (erasure, older) = service.erasure(&map, erasure.number).await?;
    Ok((StatusCode::ACCEPTED, Json(ErasureView::of(erasure, older))))
}

/// Read an erasure
///
/// Tells how far it is, and which backups still hold what it erased.
#[utoipa::path(
    get, path = "/v1/maps/{map}/erase/{erasure}", tag = "maps", params(ErasurePath), security(("key" = ["admin"])),
    responses((status = 200, description = "The erasure", body = ErasureView, example = examples::erasure), ReadErrors)
)]
pub async fn get_erasure(
    State(service): State<Service>,
    path: ErasurePath,
) -> Result<Json<ErasureView>, Problem> {
    let (erasure, older) = service.erasure(&path.map, path.number()?).await?;
    Ok(Json(ErasureView::of(erasure, older)))
}
