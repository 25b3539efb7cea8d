//! Releases: named versions of a map that stay as they are.

use axum::Json;
use axum::extract::State;
use axum::http::StatusCode;
use axum::response::Response;

use crate::api::examples;
use crate::api::list::ReleaseList;
use crate::api::release::{ReleaseBody, ReleaseChangesView, ReleaseView};
use crate::domain::release::NewRelease;
use crate::engine::Service;
use crate::http::answer::{Answer, written};
use crate::http::error_responses::{OfDelete, OfWrite, ReadErrors};
use crate::http::extract::body::Body;
use crate::http::extract::path::{MapPath, ReleasePath};
use crate::http::extract::query::{ChangesQuery, Paging, Query};
use crate::http::problem::Problem;

/// List the releases of a map
///
/// Sorted by name, paged; each with the robots whose loop queries it answered.
#[utoipa::path(
    get, path = "/v1/maps/{map}/releases", tag = "releases", params(MapPath, Paging), security(("key" = ["read"])),
    responses((status = 200, description = "One page of the list", body = ReleaseList, example = examples::releases), ReadErrors)
)]
pub async fn list_releases(
    State(service): State<Service>,
    MapPath { map }: MapPath,
    Query(page): Query<Paging>,
) -> Answer<ReleaseList> {
    Ok(Json(service.list_releases(&map, page.into()).await?.into()))
}

/// Publish a release of a map
///
/// The map as it stands, under a name: an immutable version that loop queries and `locate` may name, while robots go on writing to
/// the map. It answers when all of it is on disk, which takes seconds for each gigabyte; writes to the map do not wait for it. A
/// release takes as much disk as the map; a map has at most 64. Sending the same request again changes nothing and returns 200.
#[utoipa::path(
    put, path = "/v1/maps/{map}/releases/{release}", tag = "releases", params(ReleasePath), security(("key" = ["write"])),
    request_body(content = ReleaseBody, example = examples::release_body),
    responses(
        (status = 201, description = "The release is published", body = ReleaseView, example = examples::release),
        (status = 200, description = "This request had published it", body = ReleaseView,
            headers(("idempotent-replayed" = String, description = "`true`")), example = examples::release),
        OfWrite
    )
)]
pub async fn publish_release(
    State(service): State<Service>,
    ReleasePath { map, release }: ReleasePath,
    Body(wanted): Body<NewRelease>,
) -> Result<Response, Problem> {
    let stored = service.publish(&map, release, wanted).await?;
    Ok(written(stored.created, ReleaseView::from(stored.value)))
}

/// Read a release
///
/// Includes the robots whose loop queries it answered.
#[utoipa::path(
    get, path = "/v1/maps/{map}/releases/{release}", tag = "releases", params(ReleasePath), security(("key" = ["read"])),
    responses((status = 200, description = "The release", body = ReleaseView, example = examples::release), ReadErrors)
)]
pub async fn get_release(
    State(service): State<Service>,
    ReleasePath { map, release }: ReleasePath,
) -> Answer<ReleaseView> {
    Ok(Json(service.get_release(&map, &release).await?.into()))
}

/// Delete a release
///
/// Queries that name it answer 404 from then on. The map stays as it is.
#[utoipa::path(
    delete, path = "/v1/maps/{map}/releases/{release}", tag = "releases", params(ReleasePath), security(("key" = ["write"])),
    responses((status = 204, description = "The release is deleted"), OfDelete)
)]
pub async fn delete_release(
    State(service): State<Service>,
    ReleasePath { map, release }: ReleasePath,
) -> Result<StatusCode, Problem> {
    service.delete_release(&map, &release).await?;
    Ok(StatusCode::NO_CONTENT)
}

/// Compare a release with a later one
///
/// Keyframes, anchors and retired signs: what changed from `since` to `until`, or to the map as it stands. Tells whether robots need a
/// newer release.
#[utoipa::path(
    get, path = "/v1/maps/{map}/changes", tag = "releases", params(MapPath, ChangesQuery), security(("key" = ["read"])),
    responses((status = 200, description = "The changes", body = ReleaseChangesView, example = examples::release_changes), ReadErrors)
)]
pub async fn get_changes(
    State(service): State<Service>,
    MapPath { map }: MapPath,
    Query(asked): Query<ChangesQuery>,
) -> Answer<ReleaseChangesView> {
    let ChangesQuery { since, until, limit } = asked;
    let (earlier, later, changes) = service.changes_since(&map, &since, until.as_ref(), limit).await?;
    Ok(Json(ReleaseChangesView::of(earlier, later, changes)))
}
