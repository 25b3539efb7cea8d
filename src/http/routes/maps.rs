//! Maps: a building's keyframes and anchors, and its settings.

use axum::Json;
use axum::extract::State;
use axum::http::StatusCode;
use axum::response::Response;

use crate::api::examples;
use crate::api::list::MapList;
use crate::api::map::{MapBody, MapPatchBody, MapView};
use crate::domain::key::Action;
use crate::domain::request::{MapPatch, NewMap};
use crate::engine::{Service, ServiceError};
use crate::http::answer::written;
use crate::http::error_responses::{OfDelete, OfList, OfWrite, ReadErrors};
use crate::http::extract::answering::Answering;
use crate::http::extract::body::Body;
use crate::http::extract::path::MapPath;
use crate::http::extract::query::{DetailParams, Paging, Query};
use crate::http::guards::access::Caller;
use crate::http::problem::Problem;

/// List maps
///
/// Sorted by id, paged; only maps that the key covers.
#[utoipa::path(
    get, path = "/v1/maps", tag = "maps", params(Paging), security(("key" = ["read"])),
    responses((status = 200, description = "One page of the list", body = MapList, example = examples::maps), OfList)
)]
pub async fn list_maps(
    State(service): State<Service>,
    caller: Caller,
    Query(page): Query<Paging>,
) -> Result<Json<MapList>, Problem> {
    let maps = service.list_maps(page.into(), |map| caller.reaches(map)).await?;
    Ok(Json(MapList::of(maps, caller.patterns())))
}

/// Create a map
///
/// Sending the same body again changes nothing and returns 200; a different body under the same id is a conflict. With a `base` the map
/// begins as a copy of a release or of another map, and the answer comes when all of it is on disk; the key must have `read` for that. With
/// `?detail=brief` the answer lists only the settings that differ from their defaults.
#[utoipa::path(
    put, path = "/v1/maps/{map}", tag = "maps", params(MapPath, DetailParams), security(("key" = ["write"])),
    request_body(content = MapBody, example = examples::map_body),
    responses(
        (status = 201, description = "The map was created", body = MapView, example = examples::map),
        (status = 200, description = "The same map already existed", body = MapView, 
            headers(("idempotent-replayed" = String, description = "`true`")), example = examples::map),
        OfWrite
    )
)]
pub async fn put_map(
    State(service): State<Service>,
    caller: Caller,
    MapPath { map }: MapPath,
    Query(asked): Query<DetailParams>,
    Body(new): Body<NewMap>,
) -> Result<Response, Problem> {
    if let Some(base) = &new.base {
        // What is copied is read by whoever may read the copy.
        caller.needs(Action::Read)?;
        if !caller.reaches(&base.map) {
            return Err(ServiceError::no_map(&base.map).into());
        }
    }
    let stored = service.put_new_map(map, new, caller.0.key()).await?;
    Ok(written(stored.created, MapView::of(stored.value, asked.detail())))
}

/// Read a map
///
/// Includes every setting in force; with `?detail=brief` only those that differ from their defaults.
#[utoipa::path(
    get, path = "/v1/maps/{map}", tag = "maps", params(MapPath, DetailParams), security(("key" = ["read"])),
    responses((status = 200, description = "The map", body = MapView, example = examples::map), ReadErrors)
)]
pub async fn get_map(
    Answering(service): Answering,
    MapPath { map }: MapPath,
    Query(asked): Query<DetailParams>,
) -> Result<Json<MapView>, Problem> {
    Ok(Json(MapView::of(service.get_map(&map).await?, asked.detail())))
}

/// Change a map
///
/// Omitted members keep their values; `settings` changes only the settings that it contains.
#[utoipa::path(
    patch, path = "/v1/maps/{map}", tag = "maps", params(MapPath, DetailParams), security(("key" = ["write"])),
    request_body(content = MapPatchBody, example = examples::map_patch),
    responses((status = 200, description = "The updated map", body = MapView, example = examples::map), OfWrite)
)]
pub async fn patch_map(
    State(service): State<Service>,
    MapPath { map }: MapPath,
    Query(asked): Query<DetailParams>,
    Body(patch): Body<MapPatch>,
) -> Result<Json<MapView>, Problem> {
    Ok(Json(MapView::of(service.patch_map(&map, patch).await?, asked.detail())))
}

/// Delete a map
///
/// Deletes everything in it.
#[utoipa::path(
    delete, path = "/v1/maps/{map}", tag = "maps", params(MapPath), security(("key" = ["write"])),
    responses((status = 204, description = "The map is deleted"), OfDelete)
)]
pub async fn delete_map(
    State(service): State<Service>,
    MapPath { map }: MapPath,
) -> Result<StatusCode, Problem> {
    service.delete_map(&map).await?;
    Ok(StatusCode::NO_CONTENT)
}
