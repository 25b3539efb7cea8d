//! Maps: a building's keyframes and anchors, its settings, the map as a recording, and what leaves it for good.

use axum::Json;
use axum::body::{Body as Sent, Bytes};
use axum::extract::State;
use axum::http::StatusCode;
use axum::http::header::{CONTENT_DISPOSITION, CONTENT_TYPE};
use axum::response::{IntoResponse as _, Response};
use futures_util::Stream;

use super::bulk::NDJSON;
use crate::api::erasure::{ErasureBody, ErasureView};
use crate::api::examples;
use crate::api::list::MapList;
use crate::api::map::{MapBody, MapPatchBody, MapView};
use crate::api::recording::write_line;
use crate::domain::erasure::NewErasure;
use crate::domain::ids::MapId;
use crate::domain::key::Action;
use crate::domain::request::{MapPatch, NewMap};
use crate::engine::keys::access::Access;
use crate::engine::{MapExport, Service, ServiceError};
use crate::http::App;
use crate::http::answer::{Answer, written};
use crate::http::error_responses::{OfDelete, OfList, OfWrite, ReadErrors};
use crate::http::extract::answering::Answering;
use crate::http::extract::body::Body;
use crate::http::extract::path::{ErasurePath, MapPath};
use crate::http::extract::query::{DetailParams, Paging, Query, ReleaseQuery};
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
) -> Answer<MapList> {
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
) -> Answer<MapView> {
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
) -> Answer<MapView> {
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
    Ok((StatusCode::ACCEPTED, Json(ErasureView::of(erasure, &older))))
}

/// Read an erasure
///
/// Tells how far it is, and which backups still hold what it erased.
#[utoipa::path(
    get, path = "/v1/maps/{map}/erase/{erasure}", tag = "maps", params(ErasurePath), security(("key" = ["admin"])),
    responses((status = 200, description = "The erasure", body = ErasureView, example = examples::erasure), ReadErrors)
)]
pub async fn get_erasure(State(service): State<Service>, path: ErasurePath) -> Answer<ErasureView> {
    let (erasure, older) = service.erasure(&path.map, path.number()?).await?;
    Ok(Json(ErasureView::of(erasure, &older)))
}

/// Approximate size of the pieces in which lines are sent.
const PIECE_BYTES: usize = 64 << 10;

/// Export a map
///
/// Returns the map as a recording for `revisit replay`: one operation per line, in write order, each with its original
/// body. Poses and positions are the original ones, and corrections follow in order (`keep_history`). Deleted
/// keyframes are omitted, with everything that depends on them. Every keyframe includes its words, even where the
/// server computed them. Replaying it gives a map with the same verdicts, but other ids of anchors and queries. An
/// aborted response is incomplete. At most four exports run at once, two of them for one key.
#[utoipa::path(
    get, path = "/v1/maps/{map}/export", tag = "maps", params(MapPath, ReleaseQuery), security(("key" = ["read"])),
    responses(
        (status = 200, description = "The recording", body = String, content_type = "application/x-ndjson",
            example = "{\"op\":\"map\",\"id\":\"hotel\",\"body\":{}}\n"),
        ReadErrors
    )
)]
pub async fn export_map(
    State(app): State<App>,
    caller: Caller,
    MapPath { map }: MapPath,
    Query(ReleaseQuery { release }): Query<ReleaseQuery>,
) -> Result<Response, Problem> {
    let export = app.service.export(&map, release.as_ref()).await?;
    let headers = [
        (CONTENT_TYPE, NDJSON.to_owned()),
        (CONTENT_DISPOSITION, format!("attachment; filename=\"{map}.ndjson\"")),
    ];
    Ok((headers, Sent::from_stream(pieces(app, caller.0, map, export))).into_response())
}

/// Returns the lines of a map. An error aborts the response, so that a partial export is never mistaken for a complete
/// one.
fn pieces(
    app: App,
    access: Access,
    map: MapId,
    mut export: MapExport,
) -> impl Stream<Item = Result<Bytes, ServiceError>> {
    async_stream::try_stream! {
        let mut piece = Vec::new();
        loop {
            let next = tokio::select! {
                next = export.next() => next,
                () = app.service.keys().ended(&access) => Err(ServiceError::NotFound("the key has expired or was revoked".to_owned())),
            };
            let next = next.inspect_err(|error| tracing::error!(%map, %error, "an export failed"))?;
            let Some(recorded) = next else { break };
            write_line(&map, recorded, &mut piece)
                .map_err(|error| ServiceError::Internal(format!("a line was not written: {error}")))?;
            if piece.len() >= PIECE_BYTES {
                yield Bytes::from(std::mem::take(&mut piece));
            }
        }
        if !piece.is_empty() {
            yield Bytes::from(piece);
        }
    }
}
