//! Maps: a building's memory, and its settings.

use axum::Json;
use axum::extract::State;
use axum::http::StatusCode;
use axum::response::Response;

use crate::http::access::Caller;
use crate::http::answer::written;
use crate::http::body::Body;
use crate::http::path::{InMap, MapPath};
use crate::http::problem::Problem;
use crate::http::query::{Paging, Query};
use crate::http::refusals::{OfDelete, OfList, OfRead, OfWrite};
use crate::model::map::MapProperties;
use crate::model::request::MapPatch;
use crate::service::Service;
use crate::wire::examples;
use crate::wire::list::MapList;
use crate::wire::map::{MapBody, MapPatchBody, MapView};

/// List maps
///
/// By id, one part at a time; those that exist for the key.
#[utoipa::path(
    get, path = "/v1/maps", tag = "maps", params(Paging), security(("key" = ["read"])),
    responses((status = 200, description = "One part of the list", body = MapList, example = examples::maps), OfList)
)]
pub async fn list_maps(
    State(service): State<Service>,
    caller: Caller,
    Query(page): Query<Paging>,
) -> Result<Json<MapList>, Problem> {
    let maps = service.list_maps(page.cursor.as_deref(), page.limit, |map| caller.reaches(map)).await?;
    Ok(Json(maps.into()))
}

/// Make a map
///
/// The same body again changes nothing and answers 200; another body under the same id is a conflict.
#[utoipa::path(
    put, path = "/v1/maps/{map}", tag = "maps", params(MapPath), security(("key" = ["write"])),
    request_body(content = MapBody, example = examples::map_body),
    responses(
        (status = 201, description = "The map is made", body = MapView, example = examples::map),
        (status = 200, description = "The same map was made before", body = MapView, 
            headers(("idempotent-replayed" = String, description = "`true`")), example = examples::map),
        OfWrite
    )
)]
pub async fn put_map(
    State(service): State<Service>,
    caller: Caller,
    InMap(map): InMap,
    Body(properties): Body<MapProperties>,
) -> Result<Response, Problem> {
    let stored = service.put_map(map, properties, caller.0.key()).await?;
    Ok(written(stored.created, MapView::from(stored.value)))
}

/// Read a map
///
/// With every setting in force.
#[utoipa::path(
    get, path = "/v1/maps/{map}", tag = "maps", params(MapPath), security(("key" = ["read"])),
    responses((status = 200, description = "The map", body = MapView, example = examples::map), OfRead)
)]
pub async fn get_map(State(service): State<Service>, InMap(map): InMap) -> Result<Json<MapView>, Problem> {
    Ok(Json(service.get_map(&map).await?.into()))
}

/// Change a map
///
/// What is left out stays as it is; `settings` changes the settings it names.
#[utoipa::path(
    patch, path = "/v1/maps/{map}", tag = "maps", params(MapPath), security(("key" = ["write"])),
    request_body(content = MapPatchBody, example = examples::map_patch),
    responses((status = 200, description = "The map as it is now", body = MapView, example = examples::map), OfWrite)
)]
pub async fn patch_map(
    State(service): State<Service>,
    InMap(map): InMap,
    Body(patch): Body<MapPatch>,
) -> Result<Json<MapView>, Problem> {
    Ok(Json(service.patch_map(&map, patch).await?.into()))
}

/// Delete a map
///
/// With everything in it.
#[utoipa::path(
    delete, path = "/v1/maps/{map}", tag = "maps", params(MapPath), security(("key" = ["write"])),
    responses((status = 204, description = "The map is gone"), OfDelete)
)]
pub async fn delete_map(State(service): State<Service>, InMap(map): InMap) -> Result<StatusCode, Problem> {
    service.delete_map(&map).await?;
    Ok(StatusCode::NO_CONTENT)
}
