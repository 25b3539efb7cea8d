//! Sessions: the robots' runs and the plans' frames of a map.

use axum::Json;
use axum::extract::State;

use crate::api::examples;
use crate::api::list::SessionList;
use crate::engine::Service;
use crate::http::error_responses::ReadErrors;
use crate::http::extract::path::{MapPath, MapPathParams};
use crate::http::extract::query::{Paging, Query};
use crate::http::problem::Problem;

/// List sessions
///
/// In order of appearance, paged. A session is aligned to a plan once two distinctive signs or more agree and no other place
/// explains them as well; the alignment is computed anew as more signs are read.
#[utoipa::path(
    get, path = "/v1/maps/{map}/sessions", tag = "maps", params(MapPathParams, Paging), security(("key" = ["read"])),
    responses((status = 200, description = "One page of the list", body = SessionList, example = examples::sessions), ReadErrors)
)]
pub async fn list_sessions(
    State(service): State<Service>,
    MapPath(map): MapPath,
    Query(page): Query<Paging>,
) -> Result<Json<SessionList>, Problem> {
    let (version, sessions) = service.list_sessions(&map, page.cursor.as_deref(), page.limit).await?;
    Ok(Json(SessionList::of(version, sessions)))
}
